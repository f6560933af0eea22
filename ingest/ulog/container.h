#pragma once
// The ULog container: bytes in, topics and messages out. It knows no PX4 topic and no Flight.
// Format: PX4 user guide, "ULog File Format", versions 0 and 1.
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::ingest::ulog {

inline constexpr std::uint8_t magic[7] = {'U', 'L', 'o', 'g', 0x01, 0x12, 0x35};

enum class Scalar : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, real32, real64, boolean };

/// Where one number stands in the payload of a message.
struct Column {
  Scalar type = Scalar::uint8;
  std::uint32_t offset = 0;
};

/// Bytes that a scalar takes.
std::uint32_t size_of(Scalar type);

/// The number as a double (integers beyond 2^53 lose their last bits: use integer()); empty when the payload
/// ends before it.
std::optional<double> number(Bytes payload, Column column);
/// The same without the loss; reals are truncated.
std::optional<std::int64_t> integer(Bytes payload, Column column);

struct Field {
  std::string type;         ///< as written, without the array part: "float", "esc_report"
  std::uint32_t count = 1;  ///< array length, 1 if it is none
  bool array = false;
  std::string name;
};

struct Format {
  std::string name;
  std::vector<Field> fields;
};

using Formats = std::map<std::string, Format, std::less<>>;

/// Finds a number by its path ("q[0]", "esc[3].esc_rpm", "timestamp"); empty if there is none, if a nested type is
/// not defined, or if types contain each other.
std::optional<Column> find_column(const Formats& formats, std::string_view format, std::string_view path);

/// One topic instance with the places of its messages.
struct Topic {
  std::string name;
  std::uint8_t multi_id = 0;
  std::uint64_t messages = 0;             ///< data messages decoded
  std::vector<std::uint64_t> payload_at;  ///< file offset of each payload; only for topics that were asked for
};

/// A value of an I, M, P or Q message.
struct Value {
  std::string type;   ///< "char[40]", "uint32_t", "float"
  std::string bytes;  ///< as they stand in the file
  std::optional<double> number() const;
};

struct Parameter {
  std::string name;
  Value value;
  std::uint64_t at = 0;  ///< file offset
};

struct Text {
  char level = '6';
  std::optional<std::uint16_t> tag;
  std::uint64_t timestamp_us = 0;
  std::string text;
};

struct Dropout {
  std::uint16_t duration_ms = 0;
  std::uint64_t after_payload_at = 0;  ///< the data message before it; 0 = none
  std::size_t after_topic = 0;         ///< and its topic
};

struct Log {
  Bytes bytes;
  std::string file;
  std::uint8_t version = 0;
  std::uint64_t start_us = 0;
  Formats formats;
  std::vector<Topic> topics;
  std::map<std::string, Value, std::less<>> info;
  std::vector<std::pair<std::string, std::string>> info_multi;  ///< continued pieces joined
  std::vector<Parameter> parameters;                            ///< at the start
  std::vector<Parameter> parameter_changes;                     ///< later in the file
  std::vector<Parameter> parameter_defaults;
  std::vector<Text> texts;
  std::vector<Dropout> dropouts;
  std::uint64_t data_messages = 0;
  std::uint64_t salvaged = 0;  ///< data messages behind lost structure
  std::uint64_t given_up = 0;  ///< bytes without a sound message
  std::uint64_t appended = 0;  ///< runs of appended data
  std::vector<Problem> problems;

  /// The payload of a message of a topic (without message head and id).
  Bytes payload(const Topic& topic, std::size_t index) const { return payload_at(topic.payload_at[index]); }
  Bytes payload_at(std::uint64_t at) const;
  /// Latest value of a parameter of the start set.
  std::optional<double> parameter(std::string_view name) const;
  /// A text information, without trailing zeros; empty if it is not there.
  std::string info_text(std::string_view name) const;
};

struct Settings {
  Reading mode = Reading::tolerant;
  /// Topics whose messages are kept in Topic::payload_at; all are counted. Empty function: every topic.
  std::function<bool(std::string_view topic)> keep;
};

/// Reads a whole ULog. `bytes` must outlive the Log.
/// tolerant: a record that contradicts the format is dropped and reported; after lost structure reading goes on at
/// the next sync message. salvage: also at the next run of sound messages. A cut last message is a Problem.
/// Errors: not_a_log (no magic), unsupported (unknown incompatible flags), and in strict mode the first Problem.
Result<Log> read(Bytes bytes, const std::string& file, const Settings& settings = {});

}  // namespace quadsonde::ingest::ulog

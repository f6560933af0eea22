#pragma once
// A Paparazzi log: lines of text in the .data, the meaning of their values in the .log. Knows no vehicle.
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/time.h"

namespace quadsonde::ingest {

struct PaparazziField {
  std::string name;  ///< lower case
  std::string type;  ///< "int32", "float", "uint8[]", ...
  std::string unit;
  bool is_float() const { return type == "float" || type == "double"; }
};

struct PaparazziMessageDefinition {
  std::string name;
  std::vector<PaparazziField> fields;
  std::optional<std::size_t> find(std::string_view field) const;
};

struct PaparazziAircraft {
  std::string id, name;
  std::string firmware;  ///< "rotorcraft", "fixedwing", ...; empty in old files
};

/// What the .log says. The scan is tolerant: old files are no well-formed XML (a bare && in an attribute), have
/// upper-case attribute names, and <class> where new ones have <msg_class>.
class PaparazziDefinitions {
 public:
  static PaparazziDefinitions scan(Bytes log);

  /// Unix time of log time zero, if the .log tells it.
  std::optional<UtcTime> time_of_day() const { return time_of_day_; }
  const std::vector<PaparazziAircraft>& aircraft() const { return aircraft_; }
  /// The definition of the telemetry class, else of the first class that has the name; nullptr if none has.
  const PaparazziMessageDefinition* find(std::string_view name) const;
  std::size_t size() const { return messages_.size(); }

 private:
  std::optional<UtcTime> time_of_day_;
  std::vector<PaparazziAircraft> aircraft_;
  std::map<std::string, PaparazziMessageDefinition, std::less<>> messages_;
};

/// One line "seconds aircraft NAME value value ...", in place.
struct PaparazziLine {
  LogTime time;  ///< since the .log's time_of_day
  std::string_view aircraft, name, values;
  std::uint64_t line = 0;  ///< first is 1
  std::uint64_t at = 0;    ///< byte in the file
};

class PaparazziLineReader {
 public:
  explicit PaparazziLineReader(Bytes data) : text_(as_text(data)) {}

  /// @return false at the end. Blank lines, lines of the ground (no numeric aircraft id) and a last line without its
  ///         end are left out; what is no message is counted
  bool next(PaparazziLine& line);

  std::uint64_t lines() const { return good_; }
  std::uint64_t of_the_ground() const { return ground_; }
  std::uint64_t unparsable() const { return unparsable_; }
  std::uint64_t first_unparsable() const { return first_unparsable_; }
  /// Bytes of a last line without its end.
  std::uint64_t trailing_partial_bytes() const { return trailing_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 0, good_ = 0, ground_ = 0, unparsable_ = 0, first_unparsable_ = 0, trailing_ = 0;
};

/// Splits values at blanks; a value in quotes may contain blanks, a comma list is one value.
void split_paparazzi_values(std::string_view values, std::vector<std::string_view>& out);

}  // namespace quadsonde::ingest

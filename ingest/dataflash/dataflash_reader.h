#pragma once
// The DataFlash container: messages that describe themselves, no checksum anywhere. Knows bytes, no vehicle.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

/// One field of a message, where it lies and what its raw number is multiplied with.
struct DataflashField {
  std::string label;
  char code = 0;                      ///< format letter of the FMT message
  std::uint8_t size = 0;              ///< [bytes]
  std::uint16_t offset = 0;           ///< in the body, behind the three head bytes
  char unit = '-', multiplier = '-';  ///< letters of the FMTU message; '-' without one
  double scale = 1;                   ///< implied by c C e E L, else by FMTU; never both
};

/// What one FMT message says of one type.
struct DataflashLayout {
  std::uint8_t type = 0, length = 0;  ///< length with the three head bytes
  std::string name, format;
  std::vector<DataflashField> fields;  ///< empty if sizes and length contradict each other: skip by length only
  std::uint32_t generation = 0;        ///< changes when an FMT redefines the type; field pointers live as long as it
  std::size_t topic = 0;               ///< index into DataflashReader::topics()

  const DataflashField* find(std::string_view label) const;
};

/// A message in place: valid until the reader goes on.
struct DataflashMessage {
  const DataflashLayout* layout = nullptr;
  const std::uint8_t* body = nullptr;  ///< layout->length - 3 bytes
  std::uint64_t at = 0;                ///< byte of its head in the file
  bool suspect = false;                ///< what follows it is no message: garbage may have begun inside
  bool salvaged = false;               ///< stands behind lost structure

  /// The raw number; NaN for text and arrays.
  double raw(const DataflashField& field) const;
  /// Raw number times the field's scale.
  double scaled(const DataflashField& field) const { return raw(field) * field.scale; }
  /// Raw integer; 0 for floats, text and arrays.
  std::int64_t integer(const DataflashField& field) const;
  /// Text up to the first NUL (n, N, Z); empty for numbers.
  std::string_view text(const DataflashField& field) const;
};

/// Bytes between messages that belong to none.
struct DataflashLoss {
  std::uint64_t at = 0, bytes = 0;
};

/// Reads messages one by one. Behind garbage it goes on at the next head whose type has a layout and whose end is
/// followed by another head, by the end of the bytes, or whose time fits. Takes memory for layouts and counts only.
class DataflashReader {
 public:
  explicit DataflashReader(Bytes bytes);
  DataflashReader(const DataflashReader&) = delete;
  DataflashReader& operator=(const DataflashReader&) = delete;

  /// @return false at the end; layouts and multipliers are taken in on the way
  bool next(DataflashMessage& message);
  /// Looks ahead without moving: the next complete message at or behind a byte, by the layouts known now.
  /// @return the byte behind that message; empty at the end
  std::optional<std::size_t> peek(std::size_t at, DataflashMessage& message) const;

  std::size_t at() const { return at_; }
  std::uint64_t messages() const { return messages_; }
  std::uint64_t salvaged() const { return salvaged_; }
  std::uint64_t skipped_bytes() const { return skipped_; }
  std::uint64_t losses() const { return losses_; }
  /// The first losses, at most 16.
  const std::vector<DataflashLoss>& first_losses() const { return first_losses_; }
  /// Bytes of a message that the end of the file cuts.
  std::uint64_t trailing_partial_bytes() const { return trailing_; }
  /// Messages per name, in the order in which names were met.
  const std::vector<TopicCount>& topics() const { return topics_; }
  const DataflashLayout* layout(std::string_view name) const;

 private:
  bool head_at(std::size_t at) const;
  bool follows_well(std::size_t end) const;
  bool believable(const DataflashMessage& message) const;
  void lose(std::size_t from, std::size_t to);
  void take_in(const DataflashMessage& message);
  void take_format(const DataflashMessage& message);
  void take_units(const DataflashMessage& message);
  void take_multiplier(const DataflashMessage& message);
  void define(DataflashLayout layout, std::string_view labels);
  void rescale(DataflashLayout& layout);

  struct Units {
    std::string units, multipliers;
  };

  Bytes bytes_;
  std::size_t at_ = 0;
  bool in_step_ = true;
  std::int64_t last_time_us_ = -1;
  std::array<DataflashLayout, 256> layouts_;
  std::array<const DataflashField*, 256> time_fields_{};
  std::array<Units, 256> units_;
  std::array<double, 128> multipliers_{};
  std::uint32_t generations_ = 0;
  int multiplier_changes_ = 0;
  std::vector<TopicCount> topics_;
  std::unordered_map<std::string, std::size_t> topic_of_name_;
  std::uint64_t messages_ = 0, salvaged_ = 0, skipped_ = 0, losses_ = 0, trailing_ = 0;
  std::vector<DataflashLoss> first_losses_;
};

}  // namespace quadsonde::ingest

#pragma once
// Rows of canonical values to the streams of a Flight.
#include <array>

#include "ingest/csv/table_layout.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest::csv {

/// One row: the value of each bound column, NaN where the cell is empty or no number.
struct Row {
  LogTime time;
  std::uint64_t line = 0;
  const std::vector<double>* values = nullptr;
  std::string_view event;
};

class RowStreams {
 public:
  RowStreams(const Layout& layout, std::string file, Flight& flight);
  void add(const Row& row);
  /// Says what is missing and what contradicts itself; makes the velocity where there is none.
  void finish(std::vector<std::pair<std::string, std::string>>& details);

 private:
  using Slots3 = std::array<int, 3>;
  int slot(std::string_view canonical) const;
  std::string columns(std::initializer_list<int> slots) const;
  double value(const Row& row, int slot) const;
  Eigen::Vector3d vector(const Row& row, const Slots3& slots) const;
  void add_attitude(const Row& row);
  void add_velocity(const Row& row);
  void add_place(const Row& row);
  void add_sensors(const Row& row);
  void complain_of_missing(std::initializer_list<const char*> group, const char* what);
  void complete_velocity(std::vector<std::pair<std::string, std::string>>& details);

  const Layout& layout_;
  std::string file_;
  Flight& flight_;
  std::array<int, 4> q_;
  Slots3 angles_, velocity_, local_, acceleration_;
  int sd_, lat_, lon_, msl_, ellipsoid_, ground_, baro_alt_, pressure_, temperature_, humidity_;
  std::vector<int> rotors_;
  std::uint64_t contradictions_ = 0, compared_ = 0, first_contradiction_ = 0;
  double worst_contradiction_ = 0;
  bool every_sd_ = true;
};

}  // namespace quadsonde::ingest::csv

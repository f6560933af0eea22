#pragma once
// One Paparazzi aircraft: its columns, and the Flight they make.
#include <array>
#include <map>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "ingest/paparazzi/paparazzi_reader.h"

namespace quadsonde::ingest::paparazzi {

enum class Row {
  none,
  rotorcraft_fp,
  ins,
  ins_ref,
  gps_int,
  gps,
  gps_lla,
  attitude,
  quaternion,
  euler,
  acceleration,
  air_data,
  wind,
  status,
  version,
  rotorcraft_mark,
  fixed_wing_mark
};

constexpr std::size_t most_values = 10;

/// A row of the table found in the definitions of one log.
struct Binding {
  Row row = Row::none;
  std::size_t values = 0;                    ///< how many a line must have
  std::array<int, most_values> index{};      ///< of the row's fields among the line's values; -1: not in this log
  std::array<double, most_values> factor{};  ///< to the row's unit
  bool complete = false;                     ///< all fields that the row cannot do without are there
};

/// @return Row::none for a message that says nothing of a flight
Binding bind(const PaparazziMessageDefinition& definition);

class Aircraft {
 public:
  void take(const Binding& row, const std::vector<std::string_view>& values, LogTime t);
  Flight finish(const PaparazziDefinitions& definitions, const std::string& id, const std::string& file) &&;
  bool has_data() const;

 private:
  void take_gps(const Binding& row, LogTime t);
  void take_week_gps(const Binding& row, LogTime t);
  void take_estimates(const Binding& row, LogTime t);
  void take_attitude(const Binding& row, LogTime t);
  void take_sensors(const Binding& row, LogTime t);
  void take_status(const Binding& row, LogTime t);
  void choose_attitude();
  void choose_velocity(const std::string& file);
  void finish_clock(const PaparazziDefinitions& definitions);
  VehicleIdentity identity(const PaparazziDefinitions& definitions, const std::string& id) const;

  std::array<double, most_values> value_{};  ///< of the line in hand, in the row's units; NaN if not there
  Flight flight_;
  Stream<Eigen::Quaterniond> attitude_, quaternion_, euler_, fp_attitude_;
  Stream<Eigen::Vector3d> fp_velocity_, ins_velocity_, fp_local_, ins_local_;
  VelocityStream gps_int_velocity_, gps_velocity_;
  Stream<bool> has_fix_;
  ClockEstimator week_clock_;
  std::optional<Latency> receiver_latency_;
  std::vector<std::pair<LogTime, std::int64_t>> time_of_week_ms_;
  std::string version_;
  bool rotorcraft_ = false, fixed_wing_ = false, armed_ = false, saw_status_ = false;
};

}  // namespace quadsonde::ingest::paparazzi

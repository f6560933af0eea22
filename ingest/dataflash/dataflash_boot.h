#pragma once
// One boot of an ArduPilot vehicle: the columns of all its sensors and filters, and the Flight that they make.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "ingest/dataflash/dataflash_table.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest::dataflash {

struct GpsColumns {
  VelocityStream velocity;
  Stream<GeoPoint> position;
  Stream<MslHeight> height;
  Stream<double> speed_sd;  ///< GPA.SAcc [m/s]
  Stream<EllipsoidHeight> ellipsoid;
  ClockEstimator clock;
  std::vector<double> waited;  ///< from the arrival of the receiver's message to the log's stamp [s]
  std::uint64_t used = 0, without_fix = 0;
  std::uint64_t with_vertical = 0, without_vertical = 0;  ///< by GPA.VV
};

struct EkfColumns {
  VelocityStream velocity;
  Stream<Eigen::Vector3d> local;
  Stream<AutopilotWind> wind;
  Stream<Eigen::Quaterniond> attitude;  ///< only while there is no ATT
};

/// Rejected values and messages, by message name.
struct Rejected {
  std::uint64_t count = 0, first_at = 0;
};

/// What `info` tells besides streams: name and value.
using Details = std::vector<std::pair<std::string, std::string>>;

class Boot {
 public:
  /// A sound message of a bound row.
  void take(const Binding& row, const DataflashMessage& message, LogTime t);
  /// A message that must not be used: garbage may have begun inside it.
  void reject(const DataflashMessage& message);
  /// What a boot without its own identity inherits from the one before.
  void inherit(const Boot& before);
  bool has_data() const;
  /// ATT in PX4's old dialect of the container.
  bool is_px4_log() const { return px4_; }
  Flight finish(const std::string& file, Details& details) &&;

 private:
  void take_attitude(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_gps(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_gps_accuracy(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_ekf_state(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_ekf_wind(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_barometer(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_imu(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_position(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_esc(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_origin(const Binding& row, const DataflashMessage& message);
  void take_hygrometer(const Binding& row, const DataflashMessage& message, LogTime t);
  void take_event(int id, LogTime t);
  void take_text(std::string_view text, LogTime t);
  void note_mode(int mode, LogTime t);

  VehicleIdentity identity() const;
  std::optional<double> parameter(const std::string& name) const;
  int ekf_generation() const;
  const GpsColumns* best_gps(int& instance) const;
  void choose_velocity(int gps_instance, int ekf_generation, int core);
  int primary_core(int generation, std::size_t& cores) const;
  void finish_ekf(int generation, int core, const std::string& file, Details& details);
  void finish_gps(int instance);
  void name_sources();
  void note_rejected(const std::string& file);
  void finish_landed();

  static constexpr int most_instances = 8;
  Flight flight_;
  std::map<int, GpsColumns> gps_;
  std::map<std::pair<int, int>, EkfColumns> ekf_;         // generation, core
  std::map<std::pair<int, int>, std::uint64_t> primary_;  // generation, index
  std::map<int, std::uint64_t> attitude_by_;              // ATT.AEKF
  std::map<std::string, double> parameters_;
  std::map<std::string, Rejected> rejected_;
  Stream<MslHeight> fused_height_;
  Stream<GeoPoint> fused_position_;
  std::vector<std::pair<LogTime, bool>> landing_;
  std::vector<double> barometer_ages_;  ///< [s]
  RotorSpeeds rpm_;
  LogTime rotors_since_;
  int last_esc_ = -1, imu_instance_ = -1, barometer_instance_ = -1;
  std::string firmware_, frame_, board_;
  bool simulated_ = false, px4_ = false, saw_landing_ = false;
};

}  // namespace quadsonde::ingest::dataflash

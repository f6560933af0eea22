#pragma once
// The wind along a flight: values with their covariance, or "no estimate" with its reason.
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ingest/flight/flight.h"

namespace quadsonde::estimator {

enum class Quality : std::uint8_t { good, doubtful, bad, none };
std::string_view name(Quality quality);

/// Why a value is not simply good, or is not there. Each has one sentence, written down once.
enum class Reason : std::uint8_t {
  // none: no value
  converging,          ///< the wind is not yet told apart from the start values
  no_attitude,         ///< attitude missing around this instant
  data_gap,            ///< no velocity for longer than the filter may coast
  on_ground,
  tilt_over_45_deg,
  no_samples,          ///< an empty bin
  // doubtful or bad
  fast_descent,        ///< descending faster than the drag law is known
  trim_unobserved,     ///< the heading never turned: tilt trim is at its prior
  wide_uncertainty,    ///< sd above 1 m/s and above 30 % of the speed
  outside_airspeed_range,
  low_height,          ///< below 3 m: ground effect
  model_fault,         ///< jumps or rejections say that the model does not fit this flight
  crosstalk_heading,   ///< wind turns with the nose
  crosstalk_velocity,  ///< wind follows the vehicle's own velocity
  few_samples,         ///< fewer than 10 samples or 1 effective one in the bin
  up_down_differ,      ///< ascent and descent contradict each other
  inconsistent_telemetry,  ///< the check found the log to contradict itself
  doubtful_telemetry,  ///< the log fits the equations of motion badly, no fault could be named
  noise_misfit,        ///< innovations far from the noise that the log states
  hold_out_failed,     ///< velocities kept from the filter were not foretold within their uncertainty
  halves_differ,       ///< the two halves of a level flight contradict each other
  height_drift,        ///< take-off and landing, or barometer and GNSS, disagree on the height
  uncalibrated,        ///< class prior instead of a vehicle file (told, not a fault of the value)
  standard_density,    ///< air density from the standard atmosphere
  accelerometer_differs,  ///< the body accelerometer tells of another airspeed than the attitude
  no_thrust_model,     ///< vertical wind: the log has no rotor speeds, or they do not give the thrust well enough
  count
};
/// One sentence for people, without full stop.
std::string_view sentence(Reason reason);
/// One word for programs: "fast_descent".
std::string_view name(Reason reason);
/// What a reason by itself makes of a value: none, doubtful or bad; good where it is only told. The one place where
/// qualities follow from reasons. Source: MODEL.md section 10.
Quality at_best(Reason reason);

class Reasons {
 public:
  void add(Reason r) { bits_ |= std::uint32_t{1} << static_cast<unsigned>(r); }
  void add(Reasons other) { bits_ |= other.bits_; }
  bool has(Reason r) const { return bits_ >> static_cast<unsigned>(r) & 1; }
  /// The quality of a value that carries these reasons: the worst that one of them allows.
  Quality at_best() const;
  bool empty() const { return bits_ == 0; }
  std::vector<Reason> list() const;
  friend bool operator==(Reasons, Reasons) = default;

 private:
  std::uint32_t bits_ = 0;
};

/// Horizontal wind v_NA_N (north, east) [m/s], the velocity of the air over ground, with its covariance [m2/s2].
struct WindEstimate {
  Eigen::Vector2d v_NA_N = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< everything: noise, trim, calibration
  bool has_covariance = true;                            ///< the classic filter reports none
};

/// Speed and direction where people read; nothing computes with it.
struct WindReport {
  double speed_m_s = 0;
  std::optional<double> from_deg;  ///< clockwise from true north, 0 < d <= 360
};
/// from_deg is empty while the speed is below twice its own sd (classic: below 0.5 m/s).
/// Source: WMO-No. 306, Vol. I.2, FM 94 BUFR, Table B 0 11 001 and 0 11 002 for the sense of direction.
WindReport to_report(const WindEstimate& wind);
/// 1-sigma of the speed: the covariance along the vector (along its widest axis in calm).
double speed_sd(const WindEstimate& wind);
/// 1-sigma of the direction [deg]: the covariance across the vector over the speed; empty where from_deg is.
std::optional<double> direction_sd_deg(const WindEstimate& wind);

struct NoEstimate {
  Reason reason = Reason::no_samples;
};
using MaybeWind = std::variant<WindEstimate, NoEstimate>;

struct WindPoint {
  ingest::LogTime time;  ///< when the wind held: the latency is taken off
  std::optional<ingest::UtcTime> utc;
  std::optional<ingest::GeoPoint> place;
  std::optional<ingest::MslHeight> height_msl;
  std::optional<ingest::GroundHeight> height_agl;
  double v_up = 0;  ///< climb rate of the vehicle [m/s]
  MaybeWind wind = NoEstimate{Reason::converging};
  Quality quality = Quality::none;
  Reasons reasons;
  /// Velocity of the vehicle relative to the air, N and E [m/s]: the rest of the state; empty where the wind is.
  std::optional<Eigen::Vector2d> v_AB_N;
  /// Online drag: the factor on the vehicle's drag as of this instant (smoothed: as of the whole flight), its sd, and
  /// whether this instant told of it. Empty where the drag is not learned.
  struct Drag {
    float factor = 1, sd = 0;
    bool updated = false;
  };
  std::optional<Drag> drag;
  /// Vertical wind, up positive, and its sd [m/s]. Empty: no thrust model, and the flight's diagnostics say why.
  struct Vertical {
    float wind_up = 0, sd = 0;
  };
  std::optional<Vertical> vertical;
};

enum class Mode { smoothed, causal, classic };
std::string_view name(Mode mode);

/// What the two passes leave behind for exact bin statistics; opaque to everyone but profiles and the estimator.
struct SmootherTrace;

/// A test of the estimate that needs no truth. Source: design notes, section 9.
struct SelfCheck {
  std::string name;      ///< for programs: "heading_crosstalk_m_s"
  std::string sentence;  ///< what it is and what came out, for people
  double value = 0;
  std::optional<double> sd;     ///< of the value by chance
  std::optional<double> limit;  ///< beyond which it fails
  bool judged = false;          ///< this flight can show it; else the value is only told
  bool passed = true;
  Reason reason = Reason::model_fault;  ///< which a failure gives to every value
};

/// Drag learned in flight. Source: MODEL.md section 16.
struct OnlineDrag {
  double factor = 1, sd = 0;             ///< on the vehicle's drag; sd relative
  double latency = 0, latency_sd = 0;    ///< as used [s]
  double seconds = 0;                    ///< during which the motion told of it; 0: factor and sd are the prior
  std::optional<ingest::LogTime> first, last;  ///< instants that told of it
};

/// Vertical wind over a flight. Source: MODEL.md section 17.
struct VerticalWind {
  std::optional<NoEstimate> none;        ///< no vertical wind
  std::string why;                       ///< there is none, for people: a clause
  double thrust_per_speed2 = 0;          ///< K of the mean specific thrust at the mean of the squared speeds [m/s2]
  double axial = 0, axial_sd = 0;        ///< c_z [1/s]
  bool axial_from_flight = false;        ///< else from the induced velocity of the class
  bool rotors_logged = false;
  double level_sd = 0;                   ///< of the flight's mean, which no log can show [m/s]
};

/// What the flight says about itself, for `info`, reports and the quality rules.
struct FlightDiagnostics {
  double heading_index = 0;       ///< 0: never turned, 1: all headings alike
  bool trim_estimated = false;
  double excitation = 0;          ///< X of the design notes, section 5 [m/s]
  double sigma_u = 0;             ///< turbulence, maximum likelihood [m/s]
  double nis_mean = 0;            ///< 2 when the noise is as assumed
  int jumps = 0, rejected = 0, restarts = 0;
  bool jump_test_off = false;     ///< too many jumps: both passes were repeated without the test
  Eigen::Vector2d trim_deg = Eigen::Vector2d::Zero();     ///< roll, pitch as estimated
  Eigen::Vector2d trim_sd_deg = Eigen::Vector2d::Zero();
  double log_likelihood = 0;
  std::vector<SelfCheck> self_checks;
  double climb_linear = 0, climb_linear_sd = 0;  ///< alpha as used [s/m]
  double climb_quadratic = 0, climb_quadratic_sd = 0;  ///< g2 as used [s2/m2]
  bool climb_estimated = false;
  double velocity_sd = 0;         ///< noise of the velocity where the log states none [m/s]
  double max_tilt_deg = 0, max_airspeed = 0;
  bool standard_density = true;
  double air_density = 0;
  std::optional<OnlineDrag> online_drag;        ///< where it was asked for
  std::optional<VerticalWind> vertical;         ///< where it was asked for
};

struct WindSeries {
  Mode mode = Mode::smoothed;
  std::vector<WindPoint> points;  ///< one per filter step
  FlightDiagnostics diagnostics;
  std::vector<ingest::Problem> problems;
  std::shared_ptr<const SmootherTrace> trace;  ///< smoothed mode only
};

/// Gives every value the reasons, and the quality that they leave it at best. What has no value keeps its own reason.
void add_to_all(WindSeries& series, Reasons reasons);

}  // namespace quadsonde::estimator

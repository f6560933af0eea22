#pragma once
// What a log holds and what can be made of it, before anything is estimated.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "export/pipeline/load.h"
#include "export/report/words.h"

namespace quadsonde::product {

struct StreamFacts {
  std::string name;    ///< "attitude"
  std::string source;  ///< as the log calls it
  std::size_t samples = 0;
  std::optional<double> rate_hz;   ///< by the median interval
  std::optional<double> jitter_s;  ///< robust sd of the intervals: 1.4826 times the median distance from their median
  std::optional<double> longest_gap_s;
  std::size_t gaps = 0;  ///< intervals above 1 s and above five median ones
  std::optional<ingest::Latency> latency;
};

struct BootFacts {
  std::string vehicle, autopilot, firmware, airframe;
  int rotors = 0;
  bool simulated = false;
  std::optional<double> utc_uncertainty_s;  ///< empty while UTC is not known
  std::string clock_source;
  std::vector<StreamFacts> streams;
  std::optional<Eigen::Vector2d> autopilot_wind;  ///< its own, the mean of all it said: v_NA_N [m/s]
  std::optional<ingest::Problem> lacking;         ///< why no wind can come of it
};

/// What was flown, as far as the wind and the calibration care. Source: design notes, sections 4, 5 and 8.
struct Manoeuvre {
  double heading_index = 0;       ///< 0: the nose never turned, 1: all headings alike
  double turned_deg = 0;          ///< the way of the nose, back and forth, with wobbles below 10 degrees left out
  double excitation = 0;          ///< X: motion that is neither constant nor turns with the nose [m/s]
  double turning_motion = 0;      ///< rms of the motion that turns with the nose, as along a circle [m/s]
  int reversals = 0;              ///< changes from one straight leg to another, 60 degrees and more
  double max_speed = 0;           ///< over ground [m/s]
  int ascents = 0, descents = 0;  ///< of at least one bin
  std::optional<double> lowest, highest;  ///< above take-off, or above sea level [m]
  bool above_takeoff = false;
};

/// How far a flight by itself can show each unknown. Source: design notes, section 8.
struct Observability {
  enum class Wind {
    yes,
    by_height,
    with_drag_given,    ///< an error of the drag passes for a tilt trim, since motion and nose turned together
    within_trim_prior,  ///< 0.7 m/s for each degree that the trim is not known to
    shear_only          ///< the same for the level; differences between heights are free of it
  };
  enum class Drag {
    yes,
    with_latency_known,  ///< else some 5 % off
    refused,             ///< motion enough for a value, which would be 4 to 12 % off
    no                   ///< a fit finds something all the same
  };
  Wind wind = Wind::yes;
  Drag drag = Drag::no;
  bool trim = false, latency = false;
};
/// For programs: "by_height".
std::string_view name(Observability::Wind wind);
std::string_view name(Observability::Drag drag);
/// For people, without full stop.
std::string wind_sentence(const Observability& observable);
std::string trim_sentence(const Observability& observable);
std::string drag_sentence(const Observability& observable, const Manoeuvre& manoeuvre);
std::string latency_sentence(const Observability& observable, const Manoeuvre& manoeuvre);

struct FlightFacts {
  FlightTitle title;
  Manoeuvre manoeuvre;
  Observability observable;
  bool starts_in_air = false, ends_in_air = false;
  bool trim_can_be_measured = false, profile_possible = false, can_calibrate = false;
  std::vector<std::string> advice;  ///< which manoeuvre would help
};

struct LogFacts {
  std::string file, sha256, format;
  std::uint64_t messages = 0, salvaged = 0;
  std::vector<std::pair<std::string, std::string>> details;
  std::vector<ingest::TopicCount> topics;
  std::vector<BootFacts> boots;
  std::vector<FlightFacts> flights;
  std::optional<ingest::Problem> nothing;
  std::vector<ingest::Problem> problems;
};

Manoeuvre find_manoeuvre(const FlightPart& part, double bin_m);
Observability observability(const Manoeuvre& manoeuvre, double bin_m);
LogFacts inspect(const LoadedLog& log, double bin_m = 10);

/// For a terminal of 80 columns.
std::string info_text(const LogFacts& facts);
/// Object of schema quadsonde.info/1, as text.
std::string info_json(const LogFacts& facts);

}  // namespace quadsonde::product

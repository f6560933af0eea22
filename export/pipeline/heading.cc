#include "export/pipeline/heading.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace quadsonde::product {
namespace {

using ingest::Flight;
using ingest::Kind;

void turn(Flight& flight, double deg) {
  const Eigen::Quaterniond by(Eigen::AngleAxisd(deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  for (auto& q_NB : flight.attitude.value) q_NB = (by * q_NB).normalized();
}

/// Their estimators turn the compass by a declination of their own before anything is logged.
bool turned_by_autopilot(const Flight& flight, const std::string& format) {
  return format != "csv" && (flight.vehicle.autopilot == "PX4" || flight.vehicle.autopilot == "ArduPilot");
}

/// Within a flight the declination changes by hundredths of a degree: its middle will do.
std::optional<Declination> declination_of(const Flight& flight, const MagneticNorth& north) {
  std::optional<ingest::GeoPoint> point;
  if (!flight.position.empty())
    point = flight.position.value[flight.position.size() / 2];
  else if (flight.origin)
    point = flight.origin->point;
  if (!point) return std::nullopt;
  const double height = flight.height_msl.empty() ? 0 : flight.height_msl.value[flight.height_msl.size() / 2].m;
  return north.declination(*point, height, flight.clock.to_utc(flight.attitude.time[flight.attitude.size() / 2]));
}

std::string signed_deg(double deg) { return fmt::format("{:+.1f} deg", deg); }

void add_unknown(Flight& flight, const MagneticNorth& north, const std::string& file, HeadingFacts& facts) {
  facts.sd_deg = unknown_declination_deg;
  facts.words = fmt::format("magnetic headings, declination not known (+-{:.0f} deg)", unknown_declination_deg);
  const bool no_models = north.empty();
  flight.problems.push_back(
      {Kind::doubtful,
       fmt::format(
           "the headings are magnetic and the declination is not known, since {}: wind directions are uncertain "
           "by another {:.0f} deg",
           no_models ? "no magnetic model was found" : "the log has no place, or one too near a magnetic pole",
           unknown_declination_deg),
       {file, {}, {}, {}},
       no_models ? "name the folder of wmm2025.wmm in QUADSONDE_MAGNETIC, or give --heading-offset-deg"
                 : "give the declination with --heading-offset-deg"});
}

void add_declination(Flight& flight, const Declination& d, const std::string& file, HeadingFacts& facts) {
  turn(flight, d.deg);
  facts.added_deg += d.deg;
  facts.sd_deg = d.sd_deg;
  facts.words = fmt::format("declination {} added ({}; +-{:.1f} deg)", signed_deg(d.deg), d.model, d.sd_deg);
  const ingest::Where where{file, {}, {}, {}};
  if (!d.date_known)
    flight.problems.push_back(
        {Kind::doubtful, fmt::format("the log has no date, so its declination may be off by {:.1f} deg", d.sd_deg),
         where, "give --start-utc"});
  else if (d.outside_validity)
    flight.problems.push_back({Kind::doubtful,
                               fmt::format("the log's date is outside the magnetic models ({}): the declination may be "
                                           "off by {:.1f} deg",
                                           d.model, d.sd_deg),
                               where, "give the declination with --heading-offset-deg and --heading true"});
}

}  // namespace

HeadingFacts correct_heading(Flight& flight, const std::string& format, bool magnetic_by_map,
                             const InputSettings& settings, const MagneticNorth& north, const std::string& file) {
  HeadingFacts facts;
  if (flight.attitude.empty()) return facts;
  if (settings.heading == "magnetic" && turned_by_autopilot(flight, format)) {
    flight.problems.push_back({Kind::doubtful,
                               fmt::format("{} logs true headings, the declination is in them already: it is not added "
                                           "twice",
                                           flight.vehicle.autopilot),
                               {file, {}, {}, {}},
                               "leave --heading out; what is left to correct goes into --heading-offset-deg"});
  } else if (settings.heading == "magnetic" || magnetic_by_map) {
    if (const auto d = declination_of(flight, north))
      add_declination(flight, *d, file, facts);
    else
      add_unknown(flight, north, file, facts);
  }
  if (settings.heading_offset_deg != 0) {
    turn(flight, settings.heading_offset_deg);
    facts.added_deg += settings.heading_offset_deg;
    facts.words += fmt::format("{}headings turned by {} as asked", facts.words.empty() ? "" : "; ",
                               signed_deg(settings.heading_offset_deg));
  }
  return facts;
}

}  // namespace quadsonde::product

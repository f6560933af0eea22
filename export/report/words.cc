#include "export/report/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace quadsonde::product {

std::string compass_word(double from_deg) {
  static constexpr std::array<std::string_view, 16> words{"north", "north-northeast", "northeast", "east-northeast",
                                                          "east",  "east-southeast",  "southeast", "south-southeast",
                                                          "south", "south-southwest", "southwest", "west-southwest",
                                                          "west",  "west-northwest",  "northwest", "north-northwest"};
  const double turned = std::fmod(std::fmod(from_deg, 360) + 360 + 11.25, 360);
  return std::string(words[static_cast<std::size_t>(turned / 22.5) % 16]);
}

std::string place_text(ingest::GeoPoint place) {
  return fmt::format("{:.4f} {}, {:.4f} {}", std::abs(place.lat_deg), place.lat_deg < 0 ? "S" : "N",
                     std::abs(place.lon_deg), place.lon_deg < 0 ? "W" : "E");
}

std::string duration_text(double seconds) {
  const auto whole = std::lround(std::max(0.0, seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string minute_text(ingest::UtcTime time) {
  auto text = ingest::to_iso8601(time, 0).substr(0, 16);
  if (text.size() > 10) text[10] = ' ';
  return text + " UTC";
}

std::string title_text(const FlightTitle& title) {
  return title.flights > 1 ? fmt::format("{}, flight {} of {}", title.file, title.flight, title.flights) : title.file;
}

std::string when_and_where(const FlightTitle& title) {
  std::string text;
  const auto append = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  append(title.start ? minute_text(*title.start) : "date not known");
  if (title.place) append(place_text(*title.place));
  append(duration_text(title.duration_s) + " in the air");
  if (!title.heading.empty()) append(title.heading);
  return text;
}

std::string vehicle_sentence(const ingest::Vehicle& vehicle) {
  const double c = vehicle.drag.linear;
  const double relative = c > 0 ? std::hypot(vehicle.parameter_sd(ingest::p_linear) / c,
                                             vehicle.is_prior() ? 0.0 : vehicle.between_flights_rel_sd)
                                : 0;
  if (vehicle.is_prior())
    return fmt::format(
        "No vehicle file: the drag of {} stands in ({}: class prior, not calibrated). It is uncertain by {:.0f} %, and "
        "so is every speed here; directions hardly depend on it.",
        vehicle.id == "class:generic" ? "an average multirotor" : "an average one of " + vehicle.name, vehicle.id,
        100 * relative);
  return fmt::format("Drag of {} ({}), uncertain by {:.0f} % between flights.",
                     vehicle.name.empty() ? vehicle.id : vehicle.name, vehicle.method, 100 * relative);
}

std::string learned_sentence(const estimator::FlightDiagnostics& diagnostics) {
  const auto& drag = diagnostics.online_drag;
  if (!drag) return {};
  if (drag->seconds <= 0)
    return fmt::format(
        "Online drag: never updated, since the flight's own motion does not tell of it (index {:.1f} m/s, 1.5 needed "
        "over a minute); the drag stays as it was, uncertain by {:.0f} %.",
        diagnostics.excitation, 100 * drag->sd);
  return fmt::format(
      "Online drag: {:.3f} +- {:.3f} (1 sigma) times the vehicle's, latency {:.3f} +- {:.3f} s, learned during {} of "
      "the flight.",
      drag->factor, drag->factor * drag->sd, drag->latency, drag->latency_sd, duration_text(drag->seconds));
}

std::string vertical_sentence(const estimator::FlightDiagnostics& diagnostics) {
  const auto& vertical = diagnostics.vertical;
  if (!vertical) return {};
  if (vertical->none) return fmt::format("No vertical wind: {}.", vertical->why);
  return fmt::format(
      "Vertical wind from the rotor speeds, about its mean over the flight: the thrust answers with {:.2f} +- {:.2f} "
      "m/s2 per m/s{}.",
      vertical->axial, vertical->axial_sd, vertical->axial_from_flight ? "" : ", as rotors of its size do");
}

std::string problem_sentence(const ingest::Problem& problem) {
  auto shown = problem;
  shown.where.file = std::filesystem::path(problem.where.file).filename().string();
  auto& hint = shown.hint;
  if (!hint.empty() && hint[0] >= 'a' && hint[0] <= 'z') hint[0] = static_cast<char>(hint[0] - 'a' + 'A');
  return ingest::to_string(shown);
}

const profiles::Leg* find_leg(const profiles::WindProfile& profile, profiles::LegName name) {
  for (const auto& leg : profile.legs)
    if (leg.name == name) return &leg;
  return nullptr;
}

const profiles::Leg* main_leg(const profiles::WindProfile& profile) {
  if (const auto* all = find_leg(profile, profiles::LegName::all)) return all;
  return profile.legs.empty() ? nullptr : &profile.legs.front();
}

double middle(const profiles::Bin& bin) { return (bin.bottom + bin.top) / 2; }

std::string wind_words(const estimator::WindEstimate& wind) {
  const auto report = estimator::to_report(wind);
  if (!report.from_deg) return fmt::format("{:.1f} m/s, direction not determined", report.speed_m_s);
  return fmt::format("{:.1f} m/s from {:.0f} deg ({})", report.speed_m_s, *report.from_deg,
                     compass_word(*report.from_deg));
}

std::vector<std::string> advice(const estimator::FlightDiagnostics& d, const ingest::Vehicle& vehicle,
                                estimator::Reasons reasons) {
  std::vector<std::string> all;
  if (reasons.has(estimator::Reason::inconsistent_telemetry))
    all.push_back(
        "See what `quadsonde check` says of this log and correct its columns (--columns MAP.toml): nothing else helps "
        "before.");
  if (vehicle.is_prior())
    all.push_back(fmt::format(
        "Give a vehicle file (--vehicle FILE): it brings the speeds from +-{:.0f} % to about +-6 %.",
        100 * vehicle.parameter_sd(ingest::p_linear) / vehicle.drag.linear));
  if (!d.trim_estimated)
    all.push_back(
        "Turn the nose through at least one full turn in flight: then the tilt trim is measured, not assumed.");
  return all;
}

namespace {

using ReasonCounts = std::array<std::size_t, static_cast<std::size_t>(estimator::Reason::count)>;

/// The reasons of one row: its own, and why it has no value.
estimator::Reasons with_cause(estimator::Reasons reasons, const estimator::MaybeWind& wind) {
  if (const auto* none = std::get_if<estimator::NoEstimate>(&wind)) reasons.add(none->reason);
  return reasons;
}

void count(ReasonCounts& counts, estimator::Reasons reasons) {
  for (const auto reason : reasons.list()) ++counts[static_cast<std::size_t>(reason)];
}

std::vector<std::pair<estimator::Reason, std::size_t>> most_frequent_first(const ReasonCounts& counts) {
  std::vector<std::pair<estimator::Reason, std::size_t>> all;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i]) all.emplace_back(static_cast<estimator::Reason>(i), counts[i]);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return all;
}

}  // namespace

estimator::Reasons reasons_of(const estimator::WindSeries& series) {
  estimator::Reasons all;
  for (const auto& point : series.points) all.add(with_cause(point.reasons, point.wind));
  return all;
}

estimator::Reasons reasons_of(const profiles::WindProfile& profile) {
  estimator::Reasons all;
  if (const auto* leg = main_leg(profile))
    for (const auto& bin : leg->bins) all.add(with_cause(bin.reasons, bin.wind));
  return all;
}

std::vector<std::pair<estimator::Reason, std::size_t>> count_reasons(const profiles::Leg& leg) {
  ReasonCounts counts{};
  for (const auto& bin : leg.bins) count(counts, with_cause(bin.reasons, bin.wind));
  return most_frequent_first(counts);
}

std::vector<std::pair<estimator::Reason, std::size_t>> count_reasons(const estimator::WindSeries& series) {
  ReasonCounts counts{};
  for (const auto& point : series.points) count(counts, with_cause(point.reasons, point.wind));
  return most_frequent_first(counts);
}

}  // namespace quadsonde::product

#include "export/report/text_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "export/report/level_words.h"

namespace quadsonde::product {
namespace {

using estimator::Quality;
using estimator::WindEstimate;

std::string without_tail(std::string line) {
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

std::string direction_text(const std::optional<double>& from) { return from ? fmt::format("{:3.0f}", *from) : "  -"; }

/// "3.20 +-0.41  253 +- 8  good", or what stands for nothing.
std::string full_columns(const profiles::Bin& bin) {
  const auto* wind = std::get_if<WindEstimate>(&bin.wind);
  if (!wind) return fmt::format("{:>6} {:>7} {:>6} {:>7}  {:<8}", "-", "", "-", "", "none");
  const auto report = estimator::to_report(*wind);
  const auto sd_from = wind->has_covariance ? estimator::direction_sd_deg(*wind) : std::nullopt;
  const auto speed_half = wind->has_covariance ? fmt::format("+-{:.2f}", 1.96 * estimator::speed_sd(*wind)) : "";
  const auto from_half = sd_from ? fmt::format("+-{:.0f}", std::min(180.0, 1.96 * *sd_from)) : "";
  return fmt::format("{:6.2f} {:>7} {:>6} {:>7}  {:<8}", report.speed_m_s, speed_half, direction_text(report.from_deg),
                     from_half, estimator::name(bin.quality));
}

std::string short_columns(const profiles::Leg* leg, std::size_t i) {
  if (!leg) return "";
  const auto* wind = i < leg->bins.size() ? std::get_if<WindEstimate>(&leg->bins[i].wind) : nullptr;
  if (!wind) return fmt::format("  {:>6} {:>3}", "-", "-");
  const auto report = estimator::to_report(*wind);
  return fmt::format("  {:6.2f} {}", report.speed_m_s, direction_text(report.from_deg));
}

std::string table_head(const profiles::WindProfile& profile, bool legs) {
  const char* datum = profile.datum == profiles::Datum::agl ? "take-off" : "sea level";
  auto text =
      fmt::format("{:<12}{:>7} {:>7} {:>6} {:>7}  {:<8}", "height above", "speed", "95 %", "from", "95 %", "quality");
  if (legs) text += "     ascent     descent";
  text = without_tail(text) + fmt::format("\n{:<12}{:>7} {:>7} {:>6} {:>7}  {:<8}", fmt::format("{}, m", datum), "m/s",
                                          "m/s", "deg", "deg", "");
  if (legs) text += "   m/s deg     m/s deg";
  return without_tail(text) + "\n";
}

std::string reasons_text(const profiles::WindProfile& profile) {
  std::string text;
  for (const auto& leg : profile.legs)
    for (const auto& [reason, rows] : count_reasons(leg)) {
      if (&leg != main_leg(profile)) continue;
      const std::string sentence(estimator::sentence(reason));
      text += wrapped(fmt::format("- {} ({} of {} bins)", sentence, rows, leg.bins.size()), 79, 2) + "\n";
    }
  return text.empty() ? text : "What the quality rests on:\n" + text;
}

/// The same for the instants of a flight, by their share of it.
std::string reasons_text(const estimator::WindSeries& series) {
  std::string text;
  for (const auto& [reason, count] : count_reasons(series)) {
    const double share = 100.0 * static_cast<double>(count) / static_cast<double>(series.points.size());
    const auto how_often = share < 1 ? std::string("less than 1 %") : fmt::format("{:.0f} %", share);
    text += wrapped(fmt::format("- {} ({} of the time)", estimator::sentence(reason), how_often), 79, 2) + "\n";
  }
  return text.empty() ? text : "What the quality rests on:\n" + text;
}

/// The first few lines of what is asked next; JSON and report have all of it.
std::string levels_text(const profiles::WindProfile& profile) {
  std::string text;
  for (const auto& sentence : level_sentences(profile)) text += wrapped("- " + sentence, 79, 2) + "\n";
  return text.empty() ? text : "Levels, shear and laws (heights above take-off, 95 %):\n" + text;
}

/// What the flight is no profile of, and what would be one.
std::string notes_text(const profiles::WindProfile& profile) {
  std::string text;
  for (const auto& note : note_sentences(profile)) text += wrapped(note) + "\n";
  return text;
}

/// Tests of the estimate against itself that failed; passed ones are no news.
std::string failed_checks(const estimator::FlightDiagnostics& diagnostics) {
  std::string text;
  for (const auto& check : diagnostics.self_checks)
    if (check.judged && !check.passed) text += wrapped("- " + check.sentence, 79, 2) + "\n";
  return text.empty() ? text : "What the estimate says against itself:\n" + text;
}

std::string closing(const estimator::FlightDiagnostics& diagnostics, const ingest::Vehicle& vehicle,
                    estimator::Reasons reasons, const std::optional<AutopilotComparison>& autopilot) {
  auto text = failed_checks(diagnostics) + wrapped(vehicle_sentence(vehicle)) + "\n";
  if (const auto learned = learned_sentence(diagnostics); !learned.empty()) text += wrapped(learned) + "\n";
  // Most logs have no rotor speeds; only where they have is it news that nothing came of them.
  if (diagnostics.vertical && diagnostics.vertical->rotors_logged)
    if (const auto vertical = vertical_sentence(diagnostics); !vertical.empty()) text += wrapped(vertical) + "\n";
  if (autopilot) text += wrapped(autopilot_sentence(*autopilot)) + "\n";
  const auto better = advice(diagnostics, vehicle, reasons);
  if (better.empty()) return text;
  text += "What would make it better:\n";
  for (const auto& sentence : better) text += wrapped("- " + sentence, 79, 2) + "\n";
  return text;
}

std::string heading_lines(const FlightTitle& title) {
  auto text = title_text(title);
  if (!title.vehicle.empty()) text += ", " + title.vehicle;
  return wrapped(text) + "\n" + wrapped(when_and_where(title)) + "\n\n";
}

/// What one part of the flight shows.
struct Part {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double low = 1e9, high = -1e9;
  std::size_t count = 0, rows = 0;
  std::size_t of_quality[4] = {};
  bool has_covariance = true;
};

Part collect(const std::vector<estimator::WindPoint>& points, std::size_t from, std::size_t to) {
  Part part;
  for (std::size_t i = from; i < to; ++i) {
    const auto& p = points[i];
    ++part.rows;
    const auto height = p.height_agl   ? std::optional(p.height_agl->m)
                        : p.height_msl ? std::optional(p.height_msl->m)
                                       : std::nullopt;
    if (height) part.low = std::min(part.low, *height), part.high = std::max(part.high, *height);
    const auto* wind = std::get_if<WindEstimate>(&p.wind);
    if (!wind) continue;
    part.sum += wind->v_NA_N;
    part.covariance += wind->covariance;
    part.has_covariance = part.has_covariance && wind->has_covariance;
    ++part.of_quality[static_cast<int>(p.quality)];
    ++part.count;
  }
  return part;
}

/// The quality that at least half of the values have or are above.
Quality most_of(const Part& part) {
  std::size_t worse = part.of_quality[static_cast<int>(Quality::bad)];
  if (worse * 2 > part.count) return Quality::bad;
  worse += part.of_quality[static_cast<int>(Quality::doubtful)];
  return worse * 2 > part.count ? Quality::doubtful : Quality::good;
}

std::string part_line(const Part& part, double start_s, double end_s) {
  const auto time = fmt::format("{:>5.0f}-{:<5.0f}", start_s, end_s);
  const auto height = part.low <= part.high ? fmt::format("{:.0f}-{:.0f}", part.low, part.high) : "-";
  if (!part.count) return fmt::format("{}  {:>11}  {:>6} {:>7} {:>6} {:>7}  none\n", time, height, "-", "", "-", "");
  const auto n = static_cast<double>(part.count);
  const WindEstimate mean{part.sum / n, part.covariance / n, part.has_covariance};
  const auto report = estimator::to_report(mean);
  const auto sd_from = part.has_covariance ? estimator::direction_sd_deg(mean) : std::nullopt;
  const auto speed_half = part.has_covariance ? fmt::format("+-{:.2f}", 1.96 * estimator::speed_sd(mean)) : "";
  return fmt::format("{}  {:>11}  {:6.2f} {:>7} {:>6} {:>7}  {}\n", time, height, report.speed_m_s, speed_half,
                     direction_text(report.from_deg),
                     sd_from ? fmt::format("+-{:.0f}", std::min(180.0, 1.96 * *sd_from)) : "",
                     estimator::name(most_of(part)));
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent) {
  std::string out;
  std::size_t at = std::min(text.find_first_not_of(' '), text.size());
  std::string line = text.substr(0, at);
  bool fresh = true;  // nothing but blanks in the line so far
  while (at < text.size()) {
    const auto end = std::min(text.find(' ', at), text.size());
    const auto word = text.substr(at, end - at);
    at = end + 1;
    if (!fresh && line.size() + 1 + word.size() > columns) {
      out += line + "\n";
      line = std::string(indent, ' ') + word;
    } else {
      line += (fresh ? "" : " ") + word;
    }
    fresh = false;
  }
  return out + line;
}

std::string profile_table(const profiles::WindProfile& profile) {
  const auto* leg = main_leg(profile);
  if (!leg) return "no bins\n";
  const auto* up = find_leg(profile, profiles::LegName::up);
  const auto* down = find_leg(profile, profiles::LegName::down);
  const bool legs = up && down && leg->name == profiles::LegName::all;
  auto text = table_head(profile, legs);
  for (std::size_t i = leg->bins.size(); i-- > 0;) {
    const auto& bin = leg->bins[i];
    auto line = fmt::format("{:<12}{:>7}", fmt::format("{:>5.0f}-{:<5.0f}", bin.bottom, bin.top), "");
    line = line.substr(0, 12) + " " + full_columns(bin);
    if (legs) line += short_columns(up, i) + short_columns(down, i);
    text += without_tail(line) + "\n";
  }
  return text;
}

std::string profile_answer(const FlightTitle& title, const profiles::WindProfile& profile,
                           const estimator::FlightDiagnostics& diagnostics, const ingest::Vehicle& vehicle,
                           const std::optional<AutopilotComparison>& autopilot) {
  return heading_lines(title) + profile_table(profile) + "\n" + notes_text(profile) + levels_text(profile) +
         reasons_text(profile) + closing(diagnostics, vehicle, reasons_of(profile), autopilot);
}

std::string merged_answer(const FlightTitle& title, const profiles::WindProfile& profile, const std::string& spread,
                          const ingest::Vehicle& vehicle) {
  return heading_lines(title) + profile_table(profile) + "\n" + levels_text(profile) + reasons_text(profile) +
         wrapped(spread) + "\n" + wrapped(vehicle_sentence(vehicle)) + "\n";
}

std::string wind_answer(const FlightTitle& title, const estimator::WindSeries& series, const ingest::Vehicle& vehicle,
                        const std::optional<AutopilotComparison>& autopilot) {
  auto text = heading_lines(title);
  text += fmt::format("{:<11}  {:>11}  {:>6} {:>7} {:>6} {:>7}  quality\n", "time", "height", "speed", "95 %", "from",
                      "95 %");
  text += fmt::format("{:<11}  {:>11}  {:>6} {:>7} {:>6} {:>7}\n", "s", "m", "m/s", "m/s", "deg", "deg");
  const auto& points = series.points;
  const std::size_t parts = std::min<std::size_t>(12, std::max<std::size_t>(1, points.size() / 50));
  for (std::size_t k = 0; k < parts && !points.empty(); ++k) {
    const auto from = points.size() * k / parts, to = points.size() * (k + 1) / parts;
    text += part_line(collect(points, from, to), ingest::to_seconds(points[from].time - points.front().time),
                      ingest::to_seconds(points[to - 1].time - points.front().time));
  }
  text += "\nSpeed and direction of the mean vector of each part; the intervals are those of\none instant.\n";
  return text + reasons_text(series) + closing(series.diagnostics, vehicle, reasons_of(series), autopilot);
}

}  // namespace quadsonde::product

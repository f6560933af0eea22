// What a comparison says to people and to programs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/pipeline/compare.h"
#include "export/report/text_answer.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

using profiles::ErrorStatistics;
using profiles::MatchedReport;
using profiles::ReportScores;
using profiles::Scores;
using profiles::TruthScores;

std::string plural(std::size_t n, std::string_view one) { return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s"); }

std::string share_words(const Scores& scores) {
  return scores.inside95 ? fmt::format(", {:.0f} % of the 95 % intervals hold it", 100 * *scores.inside95)
                         : std::string();
}

std::string bias_words(const ErrorStatistics& s, std::string_view unit, int digits) {
  auto text = fmt::format("{:+.{}f} {} on average", s.bias, digits, unit);
  // Two pairs tell next to nothing of their scatter.
  if (s.n > 2 && s.bias_half95) text += fmt::format(" (95 %: +-{:.{}f})", *s.bias_half95, digits);
  return text;
}

std::vector<std::string> truth_sentences(const TruthScores& truth) {
  std::vector<std::string> all;
  if (truth.whole().n == 0)
    return {fmt::format("The reference has no {} in common with the flight: nothing could be compared.",
                        truth.by_height ? "height" : "instant")};
  if (const auto& s = truth.samples; s.n)
    all.push_back(fmt::format("Every instant ({}): vector error {:.2f} m/s rms, speed {}{}.", s.n, s.rmsve,
                              bias_words(s.speed, "m/s", 2), share_words(s)));
  for (const auto& leg : truth.legs) {
    if (!leg.scores.n) continue;
    const char* name = leg.name == profiles::LegName::up     ? "Ascent"
                       : leg.name == profiles::LegName::down ? "Descent"
                                                             : "Whole flight";
    auto text = fmt::format("{}, {}: vector error {:.2f} m/s rms, speed {}", name, plural(leg.scores.n, "bin"),
                            leg.scores.rmsve, bias_words(leg.scores.speed, "m/s", 2));
    if (leg.scores.direction.n) text += fmt::format(", direction {:.1f} degrees rms", leg.scores.direction.rmse);
    all.push_back(text + share_words(leg.scores) + ".");
  }
  if (truth.by_height)
    all.push_back("A profile has no log time: bins are matched with the truth of their heights and legs.");
  if (truth.classic && truth.classic->n)
    all.push_back(
        fmt::format("The published four-state filter on the same flight, after 60 s: vector error {:.2f} m/s rms.",
                    truth.classic->rmsve));
  return all;
}

std::string left_out_words(const Scores& s, double threshold) {
  std::vector<std::string> parts;
  if (s.n_slow) parts.push_back(fmt::format("{} below {:.3g} m/s", s.n_slow, threshold));
  if (s.n_no_direction) parts.push_back(fmt::format("{} without a direction", s.n_no_direction));
  return parts.empty() ? "" : fmt::format(" ({} left out)", fmt::join(parts, ", "));
}

std::string score_sentence(const Scores& s, double threshold) {
  auto text = fmt::format("Speed {}, {:.2f} m/s rms", bias_words(s.speed, "m/s", 2), s.speed.rmse);
  if (s.n_range) text += fmt::format("; {} of {} inside the range reported", s.n_in_range, s.n_range);
  if (s.east.n) text += fmt::format("; vector error {:.2f} m/s rms", s.rmsve);
  if (s.direction.n)
    text += fmt::format("; direction {}, {:.0f} degrees rms", bias_words(s.direction, "degrees", 0), s.direction.rmse);
  else
    text += "; no direction to compare";
  return text + left_out_words(s, threshold) + ".";
}

std::string minutes_words(double seconds) {
  return std::abs(seconds) < 5400 ? fmt::format("{:.0f} min", std::abs(seconds) / 60)
                                  : fmt::format("{:.1f} h", std::abs(seconds) / 3600);
}

std::string matching_sentence(const ReportScores& r, double window_s) {
  const auto& first = r.pairs.front();
  if (r.outside_window)
    return fmt::format("No report lies within {} of the flight; the nearest, {} {} it, stands in.",
                       minutes_words(window_s), minutes_words(first.gap_s), first.gap_s < 0 ? "before" : "after");
  return fmt::format("{} of {} within {} of the flight; each is the mean of the ten minutes before its time.",
                     r.pairs.size(), plural(r.records, "report"), minutes_words(window_s));
}

std::string distance_words(const ReportScores& r) {
  double least = INFINITY, most = 0;
  for (const auto& pair : r.pairs)
    if (pair.distance_m) least = std::min(least, *pair.distance_m), most = std::max(most, *pair.distance_m);
  if (least > most) return "distance unknown";
  if (most - least < 100) return fmt::format("{:.1f} km away", most / 1000);
  return fmt::format("{:.1f} to {:.1f} km away", least / 1000, most / 1000);
}

double report_height(const ingest::ReferenceWind& report) { return report.height ? report.height->m : 10; }

std::string expectation_sentence(const ReportScores& r) {
  double representativeness = 0, rise = 0;
  bool assumed = false, distance_known = true;
  for (const auto& pair : r.pairs) {
    representativeness = std::max(representativeness, pair.representativeness_m_s);
    const double d = pair.height.m - report_height(pair.report);
    if (std::abs(d) > std::abs(rise)) rise = d;
    assumed = assumed || !pair.report.height;
    distance_known = distance_known && pair.distance_m.has_value();
  }
  auto text = std::abs(rise) < 0.5 ? std::string("Ours is at the reference's height")
                                   : fmt::format("Ours is {:.0f} m {} the reference's height", std::abs(rise),
                                                 rise < 0 ? "below" : "above");
  text += assumed ? " (10 m, since it names none); " : "; ";
  text +=
      fmt::format("{} {} alone make{} {:.1f} m/s per component", distance_known ? "distance and" : "the difference in",
                  "time", distance_known ? "" : "s", representativeness);
  if (r.scores.normalised_error)
    text += fmt::format("; with that, ours and the rounding, squared errors are {:.2g} times what is to be expected",
                        *r.scores.normalised_error);
  return text + ".";
}

std::vector<std::string> report_sentences(const ReportScores& r, const profiles::CompareSettings& settings) {
  if (r.pairs.empty()) return {};
  std::vector<std::string> all{matching_sentence(r, settings.match_window_s),
                               score_sentence(r.scores, settings.direction_above_m_s), expectation_sentence(r)};
  double gust = 0;
  for (const auto& pair : r.pairs) gust = std::max(gust, pair.report.gust.value_or(0));
  if (gust > 0) all.push_back(fmt::format("Gusts up to {:.1f} m/s were reported; they are not scored.", gust));
  if (distance_words(r) == "distance unknown")
    all.push_back("The reference names no place; --reference-at LAT,LON,HEIGHT_M gives it one.");
  return all;
}

std::string name_of(const ReferenceComparison& reference) {
  std::vector<std::string> facts{reference.kind};
  if (!reference.stations.empty()) facts.back() += fmt::format(" {}", fmt::join(reference.stations, ", "));
  if (const auto* reports = reference.reports(); reports && !reports->pairs.empty())
    facts.push_back(distance_words(*reports));
  return fmt::format("{} ({})", reference.file, fmt::join(facts, ", "));
}

std::string from_text(const std::optional<double>& from) {
  if (!from) return "-";
  const auto whole = std::lround(*from);
  return std::to_string(whole <= 0 ? 360 : whole);
}

std::string report_row(const MatchedReport& m) {
  const auto& r = m.report;
  const auto speed = *r.speed_min < *r.speed_max ? fmt::format("{:.1f}-{:.1f}", *r.speed_min, *r.speed_max)
                                                 : fmt::format("{:.1f}", *r.speed_min);
  const auto from = r.calm ? "calm" : r.from_deg ? from_text(r.from_deg) : "var";
  const auto ours = estimator::to_report(m.wind);
  std::string turn = "-";
  if (r.from_deg && ours.from_deg) turn = fmt::format("{:+.0f}", profiles::turn_between(*r.from_deg, *ours.from_deg));
  return fmt::format("{:<16} {:>9} {:>5} {:>5}   {:>4.0f} {:>5} {:>6.1f} {:>5}   {:>6} {:>5}\n",
                     minute_text(r.utc).substr(0, 16), speed, from, r.gust ? fmt::format("{:.1f}", *r.gust) : "-",
                     m.height.m, ingest::to_iso8601(m.utc, 0).substr(11, 5), ours.speed_m_s, from_text(ours.from_deg),
                     fmt::format("{:+.1f}", profiles::speed_error(m.pair)), turn);
}

std::string report_table(const ReportScores& r) {
  constexpr std::size_t most = 12;
  if (r.pairs.empty()) return "";
  auto text = fmt::format("{:<16} {:>9} {:>5} {:>5}   {:>4} {:>5} {:>6} {:>5}   {:>6} {:>5}\n", "report, UTC", "wind",
                          "from", "gust", "ours", "UTC", "wind", "from", "error", "turn");
  text += fmt::format("{:<16} {:>9} {:>5} {:>5}   {:>4} {:>5} {:>6} {:>5}   {:>6} {:>5}\n", "", "m/s", "deg", "m/s",
                      "m", "", "m/s", "deg", "m/s", "deg");
  for (std::size_t i = 0; i < std::min(most, r.pairs.size()); ++i) text += report_row(r.pairs[i]);
  if (r.pairs.size() > most) text += fmt::format("and {} more\n", r.pairs.size() - most);
  return text;
}

Json error_json(const ErrorStatistics& s, int digits) {
  if (!s.n) return nullptr;
  return {{"n", s.n},
          {"bias", json_number(s.bias, digits)},
          {"bias_half_95", json_number(s.bias_half95, digits)},
          {"sd", json_number(s.sd, digits)},
          {"rmse", json_number(s.rmse, digits)},
          {"effective_samples", json_number(s.effective_samples, 2)}};
}

Json scores_json(const Scores& s) {
  Json object = {{"n", s.n}};
  if (!s.n) return object;
  object["wind_east_m_s"] = error_json(s.east, 4);
  object["wind_north_m_s"] = error_json(s.north, 4);
  object["wind_speed_m_s"] = error_json(s.speed, 4);
  object["rmsve_m_s"] = s.east.n ? json_number(s.rmsve, 4) : Json();
  object["wind_from_deg"] = error_json(s.direction, 2);
  object["below_direction_threshold"] = s.n_slow;
  object["without_direction"] = s.n_no_direction;
  object["speed_ranges"] = s.n_range;
  object["inside_speed_range"] = s.n_in_range;
  object["inside68"] = json_number(s.inside68, 4);
  object["inside95"] = json_number(s.inside95, 4);
  object["normalised_error"] = json_number(s.normalised_error, 4);
  return object;
}

Json layer_json(const profiles::ScoredBin& b) {
  return {{"bottom_m", json_number(b.bottom, 2)},
          {"top_m", json_number(b.top, 2)},
          {"samples", b.samples},
          {"wind_east_m_s", json_number(b.ours.y(), 4)},
          {"wind_north_m_s", json_number(b.ours.x(), 4)},
          {"reference_east_m_s", json_number(b.reference.y(), 4)},
          {"reference_north_m_s", json_number(b.reference.x(), 4)},
          {"mean_inside95", b.inside95},
          {"scores", scores_json(b.scores)}};
}

void add_truth(Json& object, const TruthScores& truth) {
  object["matched_by"] = truth.by_height ? "height" : "time";
  object["scores"] = scores_json(truth.whole());
  if (truth.classic) object["classic_after_60_s"] = scores_json(*truth.classic);
  Json legs = Json::array();
  for (const auto& leg : truth.legs) {
    Json layers = Json::array();
    for (const auto& bin : leg.bins) layers.push_back(layer_json(bin));
    legs.push_back(
        {{"leg", std::string(profiles::name(leg.name))}, {"scores", scores_json(leg.scores)}, {"layers", layers}});
  }
  object["legs"] = std::move(legs);
}

Json known(const std::optional<double>& value, int digits) { return value ? json_number(value, digits) : Json(); }

Json pair_json(const MatchedReport& m) {
  const auto& r = m.report;
  const auto ours = estimator::to_report(m.wind);
  Json object = {{"report_utc", utc_text(r.utc)}, {"station", r.station.empty() ? Json() : Json(r.station)}};
  object["report_speed_min_m_s"] = json_number(r.speed_min, 4);
  object["report_speed_max_m_s"] = json_number(r.speed_max, 4);
  object["report_from_deg"] = known(r.from_deg, 2);
  object["report_calm"] = r.calm;
  object["report_gust_m_s"] = known(r.gust, 4);
  object["report_sector_deg"] =
      r.sector_deg ? Json({json_number(r.sector_deg->first, 0), json_number(r.sector_deg->second, 0)}) : Json();
  object["report_height_agl_m"] = r.height ? json_number(r.height->m, 2) : Json();
  object["utc"] = utc_text(m.utc);
  object["height_agl_m"] = json_number(m.height.m, 2);
  object["samples"] = m.samples;
  object["wind_east_m_s"] = json_number(m.wind.v_NA_N.y(), 4);
  object["wind_north_m_s"] = json_number(m.wind.v_NA_N.x(), 4);
  object["wind_speed_m_s"] = json_number(ours.speed_m_s, 4);
  object["wind_from_deg"] = known(ours.from_deg, 2);
  object["speed_error_m_s"] = json_number(profiles::speed_error(m.pair), 4);
  object["gap_s"] = json_number(m.gap_s, 1);
  object["height_difference_m"] = json_number(m.height.m - report_height(r), 2);
  object["distance_m"] = known(m.distance_m, 0);
  object["sd_speed_rounding_m_s"] = json_number(r.speed_sd, 4);
  object["sd_from_rounding_deg"] = json_number(r.from_sd_deg, 2);
  object["sd_representativeness_m_s"] = json_number(m.representativeness_m_s, 4);
  const auto& C = m.pair.covariance;
  object["expected_sd_error_east_m_s"] = C ? json_number(std::sqrt((*C)(1, 1)), 4) : Json();
  object["expected_sd_error_north_m_s"] = C ? json_number(std::sqrt((*C)(0, 0)), 4) : Json();
  return object;
}

void add_reports(Json& object, const ReportScores& reports) {
  object["matched_by"] = "utc";
  object["records"] = reports.records;
  object["nearest_gap_s"] = known(reports.nearest_gap_s, 1);
  object["nearest_distance_m"] = known(reports.nearest_distance_m, 0);
  object["nearest_stands_in"] = reports.outside_window;
  object["no_score"] = reports.no_score ? json_problem(*reports.no_score) : Json();
  object["scores"] = scores_json(reports.scores);
  Json layers = Json::array();
  for (const auto& layer : reports.layers)
    layers.push_back({{"bottom_m", json_number(layer.bottom, 2)},
                      {"top_m", json_number(layer.top, 2)},
                      {"scores", scores_json(layer.scores)}});
  object["layers"] = std::move(layers);
  Json pairs = Json::array();
  for (const auto& pair : reports.pairs) pairs.push_back(pair_json(pair));
  object["pairs"] = std::move(pairs);
}

Json settings_json(const ReferenceSettings& s) {
  Json object = {{"match_window_s", json_number(s.match.match_window_s, 1)},
                 {"direction_above_m_s", json_number(s.match.direction_above_m_s, 2)}};
  object["representativeness_m_s"] = known(s.match.representativeness_m_s, 3);
  object["reference_at"] = s.reference_at.empty() ? Json() : Json(s.reference_at);
  return object;
}

}  // namespace

std::vector<std::string> comparison_sentences(const ReferenceComparison& reference,
                                              const profiles::CompareSettings& settings) {
  auto all = reference.truth() ? truth_sentences(*reference.truth()) : report_sentences(*reference.reports(), settings);
  if (const auto* reports = reference.reports(); reports && reports->no_score)
    all.push_back("Nothing could be compared: " + reports->no_score->what + ".");
  return all;
}

std::vector<std::string> comparison_sentences(const Comparison& comparison) {
  std::vector<std::string> all;
  for (const auto& reference : comparison.references)
    all.push_back(fmt::format("{}: {}", name_of(reference),
                              fmt::join(comparison_sentences(reference, comparison.settings.match), " ")));
  return all;
}

std::string comparison_text(const Comparison& comparison) {
  std::string text;
  for (const auto& reference : comparison.references) {
    text += (text.empty() ? "" : "\n") + wrapped("Against " + name_of(reference) + ":") + "\n";
    if (const auto* reports = reference.reports()) text += report_table(*reports);
    for (const auto& sentence : comparison_sentences(reference, comparison.settings.match))
      text += wrapped("- " + sentence, 79, 2) + "\n";
  }
  return text;
}

std::string comparison_json(const Comparison& comparison, const std::string& file, int flight) {
  Json object = {{"schema", "quadsonde.compare/1"}, {"version", std::string(version())}};
  object["source"] = {{"file", file}, {"flight", flight}};
  object["settings"] = settings_json(comparison.settings);
  Json references = Json::array();
  for (const auto& reference : comparison.references) {
    Json one = {{"file", reference.file}, {"kind", reference.kind}, {"stations", reference.stations}};
    if (const auto* truth = reference.truth())
      add_truth(one, *truth);
    else
      add_reports(one, *reference.reports());
    one["problems"] = json_problems(reference.problems);
    references.push_back(std::move(one));
  }
  object["references"] = std::move(references);
  return json_text(object);
}

}  // namespace quadsonde::product

#include "export/report/report.h"

#include <fmt/format.h>

#include <cmath>

#include "export/csv/numbers.h"
#include "export/report/level_words.h"
#include "export/report/plot.h"
#include "export/report/state_picture.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

using estimator::WindEstimate;

constexpr const char* style = R"(
body{font:15px/1.5 "DejaVu Sans",Verdana,"Segoe UI",Helvetica,Arial,sans-serif;color:#1a1a1a;background:#fff;
max-width:940px;margin:2em auto;padding:0 1em}
h1{font-size:1.5em;margin:0 0 .2em}
h2{font-size:1.15em;margin:1.8em 0 .5em;border-bottom:1px solid #dfe3e8;padding-bottom:.2em}
p.lead{font-size:1.1em}p.facts{color:#5f6770;margin-top:0}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.2em .8em;text-align:right;border-bottom:1px solid #eceff2}
th{color:#5f6770;font-weight:normal}td.word,th.word{text-align:left}
tr.doubtful td,tr.none td{color:#8a5a00}tr.bad td{color:#a1260d}
svg{max-width:100%;height:auto}
dt{color:#5f6770;float:left;clear:left;width:13em}dd{margin-left:13.5em;word-break:break-word}
)";

void paragraph(Markup& html, const std::string& text) { html.leaf("p", text); }

void list(Markup& html, const std::vector<std::string>& sentences) {
  if (sentences.empty()) return;
  const auto ul = html.element("ul");
  for (const auto& sentence : sentences) html.leaf("li", sentence);
}

const profiles::Bin* highest_with_wind(const profiles::Leg& leg) {
  const profiles::Bin* found = nullptr;
  for (const auto& bin : leg.bins)
    if (std::holds_alternative<WindEstimate>(bin.wind)) found = &bin;
  return found;
}

const profiles::Bin* lowest_with_wind(const profiles::Leg& leg) {
  for (const auto& bin : leg.bins)
    if (std::holds_alternative<WindEstimate>(bin.wind)) return &bin;
  return nullptr;
}

std::string lead_sentence(const Report& report) {
  const auto* leg = report.profile ? main_leg(*report.profile) : nullptr;
  const auto* low = leg ? lowest_with_wind(*leg) : nullptr;
  const auto* high = leg ? highest_with_wind(*leg) : nullptr;
  if (!low) return "No height of this flight has a wind; the reasons stand below.";
  const char* datum = report.profile->datum == profiles::Datum::agl ? "above take-off" : "above mean sea level";
  const auto say = [&](const profiles::Bin& bin) {
    const auto& wind = std::get<WindEstimate>(bin.wind);
    return fmt::format("{} at {:.0f} m", wind_words(wind), middle(bin));
  };
  auto text = "The wind was " + say(*low);
  if (high != low) text += " and " + say(*high);
  return text + " " + datum + ".";
}

std::string sureness_sentence(const Report& report) {
  const auto* leg = report.profile ? main_leg(*report.profile) : nullptr;
  if (!leg) return "";
  std::size_t with_wind = 0, good = 0;
  double widest = 0;
  for (const auto& bin : leg->bins)
    if (const auto* wind = std::get_if<WindEstimate>(&bin.wind)) {
      ++with_wind;
      good += bin.quality == estimator::Quality::good;
      if (wind->has_covariance) widest = std::max(widest, 1.96 * estimator::speed_sd(*wind));
    }
  if (!with_wind) return "";
  return fmt::format(
      "{} of {} heights have a wind, {} of them rated good; at 95 % the speeds are known to {:.1f} m/s or better.",
      with_wind, leg->bins.size(), good, widest);
}

void wind_table(Markup& html, const profiles::WindProfile& profile) {
  const auto* leg = main_leg(profile);
  if (!leg) return;
  const auto table = html.element("table");
  {
    const auto row = html.element("tr");
    for (const char* head : {"height, m", "speed, m/s", "95 %", "from, deg", "95 %", "turbulence, m/s", "samples"})
      html.leaf("th", head);
    html.leaf("th", "quality", {{"class", "word"}});
  }
  for (std::size_t i = leg->bins.size(); i-- > 0;) {
    const auto& bin = leg->bins[i];
    const auto row = html.element("tr", {{"class", std::string(estimator::name(bin.quality))}});
    html.leaf("td", fmt::format("{:.0f} to {:.0f}", bin.bottom, bin.top));
    const auto* wind = std::get_if<WindEstimate>(&bin.wind);
    const auto report = wind ? estimator::to_report(*wind) : estimator::WindReport{};
    const bool known = wind && wind->has_covariance;
    const auto sd_from = known ? estimator::direction_sd_deg(*wind) : std::nullopt;
    html.leaf("td", wind ? fixed(report.speed_m_s, 2) : "");
    html.leaf("td", known ? "\u00b1" + fixed(1.96 * estimator::speed_sd(*wind), 2) : "");
    html.leaf("td", wind ? fixed(report.from_deg, 0) : "");
    html.leaf("td", sd_from ? "\u00b1" + fixed(1.96 * *sd_from, 0) : "");
    html.leaf("td", bin.sigma ? fixed(std::sqrt(bin.sigma->squaredNorm() / 2), 2) : "");
    html.leaf("td", std::to_string(bin.samples));
    html.leaf("td", std::string(estimator::name(bin.quality)), {{"class", "word"}});
  }
}

std::vector<std::string> reason_sentences(const profiles::WindProfile& profile) {
  std::vector<std::string> all;
  const auto* leg = main_leg(profile);
  if (!leg) return all;
  for (const auto& [reason, rows] : count_reasons(*leg))
    all.push_back(fmt::format("{} ({} of {} bins).", estimator::sentence(reason), rows, leg->bins.size()));
  if (profile.up_down)
    all.push_back(fmt::format(
        "Ascent against descent at equal heights: chi-square {:.1f} for {} degrees of freedom, p = {:.3f}{}.",
        profile.up_down->chi2, profile.up_down->degrees_of_freedom, profile.up_down->p_value,
        profile.up_down->p_value < 0.01 ? "; they contradict each other" : "; they agree"));
  return all;
}

std::vector<std::string> diagnostic_sentences(const estimator::FlightDiagnostics& d) {
  std::vector<std::string> all;
  all.push_back(
      d.trim_estimated
          ? fmt::format(
                "The nose turned enough (heading index {:.2f}) to measure the tilt trim: roll {:.2f} \u00b1 {:.2f}, "
                "pitch {:.2f} \u00b1 {:.2f} degrees.",
                d.heading_index, d.trim_deg.x(), d.trim_sd_deg.x(), d.trim_deg.y(), d.trim_sd_deg.y())
          : fmt::format(
                "The nose hardly turned (heading index {:.2f}): the tilt trim is assumed, not measured, and the "
                "intervals contain that.",
                d.heading_index));
  all.push_back(fmt::format("Turbulence of the flight: {:.2f} m/s per axis.", d.sigma_u));
  all.push_back(
      fmt::format("Largest tilt {:.0f} degrees, largest airspeed {:.1f} m/s.", d.max_tilt_deg, d.max_airspeed));
  all.push_back(fmt::format("Air density {:.3f} kg/m3 {}.", d.air_density,
                            d.standard_density ? "from the standard atmosphere" : "from the log"));
  all.push_back(fmt::format(
      "Mean normalised innovation {:.2f} (2 when the noise is as assumed), {} samples rejected, {} jumps, {} restarts.",
      d.nis_mean, d.rejected, d.jumps, d.restarts));
  if (d.jump_test_off) all.push_back("Too many jumps for wind: the jump test was switched off for this flight.");
  for (const auto& check : d.self_checks)
    if (!check.sentence.empty() && (!check.passed || check.name != "nis_mean"))  // that one is said above already
      all.push_back(check.sentence + (check.judged && !check.passed ? ": too much, so every value is doubtful." : "."));
  if (d.climb_estimated)
    all.push_back(fmt::format("Ascent and descent together fix the climb law: {:.3f} \u00b1 {:.3f} s/m.",
                              d.climb_linear, d.climb_linear_sd));
  for (const auto& sentence : {learned_sentence(d), vertical_sentence(d)})
    if (!sentence.empty()) all.push_back(sentence);
  return all;
}

void provenance(Markup& html, const Report& report) {
  const auto& source = report.source;
  const auto& v = source.vehicle;
  const auto dl = html.element("dl");
  const auto entry = [&](const char* name, const std::string& text, const char* tag = "dd") {
    html.leaf("dt", name);
    html.leaf(tag, text);
  };
  entry("Input", source.file);
  entry("SHA-256", source.sha256);
  entry("Flight", fmt::format("{} of {}", report.title.flight, report.title.flights));
  entry("Made by", fmt::format("quadsonde {}", version()));
  entry("Drag",
        fmt::format("{} ({}): linear {:.4f} \u00b1 {:.4f} 1/s, quadratic {:.4f} \u00b1 {:.4f} 1/m, latency {:.3f} s",
                    v.id, v.method, v.drag.linear, v.parameter_sd(ingest::p_linear), v.drag.quadratic,
                    v.parameter_sd(ingest::p_quadratic), v.latency_s));
  std::string settings;
  for (const auto& [name, value] : source.settings) {
    std::string text = "chosen by the flight";
    if (const auto* b = std::get_if<bool>(&value)) text = *b ? "true" : "false";
    if (const auto* d = std::get_if<double>(&value)) text = fmt::format("{}", *d);
    if (const auto* s = std::get_if<std::string>(&value)) text = *s;
    settings += (settings.empty() ? "" : ", ") + name + " = " + text;
  }
  entry("Settings", settings);
}

void answer_section(Markup& html, const Report& report) {
  html.leaf("h1", "Wind profile of " + title_text(report.title));
  html.leaf("p", when_and_where(report.title) + (report.title.vehicle.empty() ? "" : ", " + report.title.vehicle),
            {{"class", "facts"}});
  html.leaf("p", lead_sentence(report), {{"class", "lead"}});
  const auto sure = sureness_sentence(report);
  if (!sure.empty()) paragraph(html, sure);
  paragraph(html, vehicle_sentence(report.source.vehicle));
  if (report.profile) wind_table(html, *report.profile);
}

void body(Markup& html, const Report& report) {
  answer_section(html, report);
  if (report.profile) {
    html.leaf("h2", "Profile");
    html.trusted(profile_svg(*report.profile, {report.title, "", report.reference, "true wind", "profile", report.marks}));
    for (const auto& note : note_sentences(*report.profile)) paragraph(html, note);
  }
  if (report.section) {
    html.leaf("h2", "Over time and height");
    html.trusted(section_svg(*report.section, {report.title, "section"}));
  }
  if (report.profile) {
    const auto levels = level_sentences(*report.profile);
    if (!levels.empty()) html.leaf("h2", "Levels, shear and laws");
    list(html, levels);
  }
  if (!report.comparison.empty()) {
    html.leaf("h2", "Against the reference");
    list(html, report.comparison);
  }
  // Flights that were merged have no wind along a flight.
  if (!report.series->points.empty()) {
    html.leaf("h2", "Along the flight");
    html.trusted(series_svg(*report.series, {report.title, report.classic, "series", report.along, "true wind"}));
    html.trusted(
        state_svg(*report.series, {report.title, report.classic, report.velocity, report.along, "true wind", "state"}));
    html.leaf("h2", "What the flight says about itself");
    list(html, diagnostic_sentences(report.series->diagnostics));
  }
  if (report.profile && !report.profile->found.empty()) {
    std::string legs;
    for (const auto& leg : leg_sentences(*report.profile)) legs += (legs.empty() ? "" : "; ") + leg;
    paragraph(html, "The flight: " + legs + ".");
  }
  if (report.autopilot) paragraph(html, autopilot_sentence(*report.autopilot));
  if (report.profile) {
    const auto reasons = reason_sentences(*report.profile);
    if (!reasons.empty()) html.leaf("h2", "What the quality rests on");
    list(html, reasons);
  }
  const auto better = advice(report.series->diagnostics, report.source.vehicle, reasons_of(*report.series));
  if (!better.empty()) html.leaf("h2", "What would make it better");
  list(html, better);
  if (!report.source.problems.empty()) {
    html.leaf("h2", "Problems met");
    std::vector<std::string> problems;
    for (const auto& problem : report.source.problems) problems.push_back(problem_sentence(problem));
    list(html, problems);
  }
  html.leaf("h2", "Where it comes from");
  provenance(html, report);
}

}  // namespace

std::string report_html(const Report& report) {
  Markup html;
  html.trusted("<!DOCTYPE html>\n");
  {
    const auto root = html.element("html", {{"lang", "en"}});
    {
      const auto head = html.element("head");
      html.empty("meta", {{"charset", "utf-8"}});
      html.empty("meta", {{"http-equiv", "Content-Security-Policy"},
                          {"content", "default-src 'none'; style-src 'unsafe-inline'"}});
      html.empty("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}});
      html.leaf("title", "Wind profile of " + title_text(report.title));
      const auto css = html.element("style");
      html.trusted(style);
    }
    const auto page = html.element("body");
    body(html, report);
  }
  return html.str();
}

}  // namespace quadsonde::product

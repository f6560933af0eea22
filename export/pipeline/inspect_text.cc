#include <fmt/format.h>

#include <cmath>

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/pipeline/inspect.h"
#include "export/report/text_answer.h"
#include "export/version.h"

namespace quadsonde::product {
namespace {

std::string line(const char* name, const std::string& text) {
  return wrapped(fmt::format("  {:<16}  {}", name, text), 79, 20) + "\n";
}

std::string vehicle_text(const BootFacts& boot) {
  std::string text = boot.vehicle;
  const auto append = [&](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  };
  append(boot.airframe);
  append(boot.rotors ? fmt::format("{} rotors", boot.rotors) : "");
  append(boot.autopilot + (boot.firmware.empty() || boot.autopilot.empty() ? "" : " ") + boot.firmware);
  append(boot.simulated ? "simulated: no air moved" : "");
  return text.empty() ? "not told by the log" : text;
}

std::string clock_text(const BootFacts& boot) {
  if (!boot.utc_uncertainty_s) return "UTC is not known; times are the log's own";
  return fmt::format("UTC known to {:.3g} s{}", *boot.utc_uncertainty_s,
                     boot.clock_source.empty() ? "" : " (" + boot.clock_source + ")");
}

/// "0.012" s; ">0.012" where only a part of it shows in the log.
std::string latency_text(const std::optional<ingest::Latency>& latency) {
  return latency ? fmt::format("{}{:.3f}", latency->at_least ? ">" : "", latency->median_s) : "-";
}

std::string streams_text(const std::vector<StreamFacts>& streams) {
  const auto row = [](const auto&... columns) {
    return fmt::format("  {:<18}{:<24}{:>8}{:>7}{:>7}{:>7}{:>7}\n", columns...);
  };
  const auto number = [](const std::optional<double>& value, int digits) {
    return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
  };
  auto text =
      row("stream", "in the log as", "samples", "rate", "jitter", "gap", "late") + row("", "", "", "Hz", "s", "s", "s");
  bool partly = false;
  for (const auto& s : streams) {
    text += row(s.name, s.source.size() > 23 ? s.source.substr(0, 20) + "..." : s.source, s.samples,
                number(s.rate_hz, 1), number(s.jitter_s, 3), number(s.longest_gap_s, 2), latency_text(s.latency));
    partly = partly || (s.latency && s.latency->at_least);
  }
  text += wrapped(fmt::format("  jitter: of the intervals; gap: the longest; late: from the measurement to the log's "
                              "stamp{}.",
                              partly ? ", > where only a part of it shows" : ""),
                  79, 2) +
          "\n";
  return text;
}

std::string autopilot_wind_text(const Eigen::Vector2d& v_NA_N) {
  return wind_words({v_NA_N, Eigen::Matrix2d::Zero(), false}) + " on average; kept beside ours";
}

std::string height_text(const Manoeuvre& m) {
  if (!m.lowest) return "no height in the log";
  return fmt::format("{} to {} m {}", std::lround(*m.lowest), std::lround(*m.highest),
                     m.above_takeoff ? "above take-off" : "above sea level (take-off not known)");
}

std::string flight_text(const FlightFacts& f) {
  const auto& m = f.manoeuvre;
  auto text = wrapped(fmt::format("Flight {}: {}", f.title.flight, when_and_where(f.title)), 79, 2) + "\n";
  text +=
      line("height", height_text(m) + fmt::format(", {} ascent{}, {} descent{}", m.ascents, m.ascents == 1 ? "" : "s",
                                                  m.descents, m.descents == 1 ? "" : "s"));
  text += line("motion", fmt::format("up to {:.1f} m/s over ground, excitation {:.2f} m/s", m.max_speed, m.excitation));
  text += line("heading", fmt::format("turned {:.0f} deg in all, heading index {:.2f}", m.turned_deg, m.heading_index));
  if (f.starts_in_air || f.ends_in_air)
    text +=
        line("log", fmt::format("{}{}{}", f.starts_in_air ? "begins in the air" : "",
                                f.starts_in_air && f.ends_in_air ? ", " : "", f.ends_in_air ? "ends in the air" : ""));
  const auto& o = f.observable;
  text += line("wind", wind_sentence(o)) + line("tilt trim", trim_sentence(o)) + line("drag", drag_sentence(o, m)) +
          line("latency", latency_sentence(o, m));
  text += line("profile", f.profile_possible ? "yes" : "no: the flight stays within one height");
  if (!f.advice.empty()) text += "  What would help next time:\n";
  for (const auto& sentence : f.advice) text += wrapped("  - " + sentence, 79, 4) + "\n";
  return text;
}

std::string topics_text(const std::vector<ingest::TopicCount>& topics) {
  std::string text = fmt::format("  {:<60}{:>10}\n", "topic", "messages");
  for (const auto& topic : topics) text += fmt::format("  {:<60}{:>10}\n", topic.name, topic.messages);
  return text;
}

Json nullable(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json boot_json(const BootFacts& b) {
  Json streams = Json::array();
  for (const auto& s : b.streams)
    streams.push_back({{"name", s.name},
                       {"source", s.source},
                       {"samples", s.samples},
                       {"rate_hz", json_number(s.rate_hz, 3)},
                       {"longest_gap_s", json_number(s.longest_gap_s, 3)},
                       {"gaps", s.gaps},
                       {"jitter_s", json_number(s.jitter_s, 6)},
                       {"latency_s", s.latency ? json_number(s.latency->median_s, 6) : Json()},
                       {"latency_is_lower_bound", s.latency ? Json(s.latency->at_least) : Json()}});
  return {{"vehicle", nullable(b.vehicle)},
          {"autopilot", nullable(b.autopilot)},
          {"firmware", nullable(b.firmware)},
          {"airframe", nullable(b.airframe)},
          {"rotors", b.rotors ? Json(b.rotors) : Json()},
          {"simulated", b.simulated},
          {"utc_known", b.utc_uncertainty_s.has_value()},
          {"utc_uncertainty_s", json_number(b.utc_uncertainty_s, 6)},
          {"clock_source", nullable(b.clock_source)},
          {"streams", streams},
          {"autopilot_wind_east_m_s", b.autopilot_wind ? json_number(b.autopilot_wind->y(), 3) : Json()},
          {"autopilot_wind_north_m_s", b.autopilot_wind ? json_number(b.autopilot_wind->x(), 3) : Json()},
          {"lacking", b.lacking ? json_problem(*b.lacking) : Json()}};
}

Json flight_json(const FlightFacts& f) {
  const auto& m = f.manoeuvre;
  return {{"flight", f.title.flight},
          {"start_utc", nullable(utc_text(f.title.start))},
          {"duration_s", json_number(f.title.duration_s, 3)},
          {"lat_deg", f.title.place ? json_number(f.title.place->lat_deg, 7) : Json()},
          {"lon_deg", f.title.place ? json_number(f.title.place->lon_deg, 7) : Json()},
          {"starts_in_air", f.starts_in_air},
          {"ends_in_air", f.ends_in_air},
          {"lowest_m", json_number(m.lowest, 2)},
          {"highest_m", json_number(m.highest, 2)},
          {"heights_above_takeoff", m.above_takeoff},
          {"ascents", m.ascents},
          {"descents", m.descents},
          {"max_ground_speed_m_s", json_number(m.max_speed, 2)},
          {"heading_index", json_number(m.heading_index, 4)},
          {"turned_deg", json_number(m.turned_deg, 0)},
          {"excitation_m_s", json_number(m.excitation, 4)},
          {"turning_motion_m_s", json_number(m.turning_motion, 4)},
          {"reversals", m.reversals},
          {"observable",
           {{"wind", name(f.observable.wind)},
            {"tilt_trim", f.observable.trim},
            {"drag", name(f.observable.drag)},
            {"latency", f.observable.latency}}},
          {"can_give_wind", true},
          {"can_measure_trim", f.trim_can_be_measured},
          {"can_give_profile", f.profile_possible},
          {"can_calibrate", f.can_calibrate},
          {"advice", f.advice}};
}

}  // namespace

std::string info_text(const LogFacts& facts) {
  auto text = wrapped(fmt::format("{}: {}", facts.file, facts.format)) + "\n";
  text += line("messages", fmt::format("{} in {} topic{}", facts.messages, facts.topics.size(),
                                       facts.topics.size() == 1 ? "" : "s"));
  if (facts.salvaged) text += line("salvaged", fmt::format("{} of them, behind lost structure", facts.salvaged));
  for (const auto& [name, value] : facts.details)
    if (value.find('\n') == std::string::npos) text += line(name.c_str(), value);
  for (std::size_t i = 0; i < facts.boots.size(); ++i) {
    const auto& boot = facts.boots[i];
    text += facts.boots.size() > 1 ? fmt::format("\nBoot {} of the autopilot\n", i + 1) : "\n";
    text += line("vehicle", vehicle_text(boot)) + line("clock", clock_text(boot)) + streams_text(boot.streams);
    if (boot.autopilot_wind) text += line("autopilot's wind", autopilot_wind_text(*boot.autopilot_wind));
    if (boot.lacking) text += line("no wind", problem_sentence(*boot.lacking));
  }
  for (const auto& flight : facts.flights) text += "\n" + flight_text(flight);
  if (facts.flights.empty() && facts.nothing) {
    text += "\n" + wrapped("No wind from this log: " + problem_sentence(*facts.nothing)) + "\n";
    if (facts.boots.empty() && !facts.topics.empty()) text += "\n" + topics_text(facts.topics);
  }
  for (const auto& [name, value] : facts.details)
    if (name == "map_toml")
      text += "\nThe map of this table; save it, change it, give it with --columns MAP.toml:\n\n" + value;
  return text;
}

std::string info_json(const LogFacts& facts) {
  Json object = {{"schema", "quadsonde.info/1"}, {"version", std::string(version())},
                 {"file", facts.file},           {"sha256", facts.sha256},
                 {"format", facts.format},       {"messages", facts.messages},
                 {"salvaged", facts.salvaged}};
  Json details = Json::object();
  for (const auto& [name, value] : facts.details) details[name] = value;
  object["details"] = details;
  Json topics = Json::array();
  for (const auto& topic : facts.topics) topics.push_back({{"name", topic.name}, {"messages", topic.messages}});
  object["topics"] = topics;
  Json boots = Json::array(), flights = Json::array();
  for (const auto& boot : facts.boots) boots.push_back(boot_json(boot));
  for (const auto& flight : facts.flights) flights.push_back(flight_json(flight));
  object["boots"] = boots;
  object["flights"] = flights;
  object["can_give_wind"] = !facts.flights.empty();
  object["why_not"] = facts.nothing ? json_problem(*facts.nothing) : Json();
  object["problems"] = json_problems(facts.problems);
  return json_text(object);
}

}  // namespace quadsonde::product

// The user's map, rule by rule.
#include <cmath>

#include "ingest/flight/rotation.h"
#include "ingest/mcap/foreign_rules.h"

namespace quadsonde::ingest::foreign {
namespace {

using Values = std::vector<double>;

/// The fields of a rule, scaled; nothing if one is not there.
std::optional<Values> values_of(const Json& message, const TopicRule& rule) {
  Values values;
  for (const auto& field : rule.fields) {
    const auto number = number_at(message, field);
    if (!number) return std::nullopt;
    values.push_back(*number * rule.scale + rule.offset);
  }
  return values;
}

std::optional<LogTime> time_of(LogTime log_time, const Json& message, const TopicRule& rule) {
  if (rule.time.empty()) return log_time;
  const auto number = number_at(message, rule.time);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return LogTime{seconds(*number * rule.time_scale).count()};
}

Axes axes_of(const std::string& word) {
  return word == "enu" ? Axes::enu : word == "flu" ? Axes::flu : word == "frd" ? Axes::frd : Axes::ned;
}

using Taker = void (*)(LogTime, const Values&, const TopicRule&, Flight&);

void take_attitude(LogTime t, const Values& v, const TopicRule& rule, Flight& f) {
  const auto q = v.size() == 4 ? Eigen::Quaterniond(v[0], v[1], v[2], v[3]) : q_NB_from_euler({v[0], v[1], v[2]});
  if (q.norm() > 0.5) f.attitude.push(t, rule.axes == "enu_flu" ? q_NB_from_enu_flu(q) : q);
}

void take_velocity(LogTime t, const Values& v, const TopicRule& rule, Flight& f) {
  auto velocity = to_ours(axes_of(rule.axes), {v[0], v[1], v[2]});
  if (rule.axes == "frd" || rule.axes == "flu") {
    // Body axes need the attitude of the same message, which was taken just before.
    if (f.attitude.empty() || f.attitude.time.back() != t) return;
    velocity = f.attitude.value.back().normalized() * velocity;
  }
  f.velocity.origin = VelocityOrigin::fused;
  f.velocity.push(t, velocity);
}

void take_wind(LogTime t, const Values& v, const TopicRule& rule, Flight& f) {
  f.autopilot_wind.push(t, {rule.axes == "enu" ? Eigen::Vector2d(v[1], v[0]) : Eigen::Vector2d(v[0], v[1]), {}});
}

const std::pair<const char*, Taker> kTakers[] = {
    {"attitude", take_attitude},  // before velocity
    {"velocity", take_velocity},
    {"wind", take_wind},
    {"position", [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.position.push(t, {v[0], v[1]}); }},
    {"local_position",
     [](LogTime t, const Values& v, const TopicRule& rule, Flight& f) {
       f.local_position.push(t, to_ours(axes_of(rule.axes), {v[0], v[1], v[2]}));
     }},
    {"accelerometer",
     [](LogTime t, const Values& v, const TopicRule& rule, Flight& f) {
       f.accelerometer.push(t, to_ours(axes_of(rule.axes), {v[0], v[1], v[2]}));
     }},
    {"height_msl", [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.height_msl.push(t, {v[0]}); }},
    {"height_ellipsoid",
     [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.height_ellipsoid.push(t, {v[0]}); }},
    {"height_ground", [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.height_ground.push(t, {v[0]}); }},
    {"pressure",
     [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.barometer.push(t, {v[0], std::nullopt}); }},
    {"baro_altitude",
     [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.barometer.push(t, {std::nullopt, v[0]}); }},
    {"temperature",
     [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.air.push(t, {v[0], std::nullopt, std::nullopt}); }},
    {"humidity",
     [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.air.push(t, {std::nullopt, v[0], std::nullopt}); }},
    {"landed", [](LogTime t, const Values& v, const TopicRule&, Flight& f) { f.landed.push(t, v[0] != 0); }},
    {"rotors", [](LogTime t, const Values& v, const TopicRule&, Flight& f) {
       f.rotors.push(t, RotorSpeeds(v.begin(), v.end()));
     }}};

}  // namespace

Rule rule_for_map(const std::string& topic, const TopicMap& map) {
  std::vector<std::pair<TopicRule, Taker>> steps;
  for (const auto& [stream, taker] : kTakers)
    if (const auto rule = map.rules.find(stream); rule != map.rules.end() && rule->second.topic == topic)
      steps.emplace_back(rule->second, taker);
  if (steps.empty()) return {};
  return [steps](LogTime log_time, const Json& message, Part& part) {
    for (const auto& [rule, taker] : steps) {
      const auto time = time_of(log_time, message, rule);
      const auto values = values_of(message, rule);
      if (time && values) taker(*time, *values, rule, part.flight);
    }
  };
}

}  // namespace quadsonde::ingest::foreign

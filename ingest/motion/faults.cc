#include "ingest/motion/faults.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace quadsonde::ingest {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double degree = std::numbers::pi / 180;

Matrix2d matrix(double a, double b, double c, double d) {
  Matrix2d m;
  m << a, b, c, d;
  return m;
}

Matrix2d turning(double angle) { return matrix(std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)); }

/// A fault of the tilt's own axes; all of these undo themselves or by their inverse.
FaultCandidate of_tilt(FaultClass fault, const char* id, const char* sentence, const Matrix2d& undo) {
  FaultCandidate c{fault, id, sentence, {}, {}};
  c.undo.tilt = undo;
  c.commit.tilt = undo.inverse();
  return c;
}

FaultCandidate of_velocity(const char* id, const char* sentence, const Matrix2d& undo) {
  FaultCandidate c{FaultClass::reflection, id, sentence, {}, {}};
  c.undo.velocity = undo;
  c.commit.velocity = undo.inverse();
  return c;
}

FaultCandidate of_heading(const char* id, const char* sentence, double offset) {
  FaultCandidate c{FaultClass::reflection, id, sentence, {}, {}};
  c.undo.heading_sign = c.commit.heading_sign = -1;
  c.undo.heading_offset = c.commit.heading_offset = offset;
  return c;
}

void add_yaw(std::vector<FaultCandidate>& all) {
  FaultCandidate velocity{FaultClass::yaw_not_applied,
                          "velocity-in-heading-axes",
                          "the velocity is in heading axes (forward, right), not north and east",
                          {},
                          {}};
  velocity.undo.axes = TelemetryMap::VelocityAxes::heading_to_earth;
  velocity.commit.axes = TelemetryMap::VelocityAxes::earth_to_heading;
  all.push_back(velocity);
  FaultCandidate tilt{FaultClass::yaw_not_applied,
                      "tilt-in-earth-axes",
                      "roll and pitch are already in north and east axes, and the heading turns them a second time",
                      {},
                      {}};
  tilt.undo.turn = TelemetryMap::Turn::never;
  tilt.commit.turn = TelemetryMap::Turn::twice;
  all.push_back(tilt);
}

struct Unit {
  double factor;
  const char* text;
};
constexpr std::array units{Unit{1.943844, "knots read as m/s"},
                           Unit{2.236936, "miles per hour read as m/s"},
                           Unit{3.28084, "feet per second read as m/s"},
                           Unit{3.6, "km/h read as m/s"},
                           Unit{100, "cm/s read as m/s"},
                           Unit{1000, "mm/s read as m/s"},
                           Unit{0.514444, "m/s taken for knots"},
                           Unit{0.44704, "m/s taken for miles per hour"},
                           Unit{0.3048, "m/s taken for feet per second"},
                           Unit{0.277778, "m/s taken for km/h"},
                           Unit{0.01, "m/s taken for cm/s"},
                           Unit{0.001, "m/s taken for mm/s"}};

const Unit* nearest_unit(double factor) {
  const Unit* best = nullptr;
  for (const auto& unit : units)
    if (std::abs(std::log(factor / unit.factor)) < 0.07 &&
        (!best || std::abs(std::log(factor / unit.factor)) < std::abs(std::log(factor / best->factor))))
      best = &unit;
  return best;
}

}  // namespace

std::string name(FaultClass fault) {
  switch (fault) {
    case FaultClass::rotation:
      return "rotation";
    case FaultClass::reflection:
      return "reflection";
    case FaultClass::velocity_scale:
      return "velocity scale";
    case FaultClass::tilt_scale:
      return "tilt scale";
    case FaultClass::yaw_not_applied:
      return "yaw not applied";
    case FaultClass::latency:
      return "latency";
    case FaultClass::tilt_offset:
      return "tilt offset";
    case FaultClass::attitude_unrelated:
      return "attitude unrelated to motion";
    case FaultClass::vertical_velocity:
      return "vertical velocity";
    case FaultClass::velocity_against_position:
      return "velocity against position";
    case FaultClass::frozen_stream:
      return "frozen stream";
    case FaultClass::zeros_before_fix:
      return "zeros before the first fix";
    case FaultClass::unexplained:
      break;
  }
  return "unexplained";
}

std::vector<std::string> usual_causes(FaultClass fault) {
  switch (fault) {
    case FaultClass::rotation:
      return {"180 degrees: signs of roll and pitch, or of both velocities, reversed",
              "90 degrees: body axes named otherwise",
              "small: declination missing or applied twice, compass or autopilot mounted askew"};
    case FaultClass::reflection:
      return {"east-north-up read as north-east-down", "two columns exchanged",
              "one axis or the sense of the heading reversed"};
    case FaultClass::velocity_scale:
      return {"knots, miles per hour, feet or centimetres per second read as m/s"};
    case FaultClass::tilt_scale:
      return {"degrees read as radians or radians as degrees", "a scale of integers not undone"};
    case FaultClass::yaw_not_applied:
      return {"velocity in body axes", "tilt in north and east axes", "heading missing from the attitude"};
    case FaultClass::latency:
      return {"delay of the receiver not taken off", "two clocks", "a smoothed velocity"};
    case FaultClass::tilt_offset:
      return {"autopilot mounted askew", "an uneven load", "a level calibration gone"};
    case FaultClass::attitude_unrelated:
      return {"columns that are not roll and pitch of the body", "a wrong conversion from quaternions",
              "a gimbal's attitude"};
    case FaultClass::vertical_velocity:
      return {"up for down", "feet read as metres", "a rate of another sensor"};
    case FaultClass::velocity_against_position:
      return {"another unit", "another order or sense of axes"};
    case FaultClass::frozen_stream:
      return {"a sensor that stopped", "a logger that repeats its last value"};
    case FaultClass::zeros_before_fix:
      return {"a receiver without a fix writes zeros"};
    case FaultClass::unexplained:
      break;
  }
  return {"a noise larger than assumed", "another vehicle's drag", "a fault not known here"};
}

Telemetry mapped(const Telemetry& in, const TelemetryMap& map) {
  Telemetry out = in;
  for (std::size_t i = 0; i < in.attitude_time.size(); ++i) {
    out.tilt[i] = map.tilt_scale * (map.tilt * in.tilt[i]);
    out.heading[i] = map.no_heading ? 0 : map.heading_sign * map.heading_scale * in.heading[i] + map.heading_offset;
    const double turns = map.turn == TelemetryMap::Turn::never ? 0 : map.turn == TelemetryMap::Turn::once ? 1 : 2;
    out.slope[i] = turned(out.tilt[i], turns * out.heading[i]);
  }
  const double sense = map.axes == TelemetryMap::VelocityAxes::earth              ? 0
                       : map.axes == TelemetryMap::VelocityAxes::heading_to_earth ? 1
                                                                                  : -1;
  for (std::size_t i = 0; i < in.v.size(); ++i) {
    out.v[i] = map.velocity * in.v[i];
    if (sense != 0)
      out.v[i] = turned(out.v[i], sense * interpolated(in.attitude_time, in.heading, in.velocity_time[i]));
  }
  return out;
}

std::vector<FaultCandidate> discrete_faults() {
  using enum FaultClass;
  std::vector<FaultCandidate> all{
      of_tilt(rotation, "tilt-sign", "the tilt has the wrong sign: roll and pitch are reversed, or both velocities are",
              -Matrix2d::Identity()),
      of_tilt(rotation, "tilt-right-90", "the tilt is turned against the velocity by 90 degrees", turning(90 * degree)),
      of_tilt(rotation, "tilt-left-90", "the tilt is turned against the velocity by -90 degrees",
              turning(-90 * degree)),
      of_tilt(reflection, "roll-pitch-exchanged", "roll and pitch are exchanged", matrix(0, -1, -1, 0)),
      of_tilt(reflection, "roll-pitch-exchanged-reversed", "roll and pitch are exchanged and reversed",
              matrix(0, 1, 1, 0)),
      of_tilt(reflection, "pitch-sign", "the pitch has the wrong sign", matrix(-1, 0, 0, 1)),
      of_tilt(reflection, "roll-sign", "the roll has the wrong sign", matrix(1, 0, 0, -1)),
      of_velocity("north-east-exchanged", "north and east velocity are exchanged", matrix(0, 1, 1, 0)),
      of_velocity("north-east-exchanged-reversed", "north and east velocity are exchanged and reversed",
                  matrix(0, -1, -1, 0)),
      of_velocity("north-sign", "the north velocity has the wrong sign", matrix(-1, 0, 0, 1)),
      of_velocity("east-sign", "the east velocity has the wrong sign", matrix(1, 0, 0, -1)),
      of_heading("heading-sense", "the heading runs counter-clockwise", 0),
      of_heading("heading-from-east", "the heading is counted from east, counter-clockwise", 90 * degree)};
  add_yaw(all);
  FaultCandidate angles{tilt_scale,
                        "angles-radians",
                        "roll, pitch and heading are 57.3 times too small: radians read as degrees",
                        {},
                        {}};
  angles.undo.tilt_scale = angles.undo.heading_scale = 1 / degree;
  angles.commit.tilt_scale = angles.commit.heading_scale = degree;
  all.push_back(angles);
  return all;
}

std::vector<FaultCandidate> typical_faults() {
  auto all = discrete_faults();
  FaultCandidate lost{
      FaultClass::yaw_not_applied, "heading-missing", "the heading is missing from the attitude", {}, {}};
  lost.commit.no_heading = true;
  all.push_back(lost);
  all.push_back(scaled_by(units[0].factor, false));
  FaultCandidate tilt{FaultClass::tilt_scale,
                      "tilt-radians",
                      "roll and pitch are 57.3 times too small: radians read as degrees",
                      {},
                      {}};
  tilt.undo.tilt_scale = 1 / degree;
  tilt.commit.tilt_scale = degree;
  all.push_back(tilt);
  all.push_back(late_by(0.2));
  all.push_back(turned_by(10 * degree));
  return all;
}

FaultCandidate turned_by(double angle) {
  auto c = of_tilt(FaultClass::rotation, "turned", "", turning(angle));
  c.sentence = fmt::format("the tilt is turned against the velocity by {:.0f} degrees", angle / degree);
  return c;
}

FaultCandidate scaled_by(double factor, bool confirmed) {
  FaultCandidate c{FaultClass::velocity_scale, "velocity-scale", "", {}, {}};
  c.undo.velocity_scale = factor;
  c.commit.velocity_scale = 1 / factor;
  const bool radians = std::abs(std::log(factor * degree)) < 0.2, degrees = std::abs(std::log(factor / degree)) < 0.2;
  const Unit* unit = nearest_unit(factor);
  if (radians || degrees || confirmed) {
    c.fault = FaultClass::tilt_scale;
    c.id = "tilt-scale";
    c.undo.velocity_scale = c.commit.velocity_scale = 1;
    c.undo.tilt_scale = factor;
    c.commit.tilt_scale = 1 / factor;
    c.sentence = fmt::format("roll and pitch are {:.3g} times what the velocity asks for", 1 / factor);
    if (radians) c.sentence += ": radians read as degrees";
    if (degrees) c.sentence += ": degrees read as radians";
  } else if (unit) {
    c.sentence = fmt::format("the velocity is {:.3g} times what the tilt asks for: {}", factor, unit->text);
  } else {
    c.sentence = fmt::format("the velocity is {:.3g} times what the tilt asks for, or the tilt {:.3g} times too small",
                             factor, factor);
  }
  return c;
}

FaultCandidate late_by(double seconds) {
  FaultCandidate c{FaultClass::latency, "latency", "", {}, {}};
  c.undo.latency = seconds;
  c.commit.latency = -seconds;
  c.sentence = fmt::format("the velocity is {:.2f} s {} than the attitude of the same time stamp", std::abs(seconds),
                           seconds > 0 ? "older" : "younger");
  return c;
}

}  // namespace quadsonde::ingest

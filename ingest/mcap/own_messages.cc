#include "ingest/mcap/own_messages.h"

#include <google/protobuf/util/json_util.h>

#include <functional>
#include <map>
#include <string>

#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/proto/quadsonde.pb.h"

namespace quadsonde::ingest::own {
namespace {

template <class Pb>
class OwnHandler : public TopicHandler {
 public:
  OwnHandler(bool json, std::function<void(LogTime, const Pb&)> sink) : json_(json), sink_(std::move(sink)) {}
  bool take(LogTime time, Bytes data) override {
    if (json_) {
      google::protobuf::util::JsonParseOptions options;
      options.ignore_unknown_fields = true;
      message_.Clear();
      if (!google::protobuf::util::JsonStringToMessage(std::string(as_text(data)), &message_, options).ok())
        return false;
    } else if (data.size() > std::size_t{INT32_MAX} ||
               !message_.ParseFromArray(data.data(), static_cast<int>(data.size()))) {
      return false;
    }
    sink_(time, message_);
    return true;
  }

 private:
  bool json_;
  std::function<void(LogTime, const Pb&)> sink_;
  Pb message_;
};

/// What the metadata of a channel tell of its stream.
struct StreamInfo {
  std::string source;
  std::optional<Latency> latency;
};

using Maker = std::function<std::unique_ptr<TopicHandler>(bool json, Collected&, const StreamInfo&)>;

/// A maker for one message type that goes into one stream: value(Pb) gives the sample.
template <class Pb, class S, class Value>
Maker into(S Flight::*stream, Value value) {
  return [=](bool json, Collected& c, const StreamInfo& info) -> std::unique_ptr<TopicHandler> {
    auto& target = c.flight.*stream;
    if (!info.source.empty()) target.source = info.source;
    if (info.latency) target.latency = info.latency;
    return std::make_unique<OwnHandler<Pb>>(json, [&target, value](LogTime t, const Pb& m) { target.push(t, value(m)); });
  };
}

template <class Pb>
Maker with(std::function<void(Collected&, LogTime, const Pb&)> sink) {
  return [=](bool json, Collected& c, const StreamInfo&) -> std::unique_ptr<TopicHandler> {
    return std::make_unique<OwnHandler<Pb>>(json, [&c, sink](LogTime t, const Pb& m) { sink(c, t, m); });
  };
}

void take_velocity(Collected& c, LogTime t, const Velocity& m) {
  auto& velocity = c.flight.velocity;
  // Either every sample states its noise or none: one without it, as a foreign writer may leave, is unknown.
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (m.has_sd_m_s() && velocity.sd.empty()) velocity.sd.assign(velocity.size(), kUnknown);
  const bool keeps_sd = m.has_sd_m_s() || !velocity.sd.empty();
  velocity.push(t, {m.north_m_s(), m.east_m_s(), m.down_m_s()});
  if (keeps_sd) velocity.sd.push_back(m.has_sd_m_s() ? m.sd_m_s() : kUnknown);
}

ingest::Event event_of(const quadsonde::Event& m) {
  using What = ingest::Event::What;
  const bool known = m.what() >= quadsonde::Event::ARMED && m.what() <= quadsonde::Event::TEXT;
  return {known ? static_cast<What>(m.what()) : What::text, m.text()};
}

ingest::Problem problem_of(const quadsonde::Problem& m) {
  ingest::Problem problem{kind_named(m.kind()).value_or(Kind::damaged), m.what(), {m.file(), {}, {}, m.topic()}, m.hint()};
  if (m.has_byte()) problem.where.byte = m.byte();
  if (m.has_line()) problem.where.line = m.line();
  return problem;
}

BarometerSample barometer_of(const Barometer& m) {
  BarometerSample sample;
  if (m.has_pressure_pa()) sample.pressure_pa = m.pressure_pa();
  if (m.has_altitude_m()) sample.altitude_m = m.altitude_m();
  return sample;
}

AirSample air_of(const Air& m) {
  AirSample sample;
  if (m.has_temperature_k()) sample.temperature_k = m.temperature_k();
  if (m.has_relative_humidity_pct()) sample.relative_humidity_pct = m.relative_humidity_pct();
  if (m.has_pressure_pa()) sample.pressure_pa = m.pressure_pa();
  return sample;
}

ingest::AutopilotWind wind_of(const quadsonde::AutopilotWind& m) {
  return {{m.north_m_s(), m.east_m_s()}, m.has_sd_m_s() ? std::optional(m.sd_m_s()) : std::nullopt};
}

void add_motion(std::map<std::string, Maker>& makers) {
  makers["quadsonde.Attitude"] = into<Attitude>(&Flight::attitude, [](const Attitude& m) {
    return Eigen::Quaterniond(m.w(), m.x(), m.y(), m.z());
  });
  makers["quadsonde.Velocity"] = with<Velocity>(take_velocity);
  makers["quadsonde.LocalPosition"] = into<LocalPosition>(&Flight::local_position, [](const LocalPosition& m) {
    return Eigen::Vector3d(m.north_m(), m.east_m(), m.down_m());
  });
  makers["quadsonde.SpecificForce"] = into<SpecificForce>(&Flight::accelerometer, [](const SpecificForce& m) {
    return Eigen::Vector3d(m.forward_m_s2(), m.right_m_s2(), m.down_m_s2());
  });
  makers["quadsonde.Position"] =
      into<Position>(&Flight::position, [](const Position& m) { return GeoPoint{m.lat_deg(), m.lon_deg()}; });
  makers["quadsonde.MslHeight"] = into<quadsonde::MslHeight>(
      &Flight::height_msl, [](const quadsonde::MslHeight& m) { return ingest::MslHeight{m.height_msl_m()}; });
  makers["quadsonde.EllipsoidHeight"] =
      into<quadsonde::EllipsoidHeight>(&Flight::height_ellipsoid, [](const quadsonde::EllipsoidHeight& m) {
        return ingest::EllipsoidHeight{m.height_ellipsoid_m()};
      });
  makers["quadsonde.GroundHeight"] = into<quadsonde::GroundHeight>(
      &Flight::height_ground, [](const quadsonde::GroundHeight& m) { return ingest::GroundHeight{m.height_agl_m()}; });
}

void add_others(std::map<std::string, Maker>& makers) {
  makers["quadsonde.Barometer"] = into<Barometer>(&Flight::barometer, barometer_of);
  makers["quadsonde.RotorSpeeds"] = into<quadsonde::RotorSpeeds>(&Flight::rotors, [](const quadsonde::RotorSpeeds& m) {
    return ingest::RotorSpeeds(m.rpm().begin(), m.rpm().end());
  });
  makers["quadsonde.Air"] = into<Air>(&Flight::air, air_of);
  makers["quadsonde.AutopilotWind"] = into<quadsonde::AutopilotWind>(&Flight::autopilot_wind, wind_of);
  makers["quadsonde.Event"] = into<quadsonde::Event>(&Flight::events, event_of);
  makers["quadsonde.Landed"] = into<Landed>(&Flight::landed, [](const Landed& m) { return m.landed(); });
  makers["quadsonde.Gap"] = with<quadsonde::Gap>([](Collected& c, LogTime t, const quadsonde::Gap& m) {
    c.flight.gaps.push_back({t, t + Duration(m.duration_ns())});
  });
  makers["quadsonde.Problem"] = with<quadsonde::Problem>(
      [](Collected& c, LogTime, const quadsonde::Problem& m) { c.flight.problems.push_back(problem_of(m)); });
  makers["quadsonde.TrueWind"] = with<TrueWind>([](Collected& c, LogTime t, const TrueWind& m) {
    c.truth.push_back({t, {m.height_agl_m()}, {m.north_m_s(), m.east_m_s(), m.down_m_s()}});
  });
}

const std::map<std::string, Maker>& makers() {
  static const auto* const table = [] {
    auto* filled = new std::map<std::string, Maker>;
    add_motion(*filled);
    add_others(*filled);
    return filled;
  }();
  return *table;
}

/// Numbers of a metadata record: absent is fine, something else than a number is not.
template <class T>
bool take_number(const std::map<std::string_view, std::string_view>& values, std::string_view key,
                 std::optional<T>& into) {
  const auto found = values.find(key);
  if (found == values.end()) return true;
  const auto number = number_from<T>(found->second);
  if (number) into = number;
  return number.has_value();
}

bool take_clock(const std::map<std::string_view, std::string_view>& values, Collected& c) {
  std::optional<std::int64_t> offset;
  std::optional<double> uncertainty;
  bool ok = take_number(values, kShift, c.mcap_minus_log_ns);
  ok = take_number(values, "utc_minus_log_ns", offset) && ok;
  ok = take_number(values, "uncertainty_s", uncertainty) && ok;
  if (offset) c.flight.clock.utc_minus_log = Duration(*offset);
  c.flight.clock.uncertainty_s = uncertainty.value_or(0);
  if (const auto source = values.find("source"); source != values.end()) c.flight.clock.source = source->second;
  c.any = true;
  return ok;
}

bool take_vehicle(const std::map<std::string_view, std::string_view>& values, VehicleIdentity& vehicle) {
  const auto text = [&](std::string_view key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string_view{} : found->second;
  };
  vehicle.name = text("name");
  vehicle.autopilot = text("autopilot");
  vehicle.firmware = text("firmware");
  vehicle.airframe = airframe_named(text("airframe")).value_or(Airframe::unknown);
  vehicle.simulated = text("simulated") == "true";
  std::optional<int> rotors;
  bool ok = take_number(values, "rotors", rotors);
  ok = take_number(values, "mass_kg", vehicle.mass_kg) && ok;
  vehicle.rotors = rotors.value_or(0);
  return ok;
}

bool take_origin(const std::map<std::string_view, std::string_view>& values, Flight& flight) {
  std::optional<double> lat, lon, height;
  bool ok = take_number(values, "lat_deg", lat);
  ok = take_number(values, "lon_deg", lon) && ok;
  ok = take_number(values, "height_msl_m", height) && ok;
  if (!lat || !lon) return false;
  flight.origin = Origin{{*lat, *lon}, {}};
  if (height) flight.origin->height_msl = ingest::MslHeight{*height};
  return ok;
}

}  // namespace

std::unique_ptr<TopicHandler> handler_for(const mcap::KnownChannel& channel, const mcap::KnownSchema* schema,
                                          Collected& into) {
  // A JSON schema of ours has the same name as the protobuf one. Winds and profiles that we computed have no maker:
  // an estimate is no measurement.
  const auto found = schema ? makers().find(schema->name) : makers().end();
  const bool json = channel.message_encoding == "json";
  if (found == makers().end() || !(json || channel.message_encoding == "protobuf")) return nullptr;
  into.any = true;
  StreamInfo info;
  std::optional<double> latency;
  bool at_least = false;
  for (const auto& [key, value] : channel.metadata) {
    if (key == kSource) info.source = value;
    if (key == kLatency) latency = number_from<double>(value);
    if (key == kLatencyAtLeast) at_least = value == "true";
    if (key == kShift && !into.mcap_minus_log_ns) into.mcap_minus_log_ns = number_from<std::int64_t>(value);
    if (key == kVelocityOrigin)
      into.flight.velocity.origin = velocity_origin_named(value).value_or(VelocityOrigin::receiver);
  }
  if (latency) info.latency = Latency{*latency, at_least};
  if (schema->name == "quadsonde.Velocity") {
    into.flight.velocity.source = info.source;
    into.flight.velocity.latency = info.latency;
  }
  return found->second(json, into, info);
}

bool take_metadata(const mcap::Metadata& record, Collected& into) {
  std::map<std::string_view, std::string_view> values;
  for (const auto& [key, value] : record.metadata) values[key] = value;
  if (record.name == kClock) return take_clock(values, into);
  if (record.name == kVehicle) return take_vehicle(values, into.flight.vehicle);
  if (record.name == kOrigin) return take_origin(values, into.flight);
  return true;
}

void apply_clock(Collected& collected) {
  const Duration shift(collected.mcap_minus_log_ns.value_or(0));
  const auto move = [&](auto& stream) {
    for (auto& time : stream.time) time = time - shift;
  };
  auto& f = collected.flight;
  move(f.attitude), move(f.velocity), move(f.position), move(f.local_position), move(f.height_msl);
  move(f.height_ellipsoid), move(f.height_ground), move(f.barometer), move(f.accelerometer), move(f.rotors);
  move(f.air), move(f.autopilot_wind), move(f.events), move(f.landed);
  for (auto& gap : f.gaps) gap.from = gap.from - shift, gap.to = gap.to - shift;
  for (auto& wind : collected.truth) wind.time = wind.time - shift;
}

}  // namespace quadsonde::ingest::own

#include "export/mcap/tracks.h"

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include <cmath>

#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/proto/quadsonde.pb.h"

namespace quadsonde::product {
namespace {

namespace own = ingest::own;
using google::protobuf::Message;

/// A track over one stream; fill(value, Pb&, sample).
template <class Pb, class S, class Fill>
void add(std::vector<Track>& tracks, const char* name, const S& stream, Fill fill,
         ingest::mcap::Writer::Pairs metadata = {}) {
  if (stream.empty() && stream.source.empty()) return;
  metadata.emplace_back(own::kSource, own::utf8(stream.source));
  if (stream.latency) {
    metadata.emplace_back(own::kLatency, fmt::format("{}", stream.latency->median_s));
    metadata.emplace_back(own::kLatencyAtLeast, stream.latency->at_least ? "true" : "false");
  }
  tracks.push_back({std::string(own::kTopicPrefix) + name, std::move(metadata), stream.time, std::make_unique<Pb>(),
                    [&stream, fill](std::size_t i, std::uint64_t, Message& message) {
                      fill(stream.value[i], static_cast<Pb&>(message), i);
                    }});
}

void add_motion(std::vector<Track>& tracks, const ingest::Flight& flight) {
  add<Attitude>(tracks, "attitude", flight.attitude, [](const Eigen::Quaterniond& q, Attitude& m, std::size_t) {
    m.set_w(q.w());
    m.set_x(q.x());
    m.set_y(q.y());
    m.set_z(q.z());
  });
  const auto& sd = flight.velocity.sd;
  add<Velocity>(
      tracks, "velocity", flight.velocity,
      [&sd](const Eigen::Vector3d& v, Velocity& m, std::size_t i) {
        m.set_north_m_s(v.x());
        m.set_east_m_s(v.y());
        m.set_down_m_s(v.z());
        if (i < sd.size()) m.set_sd_m_s(sd[i]);
      },
      {{own::kVelocityOrigin, std::string(own::name_of(flight.velocity.origin))}});
  add<LocalPosition>(tracks, "local_position", flight.local_position,
                     [](const Eigen::Vector3d& p, LocalPosition& m, std::size_t) {
                       m.set_north_m(p.x());
                       m.set_east_m(p.y());
                       m.set_down_m(p.z());
                     });
  add<SpecificForce>(tracks, "accelerometer", flight.accelerometer,
                     [](const Eigen::Vector3d& f, SpecificForce& m, std::size_t) {
                       m.set_forward_m_s2(f.x());
                       m.set_right_m_s2(f.y());
                       m.set_down_m_s2(f.z());
                     });
}

void add_place(std::vector<Track>& tracks, const ingest::Flight& flight) {
  add<Position>(tracks, "position", flight.position, [](const ingest::GeoPoint& p, Position& m, std::size_t) {
    m.set_lat_deg(p.lat_deg);
    m.set_lon_deg(p.lon_deg);
  });
  add<MslHeight>(tracks, "height_msl", flight.height_msl,
                 [](ingest::MslHeight h, MslHeight& m, std::size_t) { m.set_height_msl_m(h.m); });
  add<EllipsoidHeight>(tracks, "height_ellipsoid", flight.height_ellipsoid,
                       [](ingest::EllipsoidHeight h, EllipsoidHeight& m, std::size_t) { m.set_height_ellipsoid_m(h.m); });
  add<GroundHeight>(tracks, "height_ground", flight.height_ground,
                    [](ingest::GroundHeight h, GroundHeight& m, std::size_t) { m.set_height_agl_m(h.m); });
}

void add_sensors(std::vector<Track>& tracks, const ingest::Flight& flight) {
  add<Barometer>(tracks, "barometer", flight.barometer,
                 [](const ingest::BarometerSample& s, Barometer& m, std::size_t) {
                   if (s.pressure_pa) m.set_pressure_pa(*s.pressure_pa);
                   if (s.altitude_m) m.set_altitude_m(*s.altitude_m);
                 });
  add<RotorSpeeds>(tracks, "rotors", flight.rotors, [](const ingest::RotorSpeeds& s, RotorSpeeds& m, std::size_t) {
    m.mutable_rpm()->Add(s.begin(), s.end());
  });
  add<Air>(tracks, "air", flight.air, [](const ingest::AirSample& s, Air& m, std::size_t) {
    if (s.temperature_k) m.set_temperature_k(*s.temperature_k);
    if (s.relative_humidity_pct) m.set_relative_humidity_pct(*s.relative_humidity_pct);
    if (s.pressure_pa) m.set_pressure_pa(*s.pressure_pa);
  });
  add<AutopilotWind>(tracks, "autopilot_wind", flight.autopilot_wind,
                     [](const ingest::AutopilotWind& w, AutopilotWind& m, std::size_t) {
                       m.set_north_m_s(w.v_NA_N.x());
                       m.set_east_m_s(w.v_NA_N.y());
                       if (w.sd) m.set_sd_m_s(*w.sd);
                     });
}

void add_events(std::vector<Track>& tracks, const ingest::Flight& flight) {
  add<Event>(tracks, "event", flight.events, [](const ingest::Event& e, Event& m, std::size_t) {
    m.set_what(static_cast<Event::What>(e.what));
    m.set_text(own::utf8(e.text));
  });
  add<Landed>(tracks, "landed", flight.landed, [](bool landed, Landed& m, std::size_t) { m.set_landed(landed); });
  if (flight.gaps.empty()) return;
  Track gaps{std::string(own::kTopicPrefix) + "gap", {}, {}, std::make_unique<Gap>(),
             [&flight](std::size_t i, std::uint64_t, Message& message) {
               static_cast<Gap&>(message).set_duration_ns((flight.gaps[i].to - flight.gaps[i].from).count());
             }};
  for (const auto& gap : flight.gaps) gaps.times.push_back(gap.from);
  tracks.push_back(std::move(gaps));
}

void fill_problem(const ingest::Problem& problem, Problem& m) {
  m.set_kind(std::string(own::name_of(problem.kind)));
  m.set_what(own::utf8(problem.what));
  m.set_hint(own::utf8(problem.hint));
  m.set_file(own::utf8(problem.where.file));
  if (problem.where.byte) m.set_byte(*problem.where.byte);
  if (problem.where.line) m.set_line(*problem.where.line);
  m.set_topic(own::utf8(problem.where.topic));
}

void add_problems(std::vector<Track>& tracks, const ingest::Flight& flight) {
  if (flight.problems.empty()) return;
  // Problems have no time of their own.
  const auto first = first_time(tracks);
  tracks.push_back({std::string(own::kTopicPrefix) + "problem", {},
                    std::vector<ingest::LogTime>(flight.problems.size(), first), std::make_unique<Problem>(),
                    [&flight](std::size_t i, std::uint64_t, Message& message) {
                      fill_problem(flight.problems[i], static_cast<Problem&>(message));
                    }});
}

void add_truth(std::vector<Track>& tracks, const ingest::Truth& truth) {
  if (truth.empty()) return;
  Track track{std::string(own::kTopicPrefix) + "true_wind", {}, {}, std::make_unique<TrueWind>(),
              [&truth](std::size_t i, std::uint64_t, Message& message) {
                auto& m = static_cast<TrueWind&>(message);
                m.set_north_m_s(truth[i].v_NA_N.x());
                m.set_east_m_s(truth[i].v_NA_N.y());
                m.set_down_m_s(truth[i].v_NA_N.z());
                m.set_height_agl_m(truth[i].height.m);
              }};
  for (const auto& wind : truth) track.times.push_back(wind.time);
  tracks.push_back(std::move(track));
}

}  // namespace

ingest::LogTime first_time(const std::vector<Track>& tracks) {
  std::optional<ingest::LogTime> first;
  for (const auto& track : tracks)
    for (const auto time : track.times)
      if (!first || time < *first) first = time;
  return first.value_or(ingest::LogTime{});
}

void Track::encode(std::size_t sample, std::uint64_t mcap_time, std::string& data) {
  message->Clear();
  fill(sample, mcap_time, *message);
  data.clear();
  if (!json) {
    message->AppendToString(&data);
    return;
  }
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  // It fails only for messages of types that the schema does not have (Any); texts that are no UTF-8 are mended.
  (void)google::protobuf::util::MessageToJsonString(*message, &data, options);
}

std::vector<Track> tracks_of(const ingest::Flight& flight, const ingest::Truth& truth,
                             const FlightFileSettings& settings) {
  std::vector<Track> tracks;
  add_motion(tracks, flight);
  add_place(tracks, flight);
  add_sensors(tracks, flight);
  add_events(tracks, flight);
  add_problems(tracks, flight);
  add_truth(tracks, truth);
  for (auto& track : tracks) track.json = settings.encoding == FlightFileSettings::Encoding::json;
  if (!settings.viewer_topics) return tracks;
  for (auto& track : viewer_tracks_of(flight)) tracks.push_back(std::move(track));
  return tracks;
}

}  // namespace quadsonde::product

// Foxglove's own schemas, so that a viewer shows a flight without configuration. Nothing reads them back.
#include <algorithm>

#include "export/mcap/tracks.h"
#include "ingest/mcap/own_schema.h"
#include "ingest/mcap/proto/foxglove.pb.h"

namespace quadsonde::product {
namespace {

using google::protobuf::Message;
using ingest::LogTime;

constexpr double kPoseInterval = 0.04;  // an eye needs no more [s]

void set_time(google::protobuf::Timestamp& stamp, std::uint64_t mcap_time) {
  stamp.set_seconds(static_cast<std::int64_t>(mcap_time / 1'000'000'000u));
  stamp.set_nanos(static_cast<std::int32_t>(mcap_time % 1'000'000'000u));
}

template <class H>
std::optional<double> height_at(const ingest::Stream<H>& heights, LogTime time) {
  const auto i = ingest::last_at_or_before(heights, time);
  return i < 0 ? std::nullopt : std::optional(heights.value[static_cast<std::size_t>(i)].m);
}

/// NED and FRD to the viewer's east-north-up and forward-left-up.
Eigen::Quaterniond to_enu_flu(const Eigen::Quaterniond& q_NB) {
  const double h = std::sqrt(0.5);
  return (Eigen::Quaterniond(0, h, h, 0) * q_NB * Eigen::Quaterniond(0, 1, 0, 0)).normalized();
}

Track location_track(const ingest::Flight& flight) {
  return {"/foxglove/location", {}, flight.position.time, std::make_unique<foxglove::LocationFix>(),
          [&flight](std::size_t i, std::uint64_t mcap_time, Message& message) {
            auto& m = static_cast<foxglove::LocationFix&>(message);
            const auto time = flight.position.time[i];
            m.set_latitude(flight.position.value[i].lat_deg);
            m.set_longitude(flight.position.value[i].lon_deg);
            const auto ellipsoid = height_at(flight.height_ellipsoid, time);
            m.set_altitude(ellipsoid ? *ellipsoid : height_at(flight.height_msl, time).value_or(0));
            set_time(*m.mutable_timestamp(), mcap_time);
            m.set_frame_id("gps");
          }};
}

Track pose_track(const ingest::Flight& flight) {
  std::vector<std::size_t> picked;
  std::vector<LogTime> times;
  for (std::size_t i = 0; i < flight.attitude.size(); ++i) {
    if (!times.empty() && ingest::to_seconds(flight.attitude.time[i] - times.back()) < kPoseInterval) continue;
    picked.push_back(i);
    times.push_back(flight.attitude.time[i]);
  }
  return {"/foxglove/pose", {}, std::move(times), std::make_unique<foxglove::PoseInFrame>(),
          [&flight, picked = std::move(picked)](std::size_t k, std::uint64_t mcap_time, Message& message) {
            auto& m = static_cast<foxglove::PoseInFrame&>(message);
            const auto i = picked[k];
            const auto at = ingest::last_at_or_before(flight.local_position, flight.attitude.time[i]);
            const Eigen::Vector3d p = at < 0 ? Eigen::Vector3d(0, 0, 0)
                                             : flight.local_position.value[static_cast<std::size_t>(at)];
            const auto q = to_enu_flu(flight.attitude.value[i]);
            set_time(*m.mutable_timestamp(), mcap_time);
            m.set_frame_id("local_enu");
            auto& position = *m.mutable_pose()->mutable_position();
            position.set_x(p.y());
            position.set_y(p.x());
            position.set_z(-p.z());
            auto& orientation = *m.mutable_pose()->mutable_orientation();
            orientation.set_x(q.x());
            orientation.set_y(q.y());
            orientation.set_z(q.z());
            orientation.set_w(q.w());
          }};
}

Track log_track(const ingest::Flight& flight) {
  const auto first = flight.events.empty() ? LogTime{} : flight.events.time.front();
  auto times = flight.events.time;
  const auto span = ingest::time_span(flight);
  times.insert(times.end(), flight.problems.size(), span ? span->first : first);
  return {"/foxglove/log", {}, std::move(times), std::make_unique<foxglove::Log>(),
          [&flight](std::size_t i, std::uint64_t mcap_time, Message& message) {
            auto& m = static_cast<foxglove::Log&>(message);
            set_time(*m.mutable_timestamp(), mcap_time);
            m.set_name("quadsonde");
            if (i < flight.events.size()) {
              m.set_level(foxglove::Log::INFO);
              m.set_message(ingest::own::utf8(flight.events.value[i].text));
            } else {
              m.set_level(foxglove::Log::WARNING);
              m.set_message(ingest::own::utf8(ingest::to_string(flight.problems[i - flight.events.size()])));
            }
          }};
}

}  // namespace

std::vector<Track> viewer_tracks_of(const ingest::Flight& flight) {
  std::vector<Track> tracks;
  if (!flight.position.empty()) tracks.push_back(location_track(flight));
  if (!flight.attitude.empty()) tracks.push_back(pose_track(flight));
  if (!flight.events.empty() || !flight.problems.empty()) tracks.push_back(log_track(flight));
  return tracks;
}

}  // namespace quadsonde::product

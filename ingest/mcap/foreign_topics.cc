#include "ingest/mcap/foreign_topics.h"

#include <fmt/format.h>

#include <algorithm>

#include "ingest/mcap/foreign_rules.h"

namespace quadsonde::ingest::foreign {
namespace {

/// One channel: a decoder and the rules that its messages go through.
class ForeignHandler : public TopicHandler {
 public:
  ForeignHandler(std::unique_ptr<MessageDecoder> decoder, Rule by_map, Part* named, Rule by_schema, Part* guessed)
      : decoder_(std::move(decoder)),
        by_map_(std::move(by_map)),
        by_schema_(std::move(by_schema)),
        named_(named),
        guessed_(guessed) {}

  bool take(LogTime time, Bytes data) override {
    if (!decoder_->decode(data, message_)) return false;
    if (by_map_) by_map_(time, message_, *named_);
    if (by_schema_) by_schema_(stated_time(time, message_), message_, *guessed_);
    return true;
  }

 private:
  std::unique_ptr<MessageDecoder> decoder_;
  Rule by_map_, by_schema_;
  Part *named_, *guessed_;
  Json message_;
};

double span(const std::vector<LogTime>& time) {
  if (time.size() < 2) return 0;
  const auto [first, last] = std::ranges::minmax(time);
  return to_seconds(last - first);
}

/// The receiver's velocity has white noise and says how good it is; the estimator's is smoother but holds the
/// autopilot's idea of the motion. So the receiver, where it is quick enough and covers the flight: as for ULog.
bool receiver_is_good(const VelocityStream& receiver, const VelocityStream& fused) {
  constexpr double kLeastRate = 4.0;  // [Hz]
  if (fused.size() < 2) return true;
  const double seconds = span(receiver.time);
  return seconds > 0 && static_cast<double>(receiver.size() - 1) / seconds >= kLeastRate &&
         seconds >= 0.5 * span(fused.time);
}

/// The stream with the most samples, those of the user's own word before all others.
template <class S>
const Part* best(const std::vector<std::unique_ptr<Part>>& parts, S Flight::*stream) {
  const Part* found = nullptr;
  for (const auto& part : parts) {
    const auto& candidate = part->flight.*stream;
    if (candidate.empty()) continue;
    const bool better = !found || (part->named && !found->named) ||
                        (part->named == found->named && candidate.size() > (found->flight.*stream).size());
    if (better) found = part.get();
  }
  return found;
}

template <class S>
void take_best(const std::vector<std::unique_ptr<Part>>& parts, S Flight::*stream, Flight& into) {
  if (const auto* part = best(parts, stream)) {
    into.*stream = part->flight.*stream;
    (into.*stream).source = part->topic;
  }
}

const Part* best_velocity(const std::vector<std::unique_ptr<Part>>& parts) {
  const Part *receiver = nullptr, *fused = nullptr;
  for (const auto& part : parts) {
    const auto& v = part->flight.velocity;
    if (v.empty()) continue;
    if (part->named) return part.get();
    auto& place = v.origin == VelocityOrigin::receiver ? receiver : fused;
    if (!place || v.size() > place->flight.velocity.size()) place = part.get();
  }
  if (!receiver || !fused) return receiver ? receiver : fused;
  return receiver_is_good(receiver->flight.velocity, fused->flight.velocity) ? receiver : fused;
}

/// A quaternion whose order of numbers is not what we take it for shows a vehicle that mostly flies on its side.
bool mostly_upright(const Stream<Eigen::Quaterniond>& attitude) {
  constexpr double kCosOf60 = 0.5;
  const auto upright = std::ranges::count_if(attitude.value, [](const Eigen::Quaterniond& q) {
    return (q.normalized() * Eigen::Vector3d::UnitZ()).z() > kCosOf60;
  });
  return 2 * static_cast<std::size_t>(upright) > attitude.size();
}

}  // namespace

std::unique_ptr<TopicHandler> Parts::handler_for(const mcap::KnownChannel& channel, const mcap::KnownSchema* schema,
                                                 const TopicMap* map) {
  const auto schema_name = schema ? schema->name : std::string{};
  auto by_map = map ? rule_for_map(channel.topic, *map) : Rule{};
  auto by_schema = rule_for_schema(schema_name);
  if (!by_schema && channel.message_encoding == "json") by_schema = rule_for_json(channel.topic, schema_name);
  if (!by_map && !by_schema) return nullptr;
  auto decoder = decoder_for(channel, schema);
  if (!decoder) return nullptr;
  const auto part = [&](bool named) {
    parts_.push_back(std::make_unique<Part>(Part{channel.topic, schema_name, named, {}}));
    return parts_.back().get();
  };
  auto* named = by_map ? part(true) : nullptr;
  auto* guessed = by_schema ? part(false) : nullptr;
  return std::make_unique<ForeignHandler>(std::move(decoder), std::move(by_map), named, std::move(by_schema), guessed);
}

Flight Parts::join(std::vector<Problem>& problems, const std::string& file_name) {
  Flight flight;
  take_best(parts_, &Flight::attitude, flight);
  if (const auto* part = best_velocity(parts_)) {
    flight.velocity = part->flight.velocity;
    flight.velocity.source = part->topic;
  }
  take_best(parts_, &Flight::position, flight);
  take_best(parts_, &Flight::local_position, flight);
  take_best(parts_, &Flight::height_msl, flight);
  take_best(parts_, &Flight::height_ellipsoid, flight);
  take_best(parts_, &Flight::height_ground, flight);
  take_best(parts_, &Flight::barometer, flight);
  take_best(parts_, &Flight::accelerometer, flight);
  take_best(parts_, &Flight::rotors, flight);
  take_best(parts_, &Flight::air, flight);
  take_best(parts_, &Flight::autopilot_wind, flight);
  take_best(parts_, &Flight::events, flight);
  take_best(parts_, &Flight::landed, flight);
  if (!flight.attitude.empty() && !mostly_upright(flight.attitude)) {
    problems.push_back({Kind::doubtful,
                        "the attitude lies on its side or upside down for most of the log: the order of its numbers or "
                        "its axes are not what they were taken for",
                        {file_name, {}, {}, flight.attitude.source},
                        "say what its fields are with --topics MAP.toml"});
    flight.attitude = {};
  }
  return flight;
}

}  // namespace quadsonde::ingest::foreign

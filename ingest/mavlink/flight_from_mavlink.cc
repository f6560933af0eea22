#include "ingest/mavlink/flight_from_mavlink.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <memory>

#include "ingest/mavlink/mavlink_vehicle.h"
#include "ingest/mavlink/tlog_reader.h"

namespace quadsonde::ingest {
namespace {

using mavlink::Binding;
using mavlink::Boot;
using mavlink::Identity;
using mavlink::Row;
using mavlink::Stamp;

constexpr std::int64_t ms_ns = 1'000'000, boot_wrap_ms = 4'294'967'296, back_ms = 3000, hour_ms = 3'600'000;
constexpr std::int64_t least_unix_us = 100'000'000'000'000;  // 1973: nothing runs 3 years, nothing flew then
constexpr std::uint64_t second_us = 1'000'000;
constexpr int witnesses = 12;
constexpr std::size_t most_boots = 256;  // nothing restarts more often while somebody listens

/// Heartbeats of what does not fly: ground stations, companions, gimbals, transponders, cameras.
bool is_vehicle(int type) { return type != 6 && type != 18 && type != 26 && type != 27 && type != 30; }

/// One system id on the link, from its first frame on.
struct System {
  Identity identity;
  std::vector<Boot> boots = std::vector<Boot>(1);
  std::uint64_t states = 0;  ///< attitudes and positions
  std::uint64_t repeated = 0, stale = 0;
  std::int64_t last_ms = -1, wraps_ms = 0;
  struct Seen {
    std::uint64_t time_us = 0;
    std::uint32_t id = 0;
    std::uint16_t crc = 0;
    std::uint8_t length = 0;
    bool any = false;
  };
  std::array<Seen, 256> seen;  ///< by sequence number of the autopilot
};

class Mapper {
 public:
  Mapper(Bytes bytes, std::string file, std::optional<std::uint8_t> wanted)
      : reader_(bytes), file_(std::move(file)), wanted_(wanted), topics_(mavlink_messages().size()) {}

  Result<LogContent> run(Reading mode);

 private:
  void count(const TlogRecord& record);
  void take(const TlogRecord& record);
  bool is_repeated(System& system, const TlogRecord& record) const;
  bool restarts(const System& system, std::uint8_t id) const;
  bool follow_boot(System& system, const MavlinkFrame& frame, std::int64_t& ms);
  std::optional<Stamp> stamp_of(System& system, const Binding& row, const TlogRecord& record);
  System* choose(LogContent& content);
  void note_damage(LogContent& content) const;
  LogContent finish();

  TlogReader reader_;
  std::string file_;
  std::optional<std::uint8_t> wanted_;
  std::vector<std::uint64_t> topics_;
  std::vector<std::uint32_t> topic_order_;
  std::map<std::pair<int, int>, std::uint64_t> sources_;
  std::uint64_t* last_source_ = nullptr;
  int last_system_ = -1, last_component_ = -1;
  std::array<std::unique_ptr<System>, 256> systems_;
};

void Mapper::count(const TlogRecord& record) {
  const auto& frame = record.frame;
  const auto topic = static_cast<std::size_t>(frame.info - mavlink_messages().data());
  if (topics_[topic]++ == 0) topic_order_.push_back(static_cast<std::uint32_t>(topic));
  if (frame.system != last_system_ || frame.component != last_component_) {
    last_system_ = frame.system;
    last_component_ = frame.component;
    last_source_ = &sources_[{frame.system, frame.component}];
  }
  ++*last_source_;
}

/// Two links recorded at once bring every frame twice.
bool Mapper::is_repeated(System& system, const TlogRecord& record) const {
  const auto& frame = record.frame;
  auto& seen = system.seen[frame.sequence];
  const bool same = seen.any && seen.id == frame.id && seen.crc == frame.crc && seen.length == frame.payload.size() &&
                    record.time_us < seen.time_us + second_us && seen.time_us < record.time_us + second_us;
  seen = {record.time_us, frame.id, frame.crc, static_cast<std::uint8_t>(frame.payload.size()), true};
  return same;
}

/// After a step back in boot time: whether the frames that follow go on from there, or only this one is late.
bool Mapper::restarts(const System& system, std::uint8_t id) const {
  int timed = 0, back = 0;
  std::size_t at = reader_.at();
  TlogRecord record;
  for (int i = 0; i < 16 * witnesses && timed < witnesses; ++i) {
    const auto end = reader_.peek(at, record);
    if (!end) break;
    at = *end;
    const auto& row = mavlink::binding_of(*record.frame.info);
    if (record.frame.system != id || record.frame.component != system.identity.component || !row.time_is_ms) continue;
    const PaddedPayload padded(record.frame);
    ++timed;
    if (row.time->integer(padded.data()) + system.wraps_ms < system.last_ms - back_ms) ++back;
  }
  return 2 * back >= timed;
}

/// Follows the boot clock through its wrap after 49.7 days and through restarts.
/// @param ms  as sent; comes back without wraps. @return false for a frame that is seconds late
bool Mapper::follow_boot(System& system, const MavlinkFrame& frame, std::int64_t& ms) {
  ms += system.wraps_ms;
  if (ms < system.last_ms - back_ms) {
    if (system.last_ms - ms > boot_wrap_ms - hour_ms) {
      system.wraps_ms += boot_wrap_ms;
      ms += boot_wrap_ms;
    } else if (system.boots.size() < most_boots && restarts(system, frame.system)) {
      ms -= system.wraps_ms;
      system.wraps_ms = 0;
      system.boots.emplace_back();
    } else {
      ++system.stale;
      return false;
    }
    system.last_ms = ms;
  }
  system.last_ms = std::max(system.last_ms, ms);
  return true;
}

std::optional<Stamp> Mapper::stamp_of(System& system, const Binding& row, const TlogRecord& record) {
  Stamp stamp;
  stamp.host =
      LogTime{static_cast<std::int64_t>(std::min<std::uint64_t>(record.time_us, 9'000'000'000'000'000) * 1000)};
  stamp.t = stamp.host;
  if (row.time == nullptr) return stamp;
  const PaddedPayload padded(record.frame);
  auto raw = row.time->integer(padded.data());
  if (row.time_is_ms) {
    if (!follow_boot(system, record.frame, raw)) return std::nullopt;
    stamp.clock = Stamp::Clock::boot;
    stamp.t = LogTime{raw * ms_ns};
    system.boots.back().pair_clocks(stamp.t, stamp.host);
  } else if (raw > 0 && raw < least_unix_us) {
    // Sensors may be the first to tell of a restart; a receiver's last fix may be old without one.
    auto ms = raw / 1000;
    if (ms < system.last_ms - back_ms &&
        (!restarts(system, record.frame.system) || !follow_boot(system, record.frame, ms)))
      return stamp;
    stamp.clock = Stamp::Clock::boot;
    stamp.t = LogTime{raw * 1000};
  } else if (raw >= least_unix_us && raw < 100 * least_unix_us / 2) {
    stamp.clock = Stamp::Clock::utc;
    stamp.t = LogTime{raw * 1000};
  }
  return stamp;
}

void Mapper::take(const TlogRecord& record) {
  const auto& frame = record.frame;
  const auto& row = mavlink::binding_of(*frame.info);
  auto& slot = systems_[frame.system];
  if (row.row == Row::none && slot == nullptr) return;
  if (slot == nullptr) {
    slot = std::make_unique<System>();
    slot->identity.system = frame.system;
  }
  auto& system = *slot;
  if (row.row == Row::heartbeat && !system.identity.has_heartbeat) {
    const PaddedPayload padded(frame);
    if (!is_vehicle(static_cast<int>(row.fields[0]->integer(padded.data())))) return;
    system.identity.has_heartbeat = true;
    system.identity.component = frame.component;
  }
  // A hygrometer may hang on a companion; everything else must come from the autopilot itself.
  if (frame.component != system.identity.component && row.row != Row::hygrometer) return;
  if (frame.component == system.identity.component && is_repeated(system, record)) {
    ++system.repeated;
    return;
  }
  if (row.row == Row::none) return;
  if (row.row == Row::attitude || row.row == Row::attitude_quaternion || row.row == Row::global_position)
    ++system.states;
  const auto stamp = stamp_of(system, row, record);
  if (stamp) system.boots.back().take(row, frame, *stamp, system.identity);
}

/// The system asked for; else the vehicle that said most about its attitude and position.
System* Mapper::choose(LogContent& content) {
  System* best = nullptr;
  for (const auto& system : systems_) {
    if (system == nullptr || (wanted_ && system->identity.system != *wanted_)) continue;
    const auto rank = [](const System& s) { return std::pair(s.identity.has_heartbeat, s.states); };
    if (best == nullptr || rank(*system) > rank(*best)) best = system.get();
  }
  int vehicles = 0;
  for (const auto& system : systems_) vehicles += system != nullptr && system->identity.has_heartbeat ? 1 : 0;
  if (best == nullptr) {
    if (wanted_)
      content.problems.push_back({Kind::missing,
                                  fmt::format("system {} sent nothing about a flight", *wanted_),
                                  {file_, {}, {}, {}},
                                  "take one of the systems that are listed"});
    return nullptr;
  }
  content.details.emplace_back("system used", fmt::format("{}/{}", best->identity.system, best->identity.component));
  if (vehicles > 1 && !wanted_)
    content.problems.push_back(
        {Kind::doubtful,
         fmt::format("{} vehicles share the file; system {} said most and is used", vehicles, best->identity.system),
         {file_, {}, {}, "HEARTBEAT"},
         "name the system if you want another"});
  return best;
}

void Mapper::note_damage(LogContent& content) const {
  if (reader_.skipped_bytes() > 0)
    content.problems.push_back({Kind::damaged,
                                fmt::format("{} bytes belong to no frame and were skipped", reader_.skipped_bytes()),
                                {file_, reader_.first_skipped(), {}, {}},
                                "the frames around them are used"});
  if (reader_.trailing_partial_bytes() > 0)
    content.problems.push_back({Kind::truncated,
                                fmt::format("the file ends {} bytes into a record", reader_.trailing_partial_bytes()),
                                {file_, reader_.at() - reader_.trailing_partial_bytes(), {}, {}},
                                "everything before it is used"});
  if (reader_.rejected() > 0)
    content.details.emplace_back("frames of unknown dialects", fmt::format("{} stepped over", reader_.rejected()));
  if (reader_.signed_frames() > 0)
    content.details.emplace_back("signed frames", fmt::format("{}, signatures not checked", reader_.signed_frames()));
}

LogContent Mapper::finish() {
  LogContent content;
  content.format = "mavlink";
  content.messages = reader_.frames();
  content.salvaged = reader_.salvaged();
  for (const auto topic : topic_order_)
    content.topics.push_back({std::string(mavlink_messages()[topic].name), topics_[topic]});
  for (const auto& [source, frames] : sources_)
    content.details.emplace_back(fmt::format("source {}/{}", source.first, source.second),
                                 fmt::format("{} frames", frames));
  note_damage(content);
  if (auto* system = choose(content)) {
    if (system->repeated > 0) content.details.emplace_back("frames heard twice", fmt::format("{}", system->repeated));
    if (system->stale > 0)
      content.details.emplace_back("frames seconds late, left out", fmt::format("{}", system->stale));
    for (auto& boot : system->boots)
      if (boot.has_data()) content.flights.push_back(std::move(boot).finish(system->identity, content.details));
    if (!system->identity.has_heartbeat && !content.flights.empty())
      content.flights.front().problems.push_back({Kind::doubtful,
                                                  "no HEARTBEAT says what kind of vehicle this is",
                                                  {file_, {}, {}, "HEARTBEAT"},
                                                  "it is taken for a multirotor's log"});
  }
  if (content.flights.empty())
    content.problems.push_back({Kind::missing,
                                "no frame tells attitude, position or velocity of a vehicle",
                                {file_, {}, {}, "ATTITUDE"},
                                "record the link of the vehicle itself"});
  return content;
}

Result<LogContent> Mapper::run(Reading mode) {
  TlogRecord record;
  while (reader_.next(record)) {
    if (mode == Reading::strict && reader_.skipped_bytes() > 0) break;
    count(record);
    take(record);
  }
  if (reader_.frames() == 0)
    return fail(Kind::not_a_log, "no MAVLink frame with a right checksum behind a time of 8 bytes", {file_, 0, {}, {}},
                "is it a .tlog of a ground station?");
  auto content = finish();
  if (mode == Reading::strict)
    for (const auto& problem : content.problems)
      if (problem.kind == Kind::damaged || problem.kind == Kind::truncated) return fail(problem);
  return content;
}

}  // namespace

bool looks_like_tlog(Bytes head) {
  // Frames of a foreign dialect may stand first; garbage may not.
  TlogReader reader(head);
  TlogRecord record;
  return reader.next(record) && reader.skipped_bytes() == 0;
}

Result<LogContent> read_mavlink(Bytes bytes, const std::string& file_name, const MavlinkReadSettings& settings) {
  return Mapper(bytes, file_name, settings.system).run(settings.mode);
}

}  // namespace quadsonde::ingest

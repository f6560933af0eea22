#include "ingest/dataflash/flight_from_dataflash.h"

#include <fmt/format.h>

#include "ingest/dataflash/dataflash_boot.h"
#include "ingest/dataflash/dataflash_reader.h"
#include "ingest/dataflash/dataflash_table.h"

namespace quadsonde::ingest {
namespace {

using dataflash::Binding;
using dataflash::Boot;
using dataflash::Row;

constexpr std::int64_t second_ns = 1'000'000'000;
// Messages of different types stand nearly in order of time; more than this is a jump that needs a second witness.
constexpr std::int64_t most_back_ns = 5 * second_ns, most_ahead_ns = 10 * second_ns;
constexpr int witnesses = 12;
// No log restarts more often; garbage must not make a flight of every few messages.
constexpr std::size_t most_boots = 256;
// Beyond 30 years since boot a time is garbage (and would not fit nanoseconds).
constexpr std::int64_t most_time_ns = 946'080'000 * second_ns;

class Mapper {
 public:
  Mapper(Bytes bytes, std::string file) : reader_(bytes), file_(std::move(file)) { boots_.emplace_back(); }

  Result<LogContent> run(Reading mode);

 private:
  const Binding& binding(const DataflashMessage& message);
  std::optional<std::int64_t> time_ns(const Binding& row, const DataflashMessage& message) const;
  bool in_time(std::int64_t t) const {
    return last_ns_ < 0 || (t > last_ns_ - most_back_ns && t < last_ns_ + most_ahead_ns);
  }
  bool confirmed(std::int64_t t);
  void take(const DataflashMessage& message);
  void note_losses(LogContent& content) const;
  LogContent finish();

  DataflashReader reader_;
  std::string file_;
  std::array<Binding, 256> bindings_;
  std::vector<Boot> boots_;
  std::int64_t last_ns_ = -1;
};

const Binding& Mapper::binding(const DataflashMessage& message) {
  auto& binding = bindings_[message.layout->type];
  if (binding.layout_generation != message.layout->generation) binding = dataflash::bind(*message.layout);
  return binding;
}

std::optional<std::int64_t> Mapper::time_ns(const Binding& row, const DataflashMessage& message) const {
  if (row.time == nullptr) return std::nullopt;
  const auto raw = message.integer(*row.time);
  const auto unit = static_cast<std::int64_t>(row.time_unit_ns);
  if (raw < 0 || raw > most_time_ns / unit) return std::nullopt;
  return raw * unit;
}

/// Whether the messages that follow believe in a jump of time: half of them are not before it, and, after a jump
/// back, not where the old boot would go on. The last message of a file may be up to an hour late (disarmed logging).
bool Mapper::confirmed(std::int64_t t) {
  const bool back = t < last_ns_;
  int agree = 0, timed = 0;
  std::size_t at = reader_.at();
  for (int i = 0; i < 8 * witnesses && timed < witnesses; ++i) {
    DataflashMessage message;
    const auto end = reader_.peek(at, message);
    if (!end) break;
    at = *end;
    const auto other = time_ns(binding(message), message);
    if (!other) continue;
    ++timed;
    if (*other > t - most_back_ns && (!back || *other < last_ns_ - most_back_ns)) ++agree;
  }
  if (timed == 0) return !back && t < last_ns_ + 3600 * second_ns;
  return 2 * agree >= timed;
}

void Mapper::take(const DataflashMessage& message) {
  const auto& row = binding(message);
  if (row.row == Row::none) return;
  auto t = time_ns(row, message);
  if (message.suspect || (row.time != nullptr && !t)) return boots_.back().reject(message);
  if (t && !in_time(*t)) {
    if (!confirmed(*t)) return boots_.back().reject(message);
    if (*t < last_ns_) {
      if (boots_.size() == most_boots) return boots_.back().reject(message);
      Boot next;
      next.inherit(boots_.back());
      boots_.push_back(std::move(next));
    }
    last_ns_ = *t;
  }
  // Parameters and texts of old logs have no time of their own.
  if (!t)
    t = std::max<std::int64_t>(last_ns_, 0);
  else
    last_ns_ = std::max(last_ns_, *t);
  boots_.back().take(row, message, LogTime{*t});
}

void Mapper::note_losses(LogContent& content) const {
  std::uint64_t told = 0;
  for (const auto& loss : reader_.first_losses()) {
    told += loss.bytes;
    content.problems.push_back({Kind::damaged,
                                fmt::format("{} bytes belong to no message and were skipped", loss.bytes),
                                {file_, loss.at, {}, {}},
                                "the messages around them are used"});
  }
  if (reader_.skipped_bytes() > told)
    content.problems.push_back(
        {Kind::damaged,
         fmt::format("{} more bytes in {} places belong to no message", reader_.skipped_bytes() - told,
                     reader_.losses() - reader_.first_losses().size()),
         {file_, {}, {}, {}},
         "the messages around them are used"});
  if (reader_.trailing_partial_bytes() > 0)
    content.problems.push_back({Kind::truncated,
                                fmt::format("the file ends {} bytes into a message", reader_.trailing_partial_bytes()),
                                {file_, reader_.at() - reader_.trailing_partial_bytes(), {}, {}},
                                "everything before it is used"});
}

LogContent Mapper::finish() {
  LogContent content;
  content.format = "dataflash";
  content.messages = reader_.messages();
  content.salvaged = reader_.salvaged();
  for (const auto& topic : reader_.topics())
    if (topic.messages > 0) content.topics.push_back(topic);
  note_losses(content);
  for (auto& boot : boots_) {
    if (boot.is_px4_log()) {
      content.problems.push_back({Kind::unsupported,
                                  "this is PX4's old log (.px4log) in the DataFlash container",
                                  {file_, {}, {}, "ATT"},
                                  "convert it to ULog with PX4's tools"});
      return content;
    }
    if (boot.has_data()) content.flights.push_back(std::move(boot).finish(file_, content.details));
  }
  if (content.flights.empty())
    content.problems.push_back({Kind::missing,
                                "no attitude, position or velocity in any message",
                                {file_, {}, {}, "ATT"},
                                "let the vehicle log ATT and GPS (LOG_BITMASK)"});
  return content;
}

Result<LogContent> Mapper::run(Reading mode) {
  DataflashMessage message;
  while (reader_.next(message)) {
    if (mode == Reading::strict && reader_.losses() > 0) break;
    take(message);
  }
  if (reader_.messages() == 0)
    return fail(Kind::not_a_log, "no DataFlash message: expected A3 95 80 and a format message", {file_, 0, {}, {}},
                "is it an ArduPilot .bin log?");
  auto content = finish();
  if (mode == Reading::strict) {
    if (!content.problems.empty()) return fail(content.problems.front());
    for (const auto& flight : content.flights)
      for (const auto& problem : flight.problems)
        if (problem.kind == Kind::damaged) return fail(problem);
  }
  return content;
}

}  // namespace

bool looks_like_dataflash(Bytes head) {
  constexpr std::size_t searched = 65536;
  head = head.first(std::min(head.size(), searched));
  DataflashReader reader(head);
  DataflashMessage message;
  return reader.peek(0, message).has_value() && message.layout->name == "FMT";
}

Result<LogContent> read_dataflash(Bytes bytes, const std::string& file_name, const DataflashReadSettings& settings) {
  return Mapper(bytes, file_name).run(settings.mode);
}

}  // namespace quadsonde::ingest

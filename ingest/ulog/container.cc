#include "ingest/ulog/container.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "ingest/ulog/format.h"

namespace quadsonde::ingest::ulog {
namespace {

constexpr std::size_t head_size = 3;  // size u16, type u8
constexpr std::array<std::uint8_t, 11> sync_message = {8, 0, 'S', 0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12};
/// So many messages in a row do not come about by chance (each has a known type and a known id and length).
constexpr int sound_run = 4;
constexpr std::size_t max_problems = 50;

bool known_type(std::uint8_t type) {
  return std::string_view("BFIMPQARDLCSO").find(static_cast<char>(type)) != std::string_view::npos;
}

/// A message head at an offset, if its three bytes are there.
struct Head {
  std::uint16_t size = 0;
  std::uint8_t type = 0;
};

class Reader {
 public:
  Reader(Bytes bytes, const std::string& file, const Settings& settings) : settings_(settings) {
    log_.bytes = bytes;
    log_.file = file;
  }

  Result<Log> run() {
    if (!read_header()) return fail(std::move(*fatal_));
    // Each run of appended data begins where the flag bits say; the message before it may be cut.
    std::size_t from = 16;
    read_flag_bits(from);
    for (std::size_t i = 0; i < ends_.size() && !fatal_; ++i) {
      read_run(from, ends_[i], i + 1 == ends_.size());
      from = ends_[i];
    }
    if (fatal_) return fail(std::move(*fatal_));
    return std::move(log_);
  }

 private:
  Where where(std::uint64_t at, std::string topic = {}) const { return {log_.file, at, {}, std::move(topic)}; }

  /// Keeps a Problem; in strict mode it ends the reading.
  void report(Kind kind, std::string what, std::uint64_t at, std::string hint = {}, std::string topic = {}) {
    Problem problem{kind, std::move(what), where(at, std::move(topic)), std::move(hint)};
    if (settings_.mode == Reading::strict && !fatal_) fatal_ = problem;
    if (log_.problems.size() < max_problems) log_.problems.push_back(std::move(problem));
  }
  void refuse(Kind kind, std::string what, std::uint64_t at, std::string hint) {
    fatal_ = Problem{kind, std::move(what), where(at), std::move(hint)};
  }

  bool read_header() {
    const auto& b = log_.bytes;
    if (b.size() < sizeof(magic) || !std::equal(std::begin(magic), std::end(magic), b.begin())) {
      refuse(Kind::not_a_log, "not a ULog: the file does not begin with its magic bytes", 0, "give a PX4 .ulg file");
      return false;
    }
    if (b.size() < 16) {
      refuse(Kind::truncated, fmt::format("the file ends inside the 16-byte header (it has {} bytes)", b.size()),
             b.size(), "copy the log from the vehicle again");
      return false;
    }
    log_.version = b[7];
    log_.start_us = load<std::uint64_t>(b.data() + 8);
    if (log_.version > 1)
      report(Kind::doubtful,
             fmt::format("ULog version {} is newer than the versions 0 and 1 that are known", log_.version), 7,
             "what is known of it is read");
    return !fatal_;
  }

  void read_flag_bits(std::size_t& from) {
    const auto& b = log_.bytes;
    ends_ = {b.size()};
    Head head;
    if (!head_at(from, b.size(), head) || head.type != 'B') return;  // writers before 2017 have none
    if (head.size < 40 || b.size() - from - head_size < head.size) return;
    const auto* flags = b.data() + from + head_size;
    const auto* incompatible = flags + 8;
    const bool unknown =
        (incompatible[0] & ~1) != 0 || std::any_of(incompatible + 1, incompatible + 8, [](auto f) { return f != 0; });
    if (unknown)
      return refuse(Kind::unsupported, "the log uses an incompatible ULog extension that is not known here", from,
                    "convert it with the newest PX4 tools to a plain ULog");
    const auto end_of_flags = from + head_size + head.size;
    from = end_of_flags;
    if (!(incompatible[0] & 1)) return;
    std::size_t before = end_of_flags;
    std::vector<std::size_t> ends;
    for (int i = 0; i < 3; ++i) {
      const auto offset = load<std::uint64_t>(flags + 16 + 8 * i);
      if (offset == 0) continue;
      if (offset < before || offset > b.size()) {
        report(Kind::damaged,
               fmt::format("appended data should begin at byte {}, which is not inside the file", offset),
               end_of_flags - head.size + 16, "the rest is read");
        continue;
      }
      before = static_cast<std::size_t>(offset);
      ends.push_back(before);
    }
    log_.appended = ends.size();
    ends.push_back(b.size());
    ends_ = std::move(ends);
  }

  bool head_at(std::size_t at, std::size_t end, Head& head) const {
    if (end - at < head_size) return false;
    head.size = load<std::uint16_t>(log_.bytes.data() + at);
    head.type = log_.bytes[at + 2];
    return true;
  }

  /// Index of the topic that an id stands for; -1 if none has announced it.
  std::int32_t topic_of(std::uint16_t id) const { return id < topic_of_id_.size() ? topic_of_id_[id] : -1; }

  /// Is there a message of a known type, and a data message of a known id, that fits before `end`?
  bool sound_at(std::size_t at, std::size_t end) const {
    if (at == end) return true;
    Head head;
    if (!head_at(at, end, head) || !known_type(head.type) || end - at - head_size < head.size) return false;
    if (head.type != 'D') return true;
    return head.size >= 2 && topic_of(load<std::uint16_t>(log_.bytes.data() + at + head_size)) >= 0;
  }

  /// Do the next messages lead to one that does not come about by chance: announced data, a sync, the very end?
  bool leads_on(std::size_t at, std::size_t end) const {
    for (int i = 0; i < 8; ++i) {
      if (at == end) return true;
      Head head;
      if (!head_at(at, end, head) || !known_type(head.type) || end - at - head_size < head.size) return false;
      if (head.type == 'S' || (head.type == 'D' && sound_at(at, end))) return true;
      at += head_size + head.size;
    }
    return false;
  }

  /// A head whose message may have been cut by the end of the file.
  bool plausible(const Head& head, std::size_t at, std::size_t end) const {
    if (head.type != 'D' || end - at < head_size + 2) return known_type(head.type);
    return topic_of(load<std::uint16_t>(log_.bytes.data() + at + head_size)) >= 0;
  }

  void read_run(std::size_t at, std::size_t end, bool last_run) {
    std::size_t before = at;  // start of the message before this one
    while (at < end && !fatal_) {
      Head head;
      if (!head_at(at, end, head) || end - at - head_size < head.size) {
        // Either the log was cut here, or the message before was and this head is part of something else.
        const bool nonsense = end - at >= head_size && !plausible(head, at, end);
        if (nonsense) drop_message_before(at);
        if (resume(at, end, nonsense ? before : at)) {
          before = at;
          continue;
        }
        if (last_run && !fatal_)
          report(Kind::truncated,
                 fmt::format("the log ends in the middle of a message; its last {} bytes are lost", end - at), at,
                 "everything before is used");
        return;
      }
      const auto next = at + head_size + head.size;
      if (!take(head, log_.bytes.subspan(at + head_size, head.size), at)) {
        // A message that means nothing here is skipped when sound ones follow; else the structure is lost.
        if (leads_on(next, end)) {
          report_odd(head, at);
        } else {
          drop_message_before(at);
          if (!resume(at, end, before)) {
            if (!fatal_) report_lost(at, end);
            return;
          }
          before = at;
          continue;
        }
      }
      before = at;
      at = next;
    }
  }

  /// The message that ends where nonsense begins was cut itself: its tail belongs to something else.
  void drop_message_before(std::size_t at) {
    if (last_topic_ < 0 || last_end_ != at) return;
    auto& topic = log_.topics[static_cast<std::size_t>(last_topic_)];
    if (!topic.payload_at.empty() && topic.payload_at.back() == last_payload_) topic.payload_at.pop_back();
    --topic.messages;
    --log_.data_messages;
    if (lost_) --log_.salvaged;
    last_topic_ = -1;
  }

  /// Moves `at` to the next place where reading can go on; false if there is none.
  bool resume(std::size_t& at, std::size_t end, std::size_t search_from) {
    if (settings_.mode == Reading::strict) return false;
    const auto place = next_sound(search_from + 1, end);
    if (!place) return false;
    const auto skipped = *place - search_from;
    report(Kind::damaged, fmt::format("the structure of the log is lost; {} bytes are given up", skipped), at,
           fmt::format("reading went on at byte {}", *place));
    log_.given_up += skipped;
    lost_ = true;
    at = *place;
    return true;
  }

  void report_lost(std::size_t at, std::size_t end) {
    log_.given_up += end - at;
    report(Kind::damaged, fmt::format("the structure of the log is lost; its last {} bytes are given up", end - at), at,
           settings_.mode == Reading::salvage ? "everything before is used"
                                              : "convert --recover searches for more behind it");
  }

  std::optional<std::size_t> next_sound(std::size_t from, std::size_t end) {
    if (!next_sync_ || *next_sync_ < from || *next_sync_ > end) {
      const auto* data = log_.bytes.data();
      const auto* sync = std::search(data + std::min(from, end), data + end, sync_message.begin(), sync_message.end());
      next_sync_ = static_cast<std::size_t>(sync - data);
    }
    if (settings_.mode == Reading::salvage)
      for (std::size_t at = from; at < *next_sync_; ++at)
        if (run_at(at, end)) return at;
    return *next_sync_ == end ? std::nullopt : next_sync_;
  }

  /// Do several sound messages, data of the right length among them, follow each other from here?
  bool run_at(std::size_t at, std::size_t end) const {
    for (int i = 0; i < sound_run; ++i) {
      Head head;
      if (!sound_at(at, end) || !head_at(at, end, head) || head.type != 'D') return false;
      const auto id = load<std::uint16_t>(log_.bytes.data() + at + head_size);
      const auto& size = usual_size_[static_cast<std::size_t>(topic_of(id))];
      if (size != 0 && size != head.size) return false;
      at += head_size + head.size;
    }
    return true;
  }

  void report_odd(const Head& head, std::size_t at) {
    if (head.type == 'D') {
      const auto id = head.size >= 2 ? load<std::uint16_t>(log_.bytes.data() + at + head_size) : 0;
      if (!reported_ids_.insert(id).second) return;
      report(Kind::damaged, fmt::format("data of id {} that no topic has announced", id), at, "it is left out");
    } else if (known_type(head.type)) {
      report(Kind::damaged,
             fmt::format("a message of type {} contradicts its own lengths", static_cast<char>(head.type)), at,
             "it is left out");
    }
    // Types that are not known are skipped silently: the format may grow.
  }

  /// Takes one message; false if it makes no sense.
  bool take(const Head& head, Bytes body, std::size_t at) {
    switch (head.type) {
      case 'D':
        return take_data(body, at);
      case 'F':
        return take_format(body);
      case 'I':
        return take_info(body);
      case 'M':
        return take_info_multi(body);
      case 'P':
        return take_parameter(body, at, in_data_ ? log_.parameter_changes : log_.parameters);
      case 'Q':
        return body.size() > 1 && take_parameter(body.subspan(1), at, log_.parameter_defaults);
      case 'A':
        return take_subscription(body);
      case 'R':
        return body.size() >= 2;  // an id is not used again for another topic before its new A
      case 'L':
        return take_text(body, false);
      case 'C':
        return take_text(body, true);
      case 'S':
        return body.size() == 8;
      case 'O':
        return take_dropout(body);
      case 'B':
        return true;
      default:
        return false;
    }
  }

  bool take_data(Bytes body, std::size_t at) {
    if (body.size() < 2) return false;
    const auto index = topic_of(load<std::uint16_t>(body.data()));
    if (index < 0) return false;
    const auto i = static_cast<std::size_t>(index);
    auto& topic = log_.topics[i];
    last_topic_ = index;
    last_payload_ = at + head_size + 2;
    last_end_ = at + head_size + body.size();
    if (kept_[i]) topic.payload_at.push_back(last_payload_);
    usual_size_[i] = static_cast<std::uint16_t>(body.size());
    ++topic.messages;
    ++log_.data_messages;
    if (lost_) ++log_.salvaged;
    return true;
  }

  bool take_format(Bytes body) {
    auto format = parse_format(as_text(body));
    if (!format) return false;
    log_.formats.emplace(format->name, std::move(*format));
    return true;
  }

  static bool split_key(Bytes body, std::string& type, std::string& name, Bytes& value) {
    if (body.empty() || body.size() - 1 < body[0]) return false;
    const auto key = as_text(body.subspan(1, body[0]));
    const auto blank = key.find(' ');
    if (blank == std::string_view::npos) return false;
    type = std::string(key.substr(0, blank));
    name = std::string(key.substr(blank + 1));
    value = body.subspan(1 + std::size_t{body[0]});
    return true;
  }

  bool take_info(Bytes body) {
    std::string type, name;
    Bytes value;
    if (!split_key(body, type, name, value)) return false;
    log_.info[name] = {type, std::string(as_text(value))};
    return true;
  }

  bool take_info_multi(Bytes body) {
    std::string type, name;
    Bytes value;
    if (body.empty() || !split_key(body.subspan(1), type, name, value)) return false;
    auto& all = log_.info_multi;
    if (body[0] != 0 && !all.empty() && all.back().first == name)
      all.back().second += as_text(value);
    else
      all.emplace_back(name, std::string(as_text(value)));
    return true;
  }

  bool take_parameter(Bytes body, std::size_t at, std::vector<Parameter>& to) {
    Parameter parameter;
    Bytes value;
    if (!split_key(body, parameter.value.type, parameter.name, value)) return false;
    parameter.value.bytes = std::string(as_text(value));
    parameter.at = at;
    if (!parameter.value.number()) return false;
    to.push_back(std::move(parameter));
    return true;
  }

  bool take_subscription(Bytes body) {
    if (body.size() < 4) return false;
    in_data_ = true;
    const auto id = load<std::uint16_t>(body.data() + 1);
    const auto name = as_text(body.subspan(3));
    const auto [found, added] = topic_index_.try_emplace({std::string(name), body[0]}, log_.topics.size());
    if (topic_of_id_.size() <= id) topic_of_id_.resize(id + 1U, -1);
    topic_of_id_[id] = static_cast<std::int32_t>(found->second);
    if (!added) return true;
    log_.topics.push_back({std::string(name), body[0], 0, {}});
    kept_.push_back(!settings_.keep || settings_.keep(name));
    usual_size_.push_back(0);
    return true;
  }

  bool take_text(Bytes body, bool tagged) {
    Cursor cursor(body);
    Text text;
    std::uint8_t level = 0;
    std::uint16_t tag = 0;
    if (!cursor.get(level) || (tagged && !cursor.get(tag)) || !cursor.get(text.timestamp_us)) return false;
    in_data_ = true;
    text.level = static_cast<char>(level);
    if (tagged) text.tag = tag;
    text.text = std::string(as_text(body.subspan(cursor.at())));
    log_.texts.push_back(std::move(text));
    return true;
  }

  bool take_dropout(Bytes body) {
    if (body.size() < 2) return false;
    Dropout dropout{load<std::uint16_t>(body.data()), 0, 0};
    if (last_topic_ >= 0) {
      dropout.after_payload_at = last_payload_;
      dropout.after_topic = static_cast<std::size_t>(last_topic_);
    }
    log_.dropouts.push_back(dropout);
    return true;
  }

  const Settings& settings_;
  Log log_;
  std::vector<std::size_t> ends_;          // end of each run of messages
  std::vector<std::int32_t> topic_of_id_;  // index into log_.topics, -1 = not announced
  std::vector<bool> kept_;                 // per topic
  std::vector<std::uint16_t> usual_size_;  // per topic: length of its last message with the id, 0 = none yet
  std::set<unsigned> reported_ids_;        // ids without a topic that were told of
  std::map<std::pair<std::string, std::uint8_t>, std::size_t> topic_index_;
  std::optional<std::size_t> next_sync_;  // the last sync message searched for; the run's end if there was none
  std::optional<Problem> fatal_;
  std::int32_t last_topic_ = -1;  // of the last data message
  std::uint64_t last_payload_ = 0, last_end_ = 0;
  bool in_data_ = false;  // behind the definitions
  bool lost_ = false;     // behind lost structure
};

}  // namespace

Result<Log> read(Bytes bytes, const std::string& file, const Settings& settings) {
  return Reader(bytes, file, settings).run();
}

}  // namespace quadsonde::ingest::ulog

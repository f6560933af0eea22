#include "ingest/paparazzi/flight_from_paparazzi.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "ingest/paparazzi/paparazzi_aircraft.h"
#include "ingest/paparazzi/paparazzi_reader.h"

namespace quadsonde::ingest {
namespace {

using paparazzi::Aircraft;
using paparazzi::Binding;
using paparazzi::Row;

/// What one message name came to in the file.
struct Topic {
  Binding binding;
  std::uint64_t lines = 0, misfits = 0, first_misfit = 0;
  std::size_t order = 0;
};

class Mapper {
 public:
  Mapper(Bytes data, std::optional<Bytes> log, std::string file)
      : reader_(data), has_log_(log.has_value()), file_(std::move(file)) {
    if (log) definitions_ = PaparazziDefinitions::scan(*log);
  }

  Result<LogContent> run(const PaparazziReadSettings& settings);

 private:
  Topic& topic(std::string_view name);
  void take(const PaparazziLine& line);
  std::string choose(const std::string& wanted) const;
  void note_damage(LogContent& content) const;
  void map(LogContent& content, const std::string& wanted);

  PaparazziLineReader reader_;
  PaparazziDefinitions definitions_;
  bool has_log_;
  std::string file_;
  std::map<std::string, Topic, std::less<>> topics_;
  std::map<std::string, Aircraft, std::less<>> aircraft_;
  std::map<std::string, std::uint64_t, std::less<>> lines_of_;
  std::vector<std::string_view> values_;
};

Topic& Mapper::topic(std::string_view name) {
  const auto found = topics_.find(name);
  if (found != topics_.end()) return found->second;
  auto& topic = topics_[std::string(name)];
  topic.order = topics_.size();
  if (const auto* definition = definitions_.find(name)) topic.binding = paparazzi::bind(*definition);
  return topic;
}

void Mapper::take(const PaparazziLine& line) {
  auto& topic = this->topic(line.name);
  ++topic.lines;
  auto lines = lines_of_.find(line.aircraft);
  if (lines == lines_of_.end()) lines = lines_of_.emplace(std::string(line.aircraft), 0).first;
  ++lines->second;
  const auto& row = topic.binding;
  if (row.row == Row::none || !row.complete) return;
  split_paparazzi_values(line.values, values_);
  if (values_.size() != row.values) {
    if (topic.misfits++ == 0) topic.first_misfit = line.line;
    return;
  }
  aircraft_[lines->first].take(row, values_, line.time);
}

/// The aircraft asked for, else the one with the most lines.
std::string Mapper::choose(const std::string& wanted) const {
  if (!wanted.empty()) return wanted;
  std::string best;
  std::uint64_t most = 0;
  for (const auto& [id, lines] : lines_of_) {
    if (lines <= most) continue;
    most = lines;
    best = id;
  }
  return best;
}

void Mapper::note_damage(LogContent& content) const {
  if (reader_.unparsable() > 0)
    content.problems.push_back(
        {Kind::damaged,
         fmt::format("{} lines are no messages; expected: seconds aircraft MESSAGE values", reader_.unparsable()),
         {file_, {}, reader_.first_unparsable(), {}},
         "the other lines are used"});
  if (reader_.trailing_partial_bytes() > 0)
    content.problems.push_back(
        {Kind::truncated,
         fmt::format("the last line ({} bytes) has no end and was left out", reader_.trailing_partial_bytes()),
         {file_, {}, {}, {}},
         "everything before it is used"});
  for (const auto& [name, topic] : topics_)
    if (topic.misfits > 0)
      content.problems.push_back({Kind::damaged,
                                  fmt::format("{} of {} lines do not have the {} values that the .log defines",
                                              topic.misfits, topic.lines, topic.binding.values),
                                  {file_, {}, topic.first_misfit, name},
                                  "is the .log of the same flight?"});
}

void Mapper::map(LogContent& content, const std::string& wanted) {
  const auto id = choose(wanted);
  content.details.emplace_back("aircraft used", id);
  if (lines_of_.size() > 1 && wanted.empty())
    content.problems.push_back(
        {Kind::doubtful,
         fmt::format("{} aircraft share the file; {} has the most lines and is used", lines_of_.size(), id),
         {file_, {}, {}, {}},
         "name the aircraft if you want another"});
  if (const auto found = aircraft_.find(id); found != aircraft_.end() && found->second.has_data())
    content.flights.push_back(std::move(found->second).finish(definitions_, id, file_));
  else
    content.problems.push_back({Kind::missing,
                                fmt::format("no message of aircraft {} tells attitude, position or velocity", id),
                                {file_, {}, {}, {}},
                                "ROTORCRAFT_FP or ATTITUDE and GPS_INT are needed"});
}

Result<LogContent> Mapper::run(const PaparazziReadSettings& settings) {
  PaparazziLine line;
  while (reader_.next(line)) take(line);
  if (reader_.lines() == 0)
    return fail(Kind::not_a_log, "no line is a message; expected: seconds aircraft MESSAGE values", {file_, {}, 1, {}},
                "is it a Paparazzi .data file?");
  LogContent content;
  content.format = "paparazzi";
  content.messages = reader_.lines();
  content.topics.resize(topics_.size());
  for (const auto& [name, topic] : topics_) content.topics[topic.order - 1] = {name, topic.lines};
  for (const auto& [id, lines] : lines_of_)
    content.details.emplace_back("aircraft " + id, fmt::format("{} lines", lines));
  note_damage(content);
  if (!has_log_) {
    content.problems.push_back({Kind::missing,
                                "a .data file alone does not say what its values mean: the .log is needed",
                                {file_, {}, {}, {}},
                                "put the .log of the same name beside it"});
  } else if (definitions_.size() == 0) {
    content.problems.push_back({Kind::damaged,
                                "the .log defines no message",
                                {file_, {}, {}, {}},
                                "is it the .log of this flight, with its <protocol> part?"});
  } else {
    map(content, settings.aircraft);
  }
  if (settings.mode == Reading::strict)
    for (const auto& problem : content.problems)
      if (problem.kind == Kind::damaged || problem.kind == Kind::truncated) return fail(problem);
  return content;
}

}  // namespace

bool looks_like_paparazzi_data(Bytes head) {
  constexpr std::size_t searched = 4096;
  PaparazziLineReader reader(head.first(std::min(head.size(), searched)));
  PaparazziLine line;
  while (reader.next(line)) {
  }
  return reader.lines() >= 1 && reader.lines() > 4 * reader.unparsable();
}

Result<LogContent> read_paparazzi(Bytes data, std::optional<Bytes> log, const std::string& file_name,
                                  const PaparazziReadSettings& settings) {
  return Mapper(data, log, file_name).run(settings);
}

}  // namespace quadsonde::ingest

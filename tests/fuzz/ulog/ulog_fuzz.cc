#include "ingest/ulog/container.h"
#include "ingest/ulog/flight_from_ulog.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

namespace {

/// Every field of every kept message can be asked for.
void walk(ingest::Bytes bytes, ingest::Reading mode) {
  ingest::ulog::Settings settings;
  settings.mode = mode;
  const auto log = ingest::ulog::read(bytes, "fuzz.ulg", settings);
  if (!log) return fuzz::require(!log.error().what.empty());
  std::uint64_t messages = 0;
  for (const auto& topic : log->topics) {
    fuzz::require(topic.payload_at.size() == topic.messages);
    messages += topic.messages;
    const auto format = log->formats.find(topic.name);
    if (format == log->formats.end() || format->second.fields.size() > 64) continue;
    for (const auto& field : format->second.fields) {
      const auto path = field.array ? field.name + "[0]" : field.name;
      const auto column = ingest::ulog::find_column(log->formats, topic.name, path);
      for (std::size_t i = 0; column && i < topic.payload_at.size(); ++i) {
        (void)ingest::ulog::number(log->payload(topic, i), *column);
        (void)ingest::ulog::integer(log->payload(topic, i), *column);
      }
    }
  }
  fuzz::require(messages == log->data_messages && log->given_up <= bytes.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ingest::Bytes bytes(data, size);
  for (const auto mode : {ingest::Reading::strict, ingest::Reading::tolerant, ingest::Reading::salvage}) {
    walk(bytes, mode);
    auto content = ingest::read_ulog(bytes, "fuzz.ulg", {mode});
    if (content)
      for (auto& flight : content->flights) ingest::tidy(flight);
    fuzz::require_sound(content, size);
  }
  return 0;
}

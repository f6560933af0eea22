#include "ingest/mcap/registry.h"

#include <algorithm>

namespace quadsonde::ingest::mcap {
bool matches(const KnownSchema& known, const Schema& schema) {
  return known.name == schema.name && known.encoding == schema.encoding && std::ranges::equal(known.data, schema.data);
}

bool matches(const KnownChannel& known, const Channel& channel) {
  return known.schema_id == channel.schema_id && known.topic == channel.topic &&
         known.message_encoding == channel.message_encoding &&
         std::ranges::equal(known.metadata, channel.metadata, [](const auto& a, const auto& b) {
           return a.first == b.first && a.second == b.second;
         });
}

namespace {

KnownSchema keep(const Schema& schema, bool sound) {
  return {std::string(schema.name), std::string(schema.encoding), {schema.data.begin(), schema.data.end()}, sound};
}

KnownChannel keep(const Channel& channel, bool sound) {
  KnownChannel known{channel.schema_id, std::string(channel.topic), std::string(channel.message_encoding), {}, sound};
  for (const auto& [key, value] : channel.metadata) known.metadata.emplace_back(key, value);
  return known;
}

/// Adds, compares or replaces one record in one of the two maps.
template <class Map, class Record>
Registry::Added add_to(Map& map, const Record& record, bool sound) {
  const auto found = map.find(record.id);
  if (found == map.end()) {
    map.emplace(record.id, keep(record, sound));
    return Registry::Added::fresh;
  }
  if (matches(found->second, record)) {
    found->second.sound = found->second.sound || sound;
    return Registry::Added::same;
  }
  if (found->second.sound || !sound) return Registry::Added::differs;
  found->second = keep(record, sound);
  return Registry::Added::fresh;
}

}  // namespace

Registry::Added Registry::add(const Schema& schema, bool sound) {
  const auto size = schema.name.size() + schema.encoding.size() + schema.data.size();
  if (schema.id == 0 || bytes_ + size > kMaxBytes) return Added::refused;
  const auto added = add_to(schemas_, schema, sound);
  if (added == Added::fresh) bytes_ += size;
  return added;
}

Registry::Added Registry::add(const Channel& channel, bool sound) {
  auto size = channel.topic.size() + channel.message_encoding.size();
  // A pair of empty strings takes 8 bytes in the file and some 64 here.
  for (const auto& [key, value] : channel.metadata) size += key.size() + value.size() + 64;
  if (bytes_ + size > kMaxBytes) return Added::refused;
  const auto added = add_to(channels_, channel, sound);
  if (added == Added::fresh) bytes_ += size;
  has_channel_[channel.id] = true;
  return added;
}

const KnownSchema* Registry::schema(std::uint16_t id) const {
  const auto found = schemas_.find(id);
  return found == schemas_.end() ? nullptr : &found->second;
}

const KnownChannel* Registry::channel(std::uint16_t id) const {
  const auto found = channels_.find(id);
  return found == channels_.end() ? nullptr : &found->second;
}

}  // namespace quadsonde::ingest::mcap

#pragma once
// The schemas and channels met so far, kept beyond the chunk they stood in.
#include <bitset>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "ingest/mcap/records.h"

namespace quadsonde::ingest::mcap {

struct KnownSchema {
  std::string name, encoding;
  std::vector<std::uint8_t> data;
  bool sound = true;  ///< false: from a place whose CRC failed; the next record of this id replaces it
};
struct KnownChannel {
  std::uint16_t schema_id = 0;
  std::string topic, message_encoding;
  std::vector<std::pair<std::string, std::string>> metadata;
  bool sound = true;
};

/// Whether a record says the same.
bool matches(const KnownSchema& known, const Schema& schema);
bool matches(const KnownChannel& known, const Channel& channel);

class Registry {
 public:
  enum class Added {
    fresh,
    same,
    differs,  ///< the id is taken by other content; the first one stays
    refused   ///< id 0 of a schema, or more than kMaxBytes in all
  };
  static constexpr std::uint64_t kMaxBytes = 256u << 20;

  Added add(const Schema& schema, bool sound = true);
  Added add(const Channel& channel, bool sound = true);
  bool has_channel(std::uint16_t id) const { return has_channel_[id]; }
  const KnownSchema* schema(std::uint16_t id) const;
  const KnownChannel* channel(std::uint16_t id) const;
  const std::map<std::uint16_t, KnownSchema>& schemas() const { return schemas_; }
  const std::map<std::uint16_t, KnownChannel>& channels() const { return channels_; }

 private:
  std::map<std::uint16_t, KnownSchema> schemas_;
  std::map<std::uint16_t, KnownChannel> channels_;
  std::bitset<65536> has_channel_;
  std::uint64_t bytes_ = 0;
};

}  // namespace quadsonde::ingest::mcap

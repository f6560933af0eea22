#pragma once
// MCAP topics to Flight: our own messages, Foxglove's, ROS 2's and JSON, found by their schemas.
#include <optional>
#include <string>
#include <string_view>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"
#include "ingest/mcap/topic_map.h"

namespace quadsonde::ingest {

struct McapReadSettings {
  Reading mode = Reading::tolerant;
  bool check_crc = true;           ///< false: CRCs are not computed (for logs known to carry wrong ones)
  std::optional<TopicMap> topics;  ///< the user's word on what the streams of a foreign log are; empty: by schema
  std::uint64_t max_chunk = 256u << 20;  ///< larger uncompressed chunks are refused (decompression bombs) [bytes]
};

/// True if the bytes begin like an MCAP file.
bool looks_like_mcap(Bytes head);

/// The flight of an MCAP log. A file without a flight in it gives its topics with message counts and no flights.
/// The log clock is the one in the metadata record `quadsonde.clock` where the file is ours, so that a log and its
/// MCAP have the same LogTimes to the nanosecond; in foreign files it is MCAP's log_time.
/// In tolerant mode a chunk whose CRC fails is dropped; in salvage mode its plausible messages are kept and counted
/// in LogContent::salvaged. Whole messages of a cut last chunk are kept, and counted there, in both.
/// @param file_name  for messages only; nothing is opened
/// @return fails with not_a_log if the bytes are no MCAP; in strict mode also with the first damage
Result<LogContent> read_mcap(Bytes bytes, const std::string& file_name, const McapReadSettings& settings = {});

/// The true wind that a simulator wrote beside its flight, on the log clock of read_mcap; empty if there is none.
Result<Truth> read_truth(Bytes bytes, const std::string& file_name);

}  // namespace quadsonde::ingest

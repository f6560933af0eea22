#pragma once
// A clean file out of a damaged one.
#include "ingest/flight/problem.h"
#include "ingest/mcap/reader.h"
#include "ingest/mcap/sink.h"
#include "ingest/mcap/writer.h"

namespace quadsonde::ingest::mcap {

struct Recovered {
  ReadCounts counts;  ///< messages that came out, those of them that nothing vouches for, those known to be lost
  std::uint64_t attachments = 0, metadata = 0;
  std::vector<Problem> problems;  ///< what was wrong, in the order met
};

struct RecoverSettings {
  std::string file_name;     ///< for Problems only
  bool check_crc = true;
  std::uint64_t max_chunk = 256u << 20;  ///< larger uncompressed chunks are refused [bytes]
  WriterSettings writing{};  ///< profile and library are taken from the damaged file where it still tells them
};

/// Copies all that salvage reading gives (schemas, channels, messages, attachments, metadata) into a new file with
/// CRCs, index and summary. Channels get new ids; topics, times, sequence numbers and data stay.
/// @return fails with not_a_log if nothing in the bytes is MCAP, with write_failed if the sink fails
Result<Recovered> recover(Bytes file, Sink& sink, const RecoverSettings& settings = {});

}  // namespace quadsonde::ingest::mcap

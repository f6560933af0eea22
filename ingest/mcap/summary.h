#pragma once
// The summary at the end of an MCAP file: where its chunks, attachments and metadata are.
#include <optional>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/mcap/registry.h"

namespace quadsonde::ingest::mcap {

/// Views into the file, which must outlive it.
struct Summary {
  Registry registry;
  std::vector<ChunkIndex> chunks;  ///< in the order of the file's summary
  std::vector<AttachmentIndex> attachments;
  std::vector<MetadataIndex> metadata;
  std::optional<Statistics> statistics;
  Footer footer;
  /// Offsets at which records surely begin, ascending: chunks as the CRC of the summary vouches for them, and chunks,
  /// attachments, metadata and the end of the data where the file shows one. (Indexes are not always right: @mcap/core
  /// 2.2.1 writes false offsets of metadata into files without chunks.)
  std::vector<std::uint64_t> known_starts(Bytes file) const;
};

/// @return fails with truncated where the file has no end, with damaged where its CRC or an offset is wrong, with
///         missing where the file has an end and no summary
Result<Summary> read_summary(Bytes file, bool check_crc = true);

}  // namespace quadsonde::ingest::mcap

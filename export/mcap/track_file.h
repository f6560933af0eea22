#pragma once
// Tracks as the messages of one MCAP file, in the order of their times.
#include <cstdint>
#include <optional>
#include <vector>

#include "export/mcap/tracks.h"

namespace quadsonde::product {

/// One sample of one track.
struct TrackEntry {
  ingest::LogTime time;
  std::uint32_t track = 0, sample = 0;
};

/// All samples in the order of their times; those of one time in the order of the tracks.
/// @return fails with limit beyond 4e9 samples
ingest::Result<std::vector<TrackEntry>> merge(const std::vector<Track>& tracks);

/// What to add to a log time for an MCAP time [ns]: UTC where it is known and after 1970, else the log clock itself,
/// moved only as far as negative times need.
std::int64_t mcap_minus_log(std::optional<ingest::Duration> utc_minus_log, const std::vector<TrackEntry>& entries);

/// The writer's settings for a file of ours.
ingest::mcap::WriterSettings writer_settings(const FlightFileSettings& settings);

/// Declares a channel for each track and writes the entries.
/// @param shift        mcap_minus_log
/// @param tells_shift  every channel's metadata tell the shift: the times are those of a log's clock
ingest::Result<void> write_entries(ingest::mcap::Writer& writer, std::vector<Track>& tracks,
                                   const std::vector<TrackEntry>& entries, std::int64_t shift, bool tells_shift = true);

}  // namespace quadsonde::product

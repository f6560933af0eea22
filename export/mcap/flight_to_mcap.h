#pragma once
// A flight as a self-describing MCAP log that our reader gives back to the bit and that a viewer shows.
#include <filesystem>

#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"
#include "ingest/mcap/sink.h"

namespace quadsonde::product {

struct FlightFileSettings {
  enum class Encoding { protobuf, json };
  enum class Compression { none, lz4, zstd };
  Encoding encoding = Encoding::protobuf;
  Compression compression = Compression::zstd;
  bool viewer_topics = true;  ///< Foxglove's own schemas beside ours: /foxglove/location, pose and log
  bool overwrite = false;     ///< replace a file that is there
};

/// Writes a flight (and the true wind, where a simulator knows it) beside the target, syncs, then renames: a killed
/// run leaves the old file or the new one. MCAP log times are UTC where the clock is known, else the log's own;
/// the metadata record `quadsonde.clock` keeps the source's clock. Same flight, same bytes.
/// @return fails with usage if the target is there and overwrite is false, with write_failed if the disk says no
ingest::Result<void> write_flight(const std::filesystem::path& path, const ingest::Flight& flight,
                                  const FlightFileSettings& settings = {}, const ingest::Truth& truth = {});

/// The same into any sink.
ingest::Result<void> write_flight(ingest::mcap::Sink& sink, const ingest::Flight& flight,
                                  const FlightFileSettings& settings = {}, const ingest::Truth& truth = {});

}  // namespace quadsonde::product

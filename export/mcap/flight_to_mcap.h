#pragma once
// A flight as a self-describing MCAP log that our reader gives back to the bit and that a viewer shows, with what was
// computed from it beside it.
#include <filesystem>

#include "estimator/smoother/wind_series.h"
#include "export/csv/source.h"
#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"
#include "ingest/mcap/sink.h"
#include "profiles/profile.h"

namespace quadsonde::product {

struct FlightFileSettings {
  enum class Encoding { protobuf, json };
  enum class Compression { none, lz4, zstd };
  Encoding encoding = Encoding::protobuf;
  Compression compression = Compression::zstd;
  bool viewer_topics = true;  ///< Foxglove's own schemas beside ours: /foxglove/location, pose and log
  bool overwrite = false;     ///< replace a file that is there
};

/// What was computed from a flight, to stand in its log. What is null is left out.
struct FlightProducts {
  const estimator::WindSeries* wind = nullptr;
  const profiles::WindProfile* profile = nullptr;
  const ProductSource* source = nullptr;
};

/// Writes a flight (and the true wind, where a simulator knows it) beside the target, syncs, then renames: a killed
/// run leaves the old file or the new one. MCAP log times are UTC where the clock is known, else the log's own;
/// the metadata record `quadsonde.clock` keeps the source's clock. Same flight, same bytes.
/// @return fails with usage if the target is there and overwrite is false, with write_failed if the disk says no
ingest::Result<void> write_flight(const std::filesystem::path& path, const ingest::Flight& flight,
                                  const FlightFileSettings& settings = {}, const ingest::Truth& truth = {});

/// The same into any sink, with products in topics of their own, which no reading of the flight looks at.
ingest::Result<void> write_flight(ingest::mcap::Sink& sink, const ingest::Flight& flight,
                                  const FlightFileSettings& settings = {}, const ingest::Truth& truth = {},
                                  const FlightProducts& products = {});

}  // namespace quadsonde::product

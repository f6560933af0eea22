#pragma once
// Winds and profiles as topics.
#include <vector>

#include "export/mcap/flight_to_mcap.h"
#include "export/mcap/tracks.h"

namespace quadsonde::product {

/// Adds quadsonde.Wind in /quadsonde/wind, and quadsonde.ProfileLeg in /quadsonde/profile/up, down and all: a topic for
/// each leg, so that a viewer plots one by its name. The tracks are views into the products, which must outlive them.
/// @param start  when a profile stands in the log: at the beginning, so that a viewer has it from there on
void add_product_tracks(std::vector<Track>& tracks, const FlightProducts& products, ingest::LogTime start,
                        const FlightFileSettings& settings);

/// The metadata record `quadsonde.product`: where the numbers come from. Nothing without a source.
ingest::Result<void> write_product_metadata(ingest::mcap::Writer& writer, const FlightProducts& products);

}  // namespace quadsonde::product

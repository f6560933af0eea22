#pragma once
// The streams of a flight as topics: which messages, in which channel.
#include <google/protobuf/message.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "export/mcap/flight_to_mcap.h"
#include "ingest/flight/flight.h"
#include "ingest/mcap/writer.h"

namespace quadsonde::product {

/// One topic. `fill` puts a sample into `message`, which is clear before; the MCAP time is for schemas that repeat it.
struct Track {
  std::string topic;
  ingest::mcap::Writer::Pairs metadata;
  std::vector<ingest::LogTime> times;
  std::unique_ptr<google::protobuf::Message> message;
  std::function<void(std::size_t sample, std::uint64_t mcap_time, google::protobuf::Message& message)> fill;
  bool json = false;

  /// The message of a sample, serialised.
  void encode(std::size_t sample, std::uint64_t mcap_time, std::string& data);
};

/// Views into flight and truth, which must outlive them. Streams that are empty and have no name are left out.
std::vector<Track> tracks_of(const ingest::Flight& flight, const ingest::Truth& truth,
                             const FlightFileSettings& settings);
/// The earliest time of anything in them; 0 where nothing is.
ingest::LogTime first_time(const std::vector<Track>& tracks);
/// Foxglove's LocationFix, PoseInFrame and Log for the same flight.
std::vector<Track> viewer_tracks_of(const ingest::Flight& flight);

}  // namespace quadsonde::product

#pragma once
// Our own topics, back to the flight that they were written from.
#include "ingest/flight/truth.h"
#include "ingest/mcap/registry.h"
#include "ingest/mcap/topic_handler.h"

namespace quadsonde::ingest::own {

/// What our topics and metadata records tell, in MCAP times until apply_clock().
struct Collected {
  Flight flight;
  Truth truth;
  std::optional<std::int64_t> mcap_minus_log_ns;
  bool any = false;  ///< a topic or a clock of ours was met
};

/// A handler for a channel of ours (it also takes what the channel's metadata say), else nothing.
/// @param into  must outlive the handler
std::unique_ptr<TopicHandler> handler_for(const mcap::KnownChannel& channel, const mcap::KnownSchema* schema,
                                          Collected& into);
/// Takes one of our metadata records; false if a value in it is not what it should be.
bool take_metadata(const mcap::Metadata& record, Collected& into);
/// From MCAP times to the log clock of the source.
void apply_clock(Collected& collected);

}  // namespace quadsonde::ingest::own

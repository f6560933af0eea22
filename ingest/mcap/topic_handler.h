#pragma once
// What is done with the messages of one channel.
#include <memory>

#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

class TopicHandler {
 public:
  virtual ~TopicHandler() = default;
  /// @param time  MCAP's log_time; the clock of the source is set at the end
  /// @return false if the message cannot be decoded
  virtual bool take(LogTime time, Bytes data) = 0;
};

}  // namespace quadsonde::ingest

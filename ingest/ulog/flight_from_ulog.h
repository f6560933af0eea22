#pragma once
#include "ingest/flight/bytes.h"
#include "ingest/flight/flight.h"

namespace quadsonde::ingest {

struct UlogReadSettings {
  Reading mode = Reading::tolerant;
};

/// A PX4 ULog as a Flight: one (a ULog is one boot), or none when no topic of a flight is in it.
/// Log time is the autopilot's `timestamp` (boot time). Units SI, NED and FRD; the topics and fields relied on, with
/// the firmware that writes them, stand in ingest/ulog/topics.h. Streams are as logged: call tidy() afterwards.
/// Errors: those of ulog::read.
Result<LogContent> read_ulog(Bytes bytes, const std::string& file_name, const UlogReadSettings& settings = {});

}  // namespace quadsonde::ingest

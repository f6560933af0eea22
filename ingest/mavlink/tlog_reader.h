#pragma once
// The telemetry log of a ground station: its own time before each MAVLink frame that it heard.
#include <cstdint>
#include <optional>
#include <vector>

#include "ingest/mavlink/mavlink_frame.h"

namespace quadsonde::ingest {

struct TlogRecord {
  std::uint64_t time_us = 0;  ///< the ground station's clock, mostly Unix time, sometimes its own boot
  MavlinkFrame frame;
  std::uint64_t at = 0;   ///< byte of the record in the file
  bool salvaged = false;  ///< stands behind lost structure
};

/// Reads records one by one; steps over frames of unknown dialects where another record follows, else searches.
class TlogReader {
 public:
  explicit TlogReader(Bytes bytes) : bytes_(bytes) {}

  bool next(TlogRecord& record);
  /// Looks ahead without moving or counting. @return the byte behind the record; empty at the end
  std::optional<std::size_t> peek(std::size_t at, TlogRecord& record) const;

  std::size_t at() const { return at_; }
  std::uint64_t frames() const { return frames_; }
  std::uint64_t salvaged() const { return salvaged_; }
  std::uint64_t signed_frames() const { return signed_; }
  /// Whole frames stepped over: unknown id, wrong checksum or unknown flags.
  std::uint64_t rejected() const { return count_.rejected; }
  std::uint64_t skipped_bytes() const { return count_.skipped; }
  std::optional<std::uint64_t> first_skipped() const { return count_.first_skipped; }
  /// Bytes of a record that the end of the file cuts.
  std::uint64_t trailing_partial_bytes() const { return count_.trailing; }

 private:
  struct Count {
    std::uint64_t rejected = 0, skipped = 0, trailing = 0;
    std::optional<std::uint64_t> first_skipped;
  };
  std::optional<std::size_t> scan(std::size_t at, TlogRecord& record, Count& count) const;
  bool record_follows(std::size_t at, std::uint64_t time_us) const;

  Bytes bytes_;
  std::size_t at_ = 0;
  std::uint64_t frames_ = 0, salvaged_ = 0, signed_ = 0;
  Count count_;
};

}  // namespace quadsonde::ingest

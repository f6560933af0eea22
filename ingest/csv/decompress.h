#pragma once
// Text logs may come compressed; which way is seen by the first bytes, never by the name.
#include <cstdint>
#include <string>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::ingest::csv {

struct Decompressed {
  std::vector<std::uint8_t> bytes;
  std::optional<Problem> cut;  ///< the compressed file ends early or is damaged; what came before it is in bytes
};

struct DecompressLimits {
  std::uint64_t max_bytes = std::uint64_t{2} << 30;  ///< 2 GiB
  std::uint64_t max_ratio = 300;                     ///< tables of numbers shrink 3 to 50 times
  std::uint64_t free_bytes = 64U << 20;              ///< below this the ratio does not count
};

/// gzip (1F 8B) or Zstandard (28 B5 2F FD)?
bool is_compressed(Bytes bytes);

/// Decompresses gzip (also several members in a row) or Zstandard frames. Grows with what really comes out, up to
/// the limits. Errors: limit; damaged if nothing at all could be decompressed.
Result<Decompressed> decompress(Bytes bytes, const std::string& file, const DecompressLimits& limits = {});

}  // namespace quadsonde::ingest::csv

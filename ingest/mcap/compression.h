#pragma once
// The two compressions of MCAP chunks, LZ4 frames and zstd, within stated limits.
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"

namespace quadsonde::ingest::mcap {

enum class Compression { none, lz4, zstd };

/// "", "lz4", "zstd".
std::string_view name_of(Compression compression);
std::optional<Compression> compression_named(std::string_view name);

/// Holds the libraries' contexts, so that many chunks share them.
class Decompressor {
 public:
  Decompressor();
  ~Decompressor();
  Decompressor(Decompressor&&) noexcept;
  Decompressor& operator=(Decompressor&&) noexcept;

  /// Fills `out` with exactly `size` bytes.
  /// @return false if more, fewer or no bytes come out; `out` then holds what came out before the error, at most
  ///         `size` bytes, and grew only as they came, so that a claimed size alone takes no memory.
  bool run(Compression compression, Bytes in, std::uint64_t size, std::vector<std::uint8_t>& out);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
};

class Compressor {
 public:
  Compressor();
  ~Compressor();
  Compressor(Compressor&&) noexcept;
  Compressor& operator=(Compressor&&) noexcept;

  /// Replaces `out`; false if the library fails.
  /// @param level  of the library; lz4: 0 fast, 3 to 12 smaller and slower; zstd: 1 to 19; below 0 both are faster
  ///               and pack less (lz4 -3: 1.5 times as fast, files of flight data 4 % larger)
  bool run(Compression compression, int level, Bytes in, std::vector<std::uint8_t>& out);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
};

}  // namespace quadsonde::ingest::mcap

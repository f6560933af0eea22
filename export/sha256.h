#pragma once
// Fingerprints of inputs. Source: FIPS 180-4, sections 4 to 6.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// SHA-256 of bytes that come in any pieces, below 2^61 of them.
class Sha256 {
 public:
  void update(ingest::Bytes bytes);
  /// The digest in lower-case hexadecimal; nothing may be added afterwards.
  std::string hex();

 private:
  void take_block(const std::uint8_t* block);
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> pending_{};
  std::size_t held_ = 0;
  std::uint64_t length_ = 0;
};

std::string sha256_hex(ingest::Bytes bytes);
/// Fails with Kind::unreadable when the file cannot be opened or read to its end.
ingest::Result<std::string> sha256_of_file(const std::filesystem::path& path);

}  // namespace quadsonde::product

#include "export/cf_netcdf/hdf5_checksum.h"

#include <array>
#include <bit>

namespace quadsonde::product {
namespace {

using State = std::array<std::uint32_t, 3>;

/// The next 12 bytes, little-endian, added to the state; what is beyond the end counts as zero.
void add(State& s, std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size() && i < 12; ++i)
    s[i / 4] += std::uint32_t{static_cast<std::uint8_t>(bytes[i])} << (8 * (i % 4));
}

void mix(State& s) {
  constexpr int turns[] = {4, 6, 8, 16, 19, 4};
  for (std::size_t i = 0; i < 6; ++i) {
    auto &x = s[i % 3], &y = s[(i + 1) % 3], &z = s[(i + 2) % 3];
    x = (x - z) ^ std::rotl(z, turns[i]);
    z += y;
  }
}

void finish(State& s) {
  constexpr int turns[] = {14, 11, 25, 16, 4, 14, 24};
  for (std::size_t i = 0; i < 7; ++i) {
    auto &x = s[(i + 2) % 3], &y = s[(i + 1) % 3];
    x = (x ^ y) - std::rotl(y, turns[i]);
  }
}

}  // namespace

std::uint32_t hdf5_checksum(std::string_view bytes) {
  const auto start = 0xdeadbeefu + static_cast<std::uint32_t>(bytes.size());
  State state{start, start, start};
  if (bytes.empty()) return state[2];
  for (; bytes.size() > 12; bytes.remove_prefix(12)) {
    add(state, bytes);
    mix(state);
  }
  add(state, bytes);
  finish(state);
  return state[2];
}

}  // namespace quadsonde::product

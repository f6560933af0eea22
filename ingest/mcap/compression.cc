#include "ingest/mcap/compression.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <bit>

namespace quadsonde::ingest::mcap {
namespace {

// A first guess of how far a chunk may expand before the output has to prove it; real logs stay far below.
constexpr std::uint64_t kTrustedRatio = 64;
constexpr std::uint64_t kSmall = 1 << 16;

std::size_t first_size(std::size_t in, std::uint64_t size) {
  return static_cast<std::size_t>(std::min<std::uint64_t>(size, in * kTrustedRatio + kSmall));
}

/// Runs a streaming decoder `step(in, in_left, out, out_left, done)`, which moves in and out and gives false on an
/// error, until the frames end; the output grows twofold at most, and only when it is full.
template <class Step>
bool decode(Bytes in, std::uint64_t size, std::vector<std::uint8_t>& out, Step&& step) {
  out.resize(first_size(in.size(), size));
  std::size_t made = 0, used = 0;
  bool ok = true, done = in.empty() && size == 0;
  while (ok && used < in.size()) {
    if (made == out.size() && made < size)
      out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, std::max<std::uint64_t>(2 * made, kSmall))));
    std::size_t eaten = in.size() - used, filled = out.size() - made;
    ok = step(in.data() + used, eaten, out.data() + made, filled, done);
    used += eaten;
    made += filled;
    // Neither side moved: the frame wants more room than it claimed, or is cut.
    if (ok && eaten == 0 && filled == 0) break;
  }
  // Output may be pending when the last input byte is eaten.
  while (ok && !done && made < size && used == in.size()) {
    if (made == out.size())
      out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, std::max<std::uint64_t>(2 * made, kSmall))));
    std::size_t eaten = 0, filled = out.size() - made;
    ok = step(in.data() + used, eaten, out.data() + made, filled, done);
    made += filled;
    if (filled == 0) break;
  }
  out.resize(made);
  return ok && done && used == in.size() && made == size;
}

constexpr std::uint32_t kZstdMagic = 0xFD2FB528;

/// Most bytes that the first zstd frame can unpack to, by the heads of its blocks: what it claims itself proves
/// nothing. Source: RFC 8878, 3.1.1.
std::uint64_t zstd_bound(Bytes in) {
  constexpr std::uint64_t kBlock = 1 << 17;
  constexpr std::uint8_t kDictionary[] = {0, 1, 2, 4}, kContentSize[] = {0, 2, 4, 8};
  if (in.size() < 5 || load<std::uint32_t>(in.data()) != kZstdMagic) return 0;
  const auto descriptor = in[4];
  const bool single = (descriptor & 0x20) != 0;
  const std::size_t content_size = single && descriptor < 0x40 ? 1 : kContentSize[descriptor >> 6];
  Cursor cursor(in, 5);
  if (!cursor.skip((single ? 0 : 1) + kDictionary[descriptor & 3] + content_size)) return 0;
  std::uint64_t bound = 0;
  std::uint8_t low;
  std::uint16_t high;
  for (bool last = false; !last && cursor.get(low) && cursor.get(high);) {
    last = (low & 1) != 0;
    const auto type = low >> 1 & 3;
    const std::uint64_t size = (low | std::uint32_t{high} << 8) >> 3;
    if (type == 0) bound += std::min<std::uint64_t>({size, kBlock, cursor.left()});  // as it stands
    if (type == 1) bound += std::min(size, kBlock);                                  // one byte, repeated
    if (type == 2) bound += kBlock;                                                  // compressed
    if (type == 3 || !cursor.skip(type == 1 ? 1 : size)) break;
  }
  return bound;
}

}  // namespace

std::string_view name_of(Compression compression) {
  switch (compression) {
    case Compression::lz4:
      return "lz4";
    case Compression::zstd:
      return "zstd";
    case Compression::none:
      break;
  }
  return "";
}

std::optional<Compression> compression_named(std::string_view name) {
  for (const auto compression : {Compression::none, Compression::lz4, Compression::zstd})
    if (name == name_of(compression)) return compression;
  return std::nullopt;
}

struct Decompressor::Contexts {
  LZ4F_dctx* lz4 = nullptr;
  ZSTD_DCtx* zstd = nullptr;
  ~Contexts() {
    LZ4F_freeDecompressionContext(lz4);
    ZSTD_freeDCtx(zstd);
  }
};

Decompressor::Decompressor() : contexts_(std::make_unique<Contexts>()) {}
Decompressor::~Decompressor() = default;
Decompressor::Decompressor(Decompressor&&) noexcept = default;
Decompressor& Decompressor::operator=(Decompressor&&) noexcept = default;

namespace {

bool run_lz4(LZ4F_dctx* context, Bytes in, std::uint64_t size, std::vector<std::uint8_t>& out) {
  LZ4F_resetDecompressionContext(context);
  return decode(in, size, out, [&](const std::uint8_t* from, std::size_t& eaten, std::uint8_t* to,
                                   std::size_t& filled, bool& done) {
    const auto hint = LZ4F_decompress(context, to, &filled, from, &eaten, nullptr);
    if (LZ4F_isError(hint)) {
      eaten = filled = 0;
      return false;
    }
    done = hint == 0;
    return true;
  });
}

bool run_zstd(ZSTD_DCtx* context, Bytes in, std::uint64_t size, std::vector<std::uint8_t>& out) {
  // The usual case in one call: one frame, whose blocks can hold what the chunk says.
  const auto bound = zstd_bound(in);
  if (size <= bound) {
    out.resize(static_cast<std::size_t>(size));
    const auto made = ZSTD_decompressDCtx(context, out.data(), out.size(), in.data(), in.size());
    if (!ZSTD_isError(made) && made == size) return true;
  }
  ZSTD_DCtx_reset(context, ZSTD_reset_session_only);
  // Piece by piece the library takes the memory of a whole window before any byte comes out: 8 MiB, or what is there.
  ZSTD_DCtx_setParameter(context, ZSTD_d_windowLogMax, std::clamp<int>(std::bit_width(bound), 23, 30));
  return decode(in, size, out, [&](const std::uint8_t* from, std::size_t& eaten, std::uint8_t* to,
                                   std::size_t& filled, bool& done) {
    ZSTD_inBuffer input{from, eaten, 0};
    ZSTD_outBuffer output{to, filled, 0};
    const auto hint = ZSTD_decompressStream(context, &output, &input);
    eaten = input.pos;
    filled = output.pos;
    if (ZSTD_isError(hint)) return false;
    done = hint == 0;
    return true;
  });
}

}  // namespace

bool Decompressor::run(Compression compression, Bytes in, std::uint64_t size, std::vector<std::uint8_t>& out) {
  // A buffer that already has the size is not filled with zeros again.
  switch (compression) {
    case Compression::none: {
      const auto taken = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(size, in.size()));
      out.assign(in.begin(), in.begin() + taken);
      return in.size() == size;
    }
    case Compression::lz4:
      if (!contexts_->lz4 && LZ4F_isError(LZ4F_createDecompressionContext(&contexts_->lz4, LZ4F_VERSION))) break;
      return run_lz4(contexts_->lz4, in, size, out);
    case Compression::zstd:
      if (!contexts_->zstd) contexts_->zstd = ZSTD_createDCtx();
      if (!contexts_->zstd) break;
      return run_zstd(contexts_->zstd, in, size, out);
  }
  out.clear();
  return false;
}

struct Compressor::Contexts {
  ZSTD_CCtx* zstd = nullptr;
  ~Contexts() { ZSTD_freeCCtx(zstd); }
};

Compressor::Compressor() : contexts_(std::make_unique<Contexts>()) {}
Compressor::~Compressor() = default;
Compressor::Compressor(Compressor&&) noexcept = default;
Compressor& Compressor::operator=(Compressor&&) noexcept = default;

bool Compressor::run(Compression compression, int level, Bytes in, std::vector<std::uint8_t>& out) {
  switch (compression) {
    case Compression::none:
      out.assign(in.begin(), in.end());
      return true;
    case Compression::lz4: {
      LZ4F_preferences_t preferences{};
      preferences.frameInfo.contentSize = in.size();
      preferences.frameInfo.blockSizeID = LZ4F_max64KB;  // of a cut frame, every whole block comes out
      preferences.compressionLevel = level;
      out.resize(LZ4F_compressFrameBound(in.size(), &preferences));
      const auto made = LZ4F_compressFrame(out.data(), out.size(), in.data(), in.size(), &preferences);
      out.resize(LZ4F_isError(made) ? 0 : made);
      return !LZ4F_isError(made);
    }
    case Compression::zstd: {
      if (!contexts_->zstd) contexts_->zstd = ZSTD_createCCtx();
      if (!contexts_->zstd) return false;
      out.resize(ZSTD_compressBound(in.size()));
      const auto made = ZSTD_compressCCtx(contexts_->zstd, out.data(), out.size(), in.data(), in.size(), level);
      out.resize(ZSTD_isError(made) ? 0 : made);
      return !ZSTD_isError(made);
    }
  }
  return false;
}

}  // namespace quadsonde::ingest::mcap

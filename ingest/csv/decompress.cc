#include "ingest/csv/decompress.h"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

namespace quadsonde::ingest::csv {
namespace {

bool is_gzip(Bytes b) { return b.size() >= 2 && b[0] == 0x1F && b[1] == 0x8B; }
bool is_zstd(Bytes b) { return b.size() >= 4 && b[0] == 0x28 && b[1] == 0xB5 && b[2] == 0x2F && b[3] == 0xFD; }

/// An output that grows piece by piece and knows its limit.
class Output {
 public:
  Output(std::size_t input_size, const DecompressLimits& limits)
      : most_(std::min(limits.max_bytes, std::max(limits.free_bytes, input_size * limits.max_ratio))) {
    bytes_.reserve(std::min<std::uint64_t>(most_, input_size * 4));
  }
  bool append(const std::uint8_t* data, std::size_t size) {
    if (bytes_.size() + size > most_) return false;
    bytes_.insert(bytes_.end(), data, data + size);
    return true;
  }
  std::uint64_t most() const { return most_; }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::uint64_t most_;
  std::vector<std::uint8_t> bytes_;
};

Problem too_large(const std::string& file, const Output& out) {
  return {Kind::limit,
          fmt::format("decompressed it is larger than {} bytes, which no flight log of this size is", out.most()),
          {file, {}, {}, {}},
          "decompress it first if it really is a log"};
}
Problem cut(const std::string& file, std::size_t at, const char* what) {
  return {
      Kind::truncated, fmt::format("the compressed data {}", what), {file, at, {}, {}}, "what came before it is used"};
}

constexpr std::size_t piece = 1 << 18;

Result<Decompressed> gunzip(Bytes in, const std::string& file, const DecompressLimits& limits) {
  Output out(in.size(), limits);
  std::vector<std::uint8_t> buffer(piece);
  z_stream z{};
  if (inflateInit2(&z, 15 + 16) != Z_OK) return fail(Kind::unreadable, "zlib does not start", {file, {}, {}, {}});
  const std::unique_ptr<z_stream, int (*)(z_stream*)> closer(&z, inflateEnd);
  std::size_t at = 0;
  Decompressed result;
  while (true) {
    z.next_in = const_cast<Bytef*>(in.data() + at);
    z.avail_in = static_cast<uInt>(std::min<std::size_t>(in.size() - at, 1U << 30));
    z.next_out = buffer.data();
    z.avail_out = piece;
    const auto offered = z.avail_in;
    const int code = inflate(&z, Z_NO_FLUSH);
    at += offered - z.avail_in;
    if (!out.append(buffer.data(), piece - z.avail_out)) return fail(too_large(file, out));
    if (code == Z_STREAM_END) {
      if (!is_gzip(in.subspan(at))) break;  // what follows the last member is padding
      inflateReset(&z);
    } else if (code != Z_OK) {
      result.cut = cut(file, at, code == Z_BUF_ERROR && at == in.size() ? "ends early" : "is damaged");
      break;
    }
  }
  result.bytes = std::move(out.bytes());
  return result;
}

Result<Decompressed> unzstd(Bytes in, const std::string& file, const DecompressLimits& limits) {
  Output out(in.size(), limits);
  std::vector<std::uint8_t> buffer(piece);
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
  if (!stream) return fail(Kind::unreadable, "zstd does not start", {file, {}, {}, {}});
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, 27);
  ZSTD_inBuffer input{in.data(), in.size(), 0};
  Decompressed result;
  std::size_t hint = 1;
  while (true) {
    ZSTD_outBuffer output{buffer.data(), buffer.size(), 0};
    const auto before = input.pos;
    hint = ZSTD_decompressStream(stream.get(), &output, &input);
    if (!out.append(buffer.data(), output.pos)) return fail(too_large(file, out));
    if (ZSTD_isError(hint)) {
      result.cut = cut(file, input.pos, "is damaged");
      break;
    }
    if (output.pos == 0 && input.pos == before) break;
  }
  if (!result.cut && hint != 0) result.cut = cut(file, in.size(), "ends early");
  result.bytes = std::move(out.bytes());
  return result;
}

}  // namespace

bool is_compressed(Bytes bytes) { return is_gzip(bytes) || is_zstd(bytes); }

Result<Decompressed> decompress(Bytes bytes, const std::string& file, const DecompressLimits& limits) {
  auto result = is_gzip(bytes) ? gunzip(bytes, file, limits) : unzstd(bytes, file, limits);
  if (result && result->cut && result->bytes.empty()) {
    result->cut->kind = Kind::damaged;
    result->cut->hint = "copy the file again";
    return fail(*result->cut);
  }
  return result;
}

}  // namespace quadsonde::ingest::csv

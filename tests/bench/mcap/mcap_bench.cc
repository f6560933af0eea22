// Reading and writing MCAP against bare decompression plus CRC of the same bytes.
//   bench_mcap [FOLDER [MESSAGES]]     the table; files go into FOLDER (default: the temporary one)
//   bench_mcap --memory FILE.mcap      peak memory of reading one file in the order of its times, and streamed
//   bench_mcap --make FILE.mcap GB     a chunked zstd file of about that size for it
//   bench_mcap --large [FOLDER]        both for 2 GB; the file is removed afterwards
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "ingest/mcap/indexed_reader.h"
#include "ingest/mcap/mapped_file.h"
#include "ingest/mcap/reader.h"
#include "ingest/mcap/writer.h"

namespace {

using namespace quadsonde::ingest;        // NOLINT: a program of its own
using namespace quadsonde::ingest::mcap;  // NOLINT

constexpr std::size_t kSize = 32;

class FileSink : public Sink {
 public:
  explicit FileSink(const std::filesystem::path& path) : file_(std::fopen(path.c_str(), "wb")) {}
  ~FileSink() override { std::fclose(file_); }
  bool write(Bytes bytes) override { return std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size(); }

 private:
  std::FILE* file_;
};

class NullSink : public Sink {
 public:
  bool write(Bytes bytes) override { return (total += bytes.size(), true); }
  std::uint64_t total = 0;
};

/// Message data that compresses about as flight data does: slow doubles with noise in the low bits.
std::vector<std::uint8_t> make_data(std::size_t messages) {
  std::vector<std::uint8_t> data(messages * kSize);
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < messages; ++i) {
    for (std::size_t k = 0; k < kSize / 8; ++k) {
      const double value = static_cast<double>(i) * 1e-3 + static_cast<double>(k) + static_cast<double>(random() % 4096) * 1e-7;
      std::memcpy(data.data() + i * kSize + 8 * k, &value, 8);
    }
  }
  return data;
}

WriterSettings settings_for(Compression compression, bool chunked) {
  WriterSettings settings;
  settings.compression = compression;
  settings.level = compression == Compression::lz4 ? 0 : 1;
  settings.chunked = chunked;
  return settings;
}

void write_log(Sink& sink, const WriterSettings& settings, std::size_t messages, const std::vector<std::uint8_t>& data) {
  Writer writer(sink, settings);
  std::uint16_t channels[4];
  for (int c = 0; c < 4; ++c) channels[c] = *writer.add_channel(0, fmt::format("/topic/{}", c), "raw");
  const auto kept = data.size() / kSize;
  for (std::size_t i = 0; i < messages; ++i) {
    const auto time = 1'700'000'000'000'000'000ull + 1'000'000ull * i;
    const Bytes body = Bytes(data).subspan(i % kept * kSize, kSize);
    if (!writer.write({channels[i % 4], static_cast<std::uint32_t>(i), time, time, body})) std::abort();
  }
  if (!writer.close()) std::abort();
}

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor time, all of it single-threaded, so that other programs count little; the best of five.
double seconds_of(const std::function<void()>& work) {
  double best = 1e9;
  for (int i = 0; i < 5; ++i) {
    const auto start = cpu_seconds();
    work();
    best = std::min(best, cpu_seconds() - start);
  }
  return best;
}

/// Peak of resident memory that is not a mapped file's [MB], since the last reset.
double peak_anonymous_mb() {
  std::ifstream in("/proc/self/status");
  double anonymous = 0;
  for (std::string word; in >> word;)
    if (word == "RssAnon:") in >> anonymous;
  return anonymous / 1024;
}

/// Bare work on the same bytes: unpack every chunk and take its CRC, nothing else. An unchunked file: its CRC.
void bare(Bytes file) {
  Decompressor decompressor;
  std::vector<std::uint8_t> buffer;
  std::uint64_t at = kMagic.size();
  std::uint32_t sum = 0;
  bool chunks = false;
  while (const auto raw = record_at(file, at)) {
    if (raw->op == Op::footer) break;
    at = raw->end;
    if (raw->op != Op::chunk) continue;
    chunks = true;
    const auto chunk = *parse_chunk(raw->content);
    const auto compression = *compression_named(chunk.compression);
    Bytes records = chunk.records;
    if (compression != Compression::none) {
      if (!decompressor.run(compression, records, chunk.uncompressed_size, buffer)) std::abort();
      records = buffer;
    }
    sum ^= crc32(records);
    if (crc32(records) != 0 && sum == 1) std::abort();
  }
  if (!chunks) sum = crc32(file);
  if (sum == 0x12345678) std::puts("");
}

/// What no writer of chunks can do without: their CRC and their compression, by the bytes that the file holds unpacked.
/// @return seconds
double bare_packing(Bytes file, const WriterSettings& settings) {
  Decompressor decompressor;
  Compressor compressor;
  std::vector<std::uint8_t> records, packed;
  std::uint64_t at = kMagic.size();
  std::vector<std::vector<std::uint8_t>> chunks;
  while (const auto raw = record_at(file, at)) {
    if (raw->op == Op::footer) break;
    at = raw->end;
    if (raw->op != Op::chunk) continue;
    const auto chunk = *parse_chunk(raw->content);
    if (!decompressor.run(*compression_named(chunk.compression), chunk.records, chunk.uncompressed_size, records))
      std::abort();
    chunks.push_back(records);
  }
  return seconds_of([&] {
    std::uint32_t sum = 0;
    for (const auto& chunk : chunks) {
      sum ^= crc32(chunk);
      if (!compressor.run(settings.compression, settings.level, chunk, packed)) std::abort();
    }
    if (sum == 0x12345678) std::puts("");
  });
}

struct Sums {
  std::uint64_t messages = 0, bytes = 0, times = 0;
  friend bool operator==(const Sums&, const Sums&) = default;
};

Sums streamed(Bytes file, bool crc) {
  Sums sums;
  RecordReader reader(file, {Reading::strict, crc, 1u << 30, ""});
  for (Record record; reader.next(record);) {
    if (record.op != Op::message) continue;
    const auto message = record.message();
    ++sums.messages;
    sums.bytes += message.data.size() + message.data[0];
    sums.times += message.log_time;
  }
  if (!reader.complete()) std::abort();
  return sums;
}

Sums indexed(Bytes file, Order order, double* peak_mb = nullptr) {
  Sums sums;
  const auto reader = IndexedReader::open(file);
  auto cursor = reader->messages({}, order);
  for (Message message; cursor.next(message);) {
    ++sums.messages;
    sums.bytes += message.data.size() + message.data[0];
    sums.times += message.log_time;
    if (peak_mb && sums.messages % (1 << 18) == 0) *peak_mb = std::max(*peak_mb, peak_anonymous_mb());
  }
  return sums;
}

void row(const std::string& name, const std::string& way, double seconds, double bare_seconds, std::uint64_t messages,
         std::uint64_t bytes) {
  fmt::print("{:<12} {:<10} {:>8.1f} {:>8.0f} {:>8.3f} {:>10.2f}\n", name, way,
             static_cast<double>(messages) / seconds * 1e-6, static_cast<double>(bytes) / seconds * 1e-6, seconds,
             bare_seconds / seconds);
}

void bench(const std::string& name, const WriterSettings& settings, const std::filesystem::path& path,
           std::size_t messages, const std::vector<std::uint8_t>& data) {
  {
    FileSink sink(path);
    write_log(sink, settings, messages, data);
  }
  const auto mapped = MappedFile::open(path);
  const auto file = mapped->bytes();
  // Uncompressed size of the records: what all ways are measured by.
  const std::uint64_t bytes = messages * (kHeadSize + kMessageHead + kSize);
  const auto reference = streamed(file, true);
  if (reference.messages != messages || !(indexed(file, Order::file) == reference) ||
      !(indexed(file, Order::log_time) == reference))
    std::abort();  // agree first
  const double bare_seconds = seconds_of([&] { bare(file); });
  row(name, "bare", bare_seconds, bare_seconds, messages, bytes);
  const double read_seconds = seconds_of([&] { streamed(file, true); });
  row(name, "streamed", read_seconds, bare_seconds, messages, bytes);
  row(name, "no CRC", seconds_of([&] { streamed(file, false); }), bare_seconds, messages, bytes);
  row(name, "indexed", seconds_of([&] { indexed(file, Order::file); }), bare_seconds, messages, bytes);
  row(name, "by time", seconds_of([&] { indexed(file, Order::log_time); }), bare_seconds, messages, bytes);
  const double write_seconds = seconds_of([&] {
    NullSink sink;
    write_log(sink, settings, messages, data);
  });
  row(name, "written", write_seconds, bare_seconds, messages, bytes);
  if (settings.chunked) {
    // Whatever the writer does, it is no faster than the packing on the same core.
    const double packing_seconds = bare_packing(file, settings);
    row(name, "packing", packing_seconds, bare_seconds, messages, bytes);
    fmt::print("  written: {:.2f} of streamed, {:.2f} of packing; packing: {:.2f} of streamed; file {:.2f} of records\n",
               read_seconds / write_seconds, packing_seconds / write_seconds, read_seconds / packing_seconds,
               static_cast<double>(file.size()) / static_cast<double>(bytes));
  }
  std::filesystem::remove(path);
}

int memory(const std::filesystem::path& path) {
  const auto mapped = MappedFile::open(path);
  if (!mapped) return 1;
  double peak = 0;
  const auto sums = indexed(mapped->bytes(), Order::log_time, &peak);
  fmt::print("by time:  {} messages, peak anonymous memory {:.1f} MB\n", sums.messages, peak);
  double peak_streamed = 0;
  RecordReader reader(mapped->bytes(), {});
  std::uint64_t count = 0;
  for (Record record; reader.next(record);)
    if (++count % (1 << 18) == 0) peak_streamed = std::max(peak_streamed, peak_anonymous_mb());
  fmt::print("streamed: {} records, peak anonymous memory {:.1f} MB; file {:.0f} MB\n", count, peak_streamed,
             static_cast<double>(mapped->bytes().size()) * 1e-6);
  return 0;
}

int make(const std::filesystem::path& path, double gigabytes) {
  // Random data, so that the file is as large compressed.
  std::vector<std::uint8_t> data(std::size_t{1 << 20} * kSize);
  std::mt19937_64 random(3);
  for (std::size_t i = 0; i < data.size(); i += 8) {
    const auto word = random();
    std::memcpy(data.data() + i, &word, 8);
  }
  FileSink sink(path);
  write_log(sink, settings_for(Compression::zstd, true), static_cast<std::size_t>(gigabytes * 1e9 / 46), data);
  return 0;
}

int large(const std::filesystem::path& folder) {
  const auto path = folder / fmt::format("bench_mcap_large_{}.mcap", ::getpid());
  const auto failed = make(path, 2) || memory(path);
  std::filesystem::remove(path);
  return failed;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "--memory" && argc == 3) return memory(argv[2]);
  if (first == "--large") return large(argc > 2 ? argv[2] : std::filesystem::temp_directory_path());
  if (first == "--make" && argc == 4) return make(argv[2], std::atof(argv[3]));
  const std::filesystem::path folder = argc > 1 ? std::filesystem::path(first) : std::filesystem::temp_directory_path();
  std::size_t messages = 3'000'000;
  if (argc > 2) std::from_chars(argv[2], argv[2] + std::strlen(argv[2]), messages);
  const auto data = make_data(messages);
  fmt::print("{} messages of {} bytes, chunks of 1 MiB\n", messages, kSize);
  fmt::print("{:<12} {:<10} {:>8} {:>8} {:>8} {:>10}\n", "file", "way", "M msg/s", "MB/s", "s", "of bare");
  const auto path = folder / fmt::format("bench_mcap_{}.mcap", ::getpid());
  bench("none", settings_for(Compression::none, true), path, messages, data);
  bench("lz4", settings_for(Compression::lz4, true), path, messages, data);
  auto fast_lz4 = settings_for(Compression::lz4, true);
  fast_lz4.level = -3;
  bench("lz4 -3", fast_lz4, path, messages, data);
  bench("zstd", settings_for(Compression::zstd, true), path, messages, data);
  bench("unchunked", settings_for(Compression::none, false), path, messages, data);
  return 0;
}

// Reads a generated ULog of 500 MB: MB/s of file and messages/s, beside the CRC of the same bytes.
//   bench_ulog [MEGABYTES]
#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "ingest/flight/flight.h"
#include "ingest/open/mapped_file.h"
#include "ingest/ulog/container.h"
#include "ingest/ulog/flight_from_ulog.h"
#include "tests/bench/report.h"

namespace {

using namespace quadsonde;

template <class T>
void put(std::string& text, T value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void message(std::string& log, char type, std::string_view body) {
  put(log, static_cast<std::uint16_t>(body.size()));
  log += type;
  log += body;
}

void announce(std::string& log, std::uint16_t id, const std::string& name, const std::string& fields) {
  message(log, 'F', name + ":" + fields);
  std::string body(1, '\0');
  put(body, id);
  message(log, 'A', body + name);
}

/// A log as PX4 writes it: attitude 250 Hz, position 50 Hz, receiver 10 Hz, and twice as many bytes of topics that
/// nobody here reads (rates, actuators, innovations).
std::string generate(std::size_t bytes, std::uint64_t& messages, std::uint64_t& attitudes) {
  std::string log("ULog\x01\x12\x35\x01", 8);
  put(log, std::uint64_t{0});
  announce(log, 0, "vehicle_attitude",
           "uint64_t timestamp;uint64_t timestamp_sample;float[4] q;float[4] delta_q_reset;uint8_t "
           "quat_reset_counter;uint8_t[7] _padding0;");
  announce(log, 1, "vehicle_local_position",
           "uint64_t timestamp;double ref_lat;double ref_lon;float x;float y;float z;float vx;float vy;float vz;float "
           "ref_alt;bool xy_valid;bool z_valid;bool v_xy_valid;bool v_z_valid;bool xy_global;bool z_global;");
  announce(log, 2, "vehicle_gps_position",
           "uint64_t timestamp;uint64_t time_utc_usec;int32_t lat;int32_t lon;int32_t alt;int32_t alt_ellipsoid;float "
           "s_variance_m_s;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;int32_t timestamp_time_relative;uint8_t "
           "fix_type;bool vel_ned_valid;");
  announce(log, 3, "rate_ctrl_status", "uint64_t timestamp;float[8] x;");
  announce(log, 4, "ekf2_innovations", "uint64_t timestamp;float[40] x;");
  std::string body;
  log.reserve(bytes + 4096);
  for (std::uint64_t step = 0; log.size() < bytes; ++step) {
    const std::uint64_t us = step * 4000;
    const auto data = [&](std::uint16_t id, auto&&... values) {
      body.clear();
      put(body, id);
      put(body, us);
      (put(body, values), ...);
      message(log, 'D', body);
      ++messages;
    };
    const float wave = std::sin(static_cast<float>(step) * 0.001F);
    data(0, us, 1.0F, 0.1F * wave, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, std::uint8_t{0});
    ++attitudes;
    struct Block32 {
      float x[8];
    };
    struct Block160 {
      float x[40];
    };
    data(3, Block32{{wave}});
    if (step % 2 == 0) data(4, Block160{{wave}});
    if (step % 5 == 0)
      data(1, 47.0, 8.0, wave, wave, -wave, wave, wave, -wave, 400.0F, std::uint32_t{0x01010101},
           std::uint16_t{0x0101});
    if (step % 25 == 0)
      data(2, std::uint64_t{1557756559600179} + us, std::int32_t{470000000}, std::int32_t{80000000},
           std::int32_t{400000}, std::int32_t{447000}, 0.3F, wave, wave, -wave, std::int32_t{0}, std::uint8_t{3},
           std::uint8_t{1});
  }
  return log;
}

}  // namespace

int main(int count, char** arguments) {
  const auto megabytes = count > 1 ? std::strtoul(arguments[1], nullptr, 10) : 500UL;
  const auto path = std::filesystem::temp_directory_path() / fmt::format("quadsonde-bench-{}.ulg", std::rand());
  std::uint64_t messages = 0, attitudes = 0;
  {
    const auto log = generate(megabytes * 1'000'000, messages, attitudes);
    std::ofstream(path, std::ios::binary) << log;
  }
  const auto file = ingest::MappedFile::open(path).value();
  const auto bytes = file.bytes();
  // Agree first, race second.
  {
    const auto content = ingest::read_ulog(bytes, "bench.ulg").value();
    if (content.messages != messages || content.flights.at(0).attitude.size() != attitudes) return 1;
  }
  bench::print_head();
  bench::print_row("CRC-32 of the bytes (zlib)",
                   bench::best_of_three([&] { (void)crc32_z(0, bytes.data(), bytes.size()); }), bytes.size(), messages);
  const double scan = bench::best_of_three([&] {
    ingest::ulog::Settings none;
    none.keep = [](std::string_view) { return false; };
    (void)ingest::ulog::read(bytes, "bench.ulg", none);
  });
  bench::print_row("container, counted only", scan, bytes.size(), messages);
  const double whole = bench::best_of_three([&] { (void)ingest::read_ulog(bytes, "bench.ulg"); });
  bench::print_row("container and flight", whole, bytes.size(), messages);
  std::filesystem::remove(path);
  return 0;
}

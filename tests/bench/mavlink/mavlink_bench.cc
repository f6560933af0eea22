// A generated telemetry log of 500 MB (or as many as the first argument says): bytes and frames per second.
#include <cstdlib>

#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/mavlink/tlog_reader.h"
#include "tests/bench/report.h"
#include "tests/ingest/mavlink/mavlink_writer.h"

using namespace quadsonde;

namespace {

/// A link's usual mixture over ten seconds of boot time.
void ten_seconds(support::TlogWriter& log, double from_ms) {
  log.heartbeat();
  for (int k = 0; k < 100; ++k) {
    const double ms = from_ms + 100 * k;
    log.add("ATTITUDE", {{"time_boot_ms", ms}, {"roll", 0.1}, {"pitch", -0.2}, {"yaw", 0.3}, {"yawspeed", 0.1}});
    log.add("GLOBAL_POSITION_INT", {{"time_boot_ms", ms},
                                    {"lat", 473565765},
                                    {"lon", 85189121},
                                    {"alt", 428924},
                                    {"relative_alt", 12302},
                                    {"vx", 100},
                                    {"vy", 200},
                                    {"vz", 30},
                                    {"hdg", 9000}});
    log.add("LOCAL_POSITION_NED", {{"time_boot_ms", ms}, {"x", k}, {"z", -5}, {"vx", 1}, {"vy", 2}, {"vz", -0.5}});
    log.add("VFR_HUD", {{"groundspeed", 2}, {"alt", 430}, {"climb", 0.5}, {"throttle", 50}});
    log.add("RAW_IMU", {{"time_usec", ms * 1000}, {"xacc", 10}, {"zacc", -1000}, {"zmag", 400}});
    log.add("SCALED_PRESSURE", {{"time_boot_ms", ms}, {"press_abs", 980.5}, {"temperature", 2500}});
    log.add("BATTERY_STATUS", {{"current_consumed", 500}, {"battery_remaining", 80}});
    if (k % 2 == 0)
      log.add("GPS_RAW_INT", {{"time_usec", ms * 1000},
                              {"fix_type", 3},
                              {"lat", 473565765},
                              {"lon", 85189121},
                              {"alt", 428924},
                              {"vel", 200},
                              {"cog", 9000},
                              {"vel_acc", 300}});
    if (k % 10 == 0) log.add("WIND", {{"direction", 90}, {"speed", 5}});
    if (k % 10 == 0) log.add("SYSTEM_TIME", {{"time_boot_ms", ms}, {"time_unix_usec", 1'557'756'500e6 + ms * 1000}});
    log.host_us += 93'000;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t size = static_cast<std::size_t>(argc > 1 ? std::atof(argv[1]) : 500) * 1'000'000;
  support::TlogWriter log;
  log.bytes.reserve(size + 1'000'000);
  for (double ms = 60'000; log.bytes.size() < size; ms += 10'000) ten_seconds(log, ms);
  const ingest::Bytes bytes(log.bytes);
  std::uint64_t frames = 0, crc = 0;
  std::size_t attitudes = 0;
  bench::print_head();
  bench::print_row("generated", 1, bytes.size(), 0);
  const double check = bench::best_of_three([&] { crc += ingest::mavlink_crc(bytes); });
  bench::print_row("checksum of all bytes", check, bytes.size(), 0);
  const double walk = bench::best_of_three([&] {
    ingest::TlogReader reader(bytes);
    ingest::TlogRecord record;
    while (reader.next(record)) {
    }
    frames = reader.frames();
  });
  bench::print_row("container: every frame", walk, bytes.size(), frames);
  const double map = bench::best_of_three([&] {
    const auto content = ingest::read_mavlink(bytes, "bench.tlog");
    attitudes = content->flights.at(0).attitude.size();
  });
  bench::print_row("read_mavlink: to Flight", map, bytes.size(), frames);
  fmt::print("{} frames, {} attitudes, checksum {}\n", frames, attitudes, crc);
}

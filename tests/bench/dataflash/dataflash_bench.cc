// A generated ArduCopter log of 500 MB (or as many as the first argument says): bytes and messages per second.
#include <cstdlib>
#include <numeric>

#include "ingest/dataflash/dataflash_reader.h"
#include "ingest/dataflash/flight_from_dataflash.h"
#include "tests/bench/report.h"
#include "tests/ingest/dataflash/dataflash_writer.h"

using namespace quadsonde;

namespace {

/// The usual mixture: fast IMU and rate messages, attitude and filter at 10 Hz for two cores, GPS at 5 Hz.
void one_second(support::CopterLog& log, double from_us) {
  const std::vector<support::DataflashWriter::Value> rate(13, 1.0);
  for (int k = 0; k < 200; ++k) {
    const double us = from_us + k * 5000;
    log.add("IMU", {us, 0., 0.1, 0.2, 0.3, 0.1, 0.2, -9.8, 0., 0., 35., 1., 1., 1000., 1000.});
    log.add("IMU", {us, 1., 0.1, 0.2, 0.3, 0.1, 0.2, -9.8, 0., 0., 35., 1., 1., 1000., 1000.});
    auto values = rate;
    values[0] = us;
    log.add("RATE", values);
    if (k % 20 != 0) continue;
    log.attitude(us, 1, -2, 350);
    for (int core = 0; core < 2; ++core) {
      log.filter(us, 1, core);
      log.add("XKF2", {us, double(core), -51., -172.});
      log.add("XKF4", {us, double(core), 0.});
    }
    log.add("BARO", {us, 0., 12., 98061., 26.7});
    log.add("RCOU", {us, 1500., 1500., 1500., 1500., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.});
    if (k % 40 == 0) log.gps(us);
    if (k % 40 == 0) log.accuracy(us, 0.3);
  }
}

support::CopterLog generate(std::size_t size) {
  support::CopterLog log;
  log.bytes.reserve(size + 1'000'000);
  log.define(20, "IMU", "QBffffffIIfBBHH", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz");
  log.define(21, "RATE", "Qffffffffffff", "TimeUS,RDes,R,ROut,PDes,P,POut,YDes,Y,YOut,ADes,A,AOut");
  log.define(22, "BARO", "QBfff", "TimeUS,I,Alt,Press,Temp");
  log.define(23, "RCOU", "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14");
  for (double us = 60e6; log.bytes.size() < size; us += 1e6) one_second(log, us);
  return log;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t size = static_cast<std::size_t>(argc > 1 ? std::atof(argv[1]) : 500) * 1'000'000;
  const auto log = generate(size);
  const ingest::Bytes bytes(log.bytes);
  std::uint64_t messages = 0, sum = 0;
  bench::print_head();
  bench::print_row("generated", 1, bytes.size(), 0);
  const double touch =
      bench::best_of_three([&] { sum += std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0}); });
  bench::print_row("adding up the bytes", touch, bytes.size(), 0);
  const double walk = bench::best_of_three([&] {
    ingest::DataflashReader reader(bytes);
    ingest::DataflashMessage message;
    while (reader.next(message)) {
    }
    messages = reader.messages();
  });
  bench::print_row("container: every message", walk, bytes.size(), messages);
  std::size_t attitudes = 0;
  const double map = bench::best_of_three([&] {
    const auto content = ingest::read_dataflash(bytes, "bench.bin");
    attitudes = content->flights.at(0).attitude.size();
  });
  bench::print_row("read_dataflash: to Flight", map, bytes.size(), messages);
  fmt::print("{} messages, {} attitudes, byte sum {}\n", messages, attitudes, sum);
}

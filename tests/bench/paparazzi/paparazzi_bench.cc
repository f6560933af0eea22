// A generated Paparazzi .data of 500 MB (or as many as the first argument says): bytes and lines per second.
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "ingest/paparazzi/paparazzi_reader.h"
#include "tests/bench/report.h"

using namespace quadsonde;

namespace {

std::string definition(const std::string& name, const std::string& type, const std::vector<std::string>& fields) {
  auto text = fmt::format("<message name=\"{}\" id=\"1\">", name);
  for (const auto& field : fields) text += fmt::format("<field name=\"{}\" type=\"{}\"/>", field, type);
  return text + "</message>";
}

std::string definitions() {
  return "<configuration time_of_day=\"1557756558.716\"><conf><aircraft name=\"Q\" ac_id=\"42\"><firmware "
         "name=\"rotorcraft\"/></aircraft></conf><protocol><msg_class name=\"telemetry\" id=\"1\">" +
         definition("ATTITUDE", "float", {"phi", "psi", "theta"}) +
         definition("INS", "int32",
                    {"ins_x", "ins_y", "ins_z", "ins_xd", "ins_yd", "ins_zd", "ins_xdd", "ins_ydd", "ins_zdd"}) +
         definition("GPS_INT", "int32",
                    {"ecef_x", "ecef_y", "ecef_z", "lat", "lon", "alt", "hmsl", "ecef_xd", "ecef_yd", "ecef_zd", "pacc",
                     "sacc", "tow", "pdop", "numsv", "fix", "comp_id"}) +
         definition("ACTUATORS", "uint16[]", {"values"}) + "</msg_class></protocol></configuration>";
}

/// Attitude 50 Hz, filter 25 Hz, receiver 5 Hz, and as many lines that nobody here reads.
std::string generate(std::size_t size, std::uint64_t& lines, std::uint64_t& attitudes) {
  std::string text;
  text.reserve(size + 1000);
  const auto add = [&](const auto&... line) {
    fmt::format_to(std::back_inserter(text), line...);
    ++lines;
  };
  for (std::uint64_t step = 0; text.size() < size; ++step) {
    const double t = static_cast<double>(step) * 0.02, wave = std::sin(t);
    add(fmt::runtime("{:.3f} 42 ATTITUDE {:.6f} {:.6f} {:.6f}\n"), t, 0.1 * wave, 3 * wave, -0.1 * wave);
    ++attitudes;
    add(fmt::runtime("{:.3f} 42 ACTUATORS 1500,1500,1500,{}\n"), t, step % 1000);
    const int speed = static_cast<int>(524288 * wave);
    if (step % 2 == 0)
      add(fmt::runtime("{:.3f} 42 INS {} {} {} {} {} {} 0 0 0\n"), t, step % 256, step % 128, -speed / 2048, speed,
          -speed, speed);
    if (step % 10 == 0)
      add(fmt::runtime("{:.3f} 42 GPS_INT 1 2 3 473565765 85189121 476264 428924 {} {} {} 47 28 {} 79 14 3 1\n"), t,
          static_cast<int>(100 * wave), 1, 2, 137377600 + step * 20);
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const auto size = static_cast<std::size_t>(argc > 1 ? std::atof(argv[1]) : 500) * 1'000'000;
  std::uint64_t lines = 0, attitudes = 0, sum = 0;
  const auto text = generate(size, lines, attitudes);
  const auto log = definitions();
  const auto bytes = ingest::as_bytes(text);
  const auto read = [&] { return ingest::read_paparazzi(bytes, ingest::as_bytes(log), "bench.data").value(); };
  // Agree first, race second.
  {
    const auto content = read();
    if (content.messages != lines || content.flights.at(0).attitude.size() != attitudes) return 1;
  }
  bench::print_head();
  const double touch =
      bench::best_of_three([&] { sum += std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0}); });
  bench::print_row("adding up the bytes", touch, bytes.size(), lines);
  const double walk = bench::best_of_three([&] {
    ingest::PaparazziLineReader reader(bytes);
    ingest::PaparazziLine line;
    while (reader.next(line)) sum += line.values.size();
  });
  bench::print_row("container: every line", walk, bytes.size(), lines);
  const double whole = bench::best_of_three([&] { sum += read().messages; });
  bench::print_row("read_paparazzi: to Flight", whole, bytes.size(), lines);
  fmt::print("{:.1f} times the bare reading, sum {}\n", whole / touch, sum);
}

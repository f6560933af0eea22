// A generated table of 500 MB (or as many as the first argument says): bytes and rows per second.
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "ingest/csv/flight_from_csv.h"
#include "tests/bench/report.h"

using namespace quadsonde;

namespace {

/// Canonical names, 50 rows a second, with the digits that such tables have.
std::string generate(std::size_t size, std::uint64_t& rows) {
  std::string text = "time_s,qw,qx,qy,qz,vn_m_s,ve_m_s,vd_m_s,lat_deg,lon_deg,height_msl_m,pressure_pa\n";
  text.reserve(size + 1000);
  for (; text.size() < size; ++rows) {
    const double t = static_cast<double>(rows) * 0.02, wave = std::sin(t);
    const double half = 0.5 * wave;
    fmt::format_to(std::back_inserter(text),
                   "{:.3f},{:.6f},{:.6f},0,0,{:.3f},{:.3f},{:.3f},{:.8f},{:.8f},{:.3f},{:.1f}\n", t, std::cos(half),
                   std::sin(half), wave, 2 * wave, -0.1 * wave, 47.0 + 1e-6 * wave, 8.0 + 1e-6 * wave, 400 + wave,
                   98000 - 12 * wave);
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const auto size = static_cast<std::size_t>(argc > 1 ? std::atof(argv[1]) : 500) * 1'000'000;
  std::uint64_t rows = 0, sum = 0;
  const auto text = generate(size, rows);
  const auto bytes = ingest::as_bytes(text);
  // Agree first, race second.
  if (ingest::read_csv(bytes, "bench.csv").value().flights.at(0).attitude.size() != rows) return 1;
  bench::print_head();
  const double touch =
      bench::best_of_three([&] { sum += std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0}); });
  bench::print_row("adding up the bytes", touch, bytes.size(), rows);
  const double whole = bench::best_of_three([&] { sum += ingest::read_csv(bytes, "bench.csv").value().messages; });
  bench::print_row("read_csv: to Flight", whole, bytes.size(), rows);
  fmt::print("{:.1f} times the bare reading, {} columns, sum {}\n", whole / touch, 12, sum);
}

// Prints what `check` says about every flight file and log of the shared data (QUADSONDE_DATA), as a table.
#include <fmt/format.h>

#include "tests/replay/check_table.h"
#include "tests/support/data.h"

int main() {
  using namespace quadsonde;
  const auto data = support::data_file("");
  if (!std::filesystem::exists(data / "flights")) {
    fmt::print(stderr, "check_table: set QUADSONDE_DATA to the folder of the shared data\n");
    return 1;
  }
  auto rows = replay::check_folder(data / "flights", data);
  rows.push_back(replay::check_file(data / "flights/sph_skyhub_wind/wind-trajectory1.csv.gz", data,
                                    std::filesystem::path(QUADSONDE_MAPS) / "skyhub_exchanged.toml"));
  // The conformance files hold a handful of made-up messages each, no flight.
  for (auto& row : replay::check_folder(data / "logs", data, {"mcap-conformance"})) rows.push_back(std::move(row));
  fmt::print("{}", replay::markdown(rows));
  return 0;
}

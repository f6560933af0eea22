// How long an index of 100,000 profiles takes to answer.
//
//   bench_archive [PROFILES]
//
// Each answer is first compared with a plain look at every row; what differs gets no time. Times are the median and the
// worst of twenty of the wall, and the median of this process's CPU, with the index opened anew for each as a command
// does.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>

#include "export/archive/query.h"
#include "ingest/flight/local_frame.h"
#include "tests/bench/report.h"

namespace {

using namespace quadsonde;
using product::ArchiveEntry;
using product::ArchiveIndex;
using product::ArchiveQuery;

/// Twenty stations over ten years, half of the profiles at one of them.
std::vector<ArchiveEntry> rows(int count) {
  std::mt19937 random(11);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  std::vector<std::pair<double, double>> places;
  for (int i = 0; i < 20; ++i) places.push_back({any(-60, 70), any(-180, 180)});
  std::vector<ArchiveEntry> all;
  for (int i = 0; i < count; ++i) {
    const auto at = i % 2 ? 0 : static_cast<int>(any(0, 20));
    ArchiveEntry e;
    e.name = fmt::format("20250615T060012Z_quad-{:02}_{:012x}-{:08x}", i % 30, i, i * 7);
    e.start_s = 1.4e9 + any(0, 3.2e8), e.end_s = e.start_s + 400;
    const auto month = static_cast<int>((e.start_s - 1.4e9) / 2629800);
    e.folder = fmt::format("profiles/{}/{:02}/station-{}/{}", 2014 + month / 12, month % 12 + 1, at, e.name);
    e.flight_id = fmt::format("{:064x}-1", i), e.input_sha256 = e.flight_id.substr(0, 64), e.sha256 = e.input_sha256;
    e.input_file = fmt::format("log-{}.ulg", i), e.tool_version = "0.1.0", e.bytes = 60000;
    e.vehicle = fmt::format("quad-{:02}", i % 30), e.station = fmt::format("station-{}", at);
    e.lat_deg = places[static_cast<std::size_t>(at)].first + any(-0.01, 0.01);
    e.lon_deg = places[static_cast<std::size_t>(at)].second + any(-0.01, 0.01);
    e.surface_msl_m = 100 + at, e.bottom_msl_m = 110 + at, e.top_msl_m = e.bottom_msl_m + any(50, 900);
    e.bin_m = 10, e.bins = 30, e.good = 25, e.speed_min_m_s = any(0, 5), e.speed_max_m_s = e.speed_min_m_s + any(0, 15);
    e.quality = static_cast<product::ArchiveQuality>(i % 3 ? 0 : 1 + i % 2);
    e.superseded = i % 20 == 0;
    all.push_back(std::move(e));
  }
  return all;
}

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct Case {
  const char* what;
  ArchiveQuery query;
  std::function<bool(const ArchiveEntry&)> fits;
};

std::vector<Case> cases(const std::vector<ArchiveEntry>& all) {
  const auto lat = all[1].lat_deg, lon = all[1].lon_deg;
  std::vector<Case> list;
  const auto add = [&](const char* what, const std::function<void(ArchiveQuery&)>& set, auto fits) {
    ArchiveQuery q;
    set(q);
    list.push_back({what, q, fits});
  };
  add(
      "one day", [](auto& q) { q.from = "2020-03-01", q.to = "2020-03-02"; },
      [](const auto& e) { return e.end_s >= 1583020800 && e.start_s < 1583107200; });
  add(
      "one month", [](auto& q) { q.from = "2020-03-01", q.to = "2020-04-01"; },
      [](const auto& e) { return e.end_s >= 1583020800 && e.start_s < 1585699200; });
  add(
      "box around one station",
      [&](auto& q) {
        q.box = fmt::format("{},{},{},{}", all[4].lon_deg - 0.02, all[4].lat_deg - 0.02, all[4].lon_deg + 0.02,
                            all[4].lat_deg + 0.02);
      },
      [&](const auto& e) {
        return e.lon_deg >= all[4].lon_deg - 0.02 && e.lon_deg <= all[4].lon_deg + 0.02 &&
               e.lat_deg >= all[4].lat_deg - 0.02 && e.lat_deg <= all[4].lat_deg + 0.02;
      });
  add(
      "within 0.3 km of a place", [&](auto& q) { q.near = fmt::format("{},{}", lat, lon), q.within_km = 0.3; },
      [lat, lon](const auto& e) {
        return ingest::distance_m({lat, lon}, {e.lat_deg, e.lon_deg}) <= 300;
      });
  add(
      "one vehicle, good, wind over 18 m/s",
      [](auto& q) { q.vehicle_id = "quad-07", q.least_quality = "good", q.min_speed_m_s = 18; },
      [](const auto& e) {
        return e.vehicle == "quad-07" && e.quality == product::ArchiveQuality::good && e.speed_max_m_s >= 18;
      });
  add(
      "one station, one year", [](auto& q) { q.station_id = "station-3", q.from = "2020-01-01", q.to = "2021-01-01"; },
      [](const auto& e) { return e.station == "station-3" && e.end_s >= 1577836800 && e.start_s < 1609459200; });
  add(
      "reaches 895 m above take-off", [](auto& q) { q.min_height_m = 895; },
      [](const auto& e) { return e.top_msl_m - *e.surface_msl_m >= 895; });
  add(
      "wind over 19 m/s", [](auto& q) { q.min_speed_m_s = 19; }, [](const auto& e) { return e.speed_max_m_s >= 19; });
  add(
      "all of it together",
      [](auto& q) {
        q.station_id = "station-0", q.from = "2018-01-01", q.to = "2022-01-01", q.min_height_m = 500;
        q.least_quality = "good", q.min_speed_m_s = 15, q.max_speed_m_s = 2;
      },
      [](const auto& e) {
        return e.station == "station-0" && e.end_s >= 1514764800 && e.start_s < 1640995200 &&
               e.top_msl_m - *e.surface_msl_m >= 500 && e.quality == product::ArchiveQuality::good &&
               e.speed_max_m_s >= 15 && e.speed_min_m_s <= 2;
      });
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 100000;
  const auto file = std::filesystem::temp_directory_path() / fmt::format("bench_archive_{}.sqlite", ::getpid());
  const auto all = rows(count);
  const double made = milliseconds([&] {
    auto index = ArchiveIndex::open(file, ArchiveIndex::Mode::create);
    if (!index || !index->begin()) std::abort();
    for (const auto& row : all)
      if (!index->put(row)) std::abort();
    if (!index->commit() || !index->finish_creation()) std::abort();
  });
  fmt::print("{} profiles: index made in {:.0f} ms, {:.1f} MB\n\n{:<40} {:>8} {:>10} {:>10} {:>10}\n", count, made,
             static_cast<double>(std::filesystem::file_size(file)) * 1e-6, "query", "answers", "CPU ms", "wall ms",
             "worst ms");
  int wrong = 0;
  for (const auto& one : cases(all)) {
    std::size_t expected = 0;
    for (const auto& row : all) expected += !row.superseded && one.fits(row);
    std::vector<double> wall, cpu;
    std::size_t got = 0;
    for (int i = 0; i < 20; ++i) {
      const double before = bench::processor_seconds();
      wall.push_back(milliseconds([&] {
        auto index = ArchiveIndex::open(file, ArchiveIndex::Mode::read);
        got = product::query_index(*index, one.query)->size();
      }));
      cpu.push_back(1000 * (bench::processor_seconds() - before));
    }
    std::sort(wall.begin(), wall.end()), std::sort(cpu.begin(), cpu.end());
    if (got != expected) ++wrong, fmt::print("{:<40} {} answers where {} were expected\n", one.what, got, expected);
    if (got == expected)
      fmt::print("{:<40} {:>8} {:>10.1f} {:>10.1f} {:>10.1f}\n", one.what, got, cpu[10], wall[10], wall.back());
  }
  auto index = ArchiveIndex::open(file, ArchiveIndex::Mode::read);
  fmt::print("{:<40} {:>8} {:>10.1f}\n", "every profile (list)", count,
             milliseconds([&] { (void)product::query_index(*index, {}); }));
  fmt::print("{:<40} {:>8} {:>10.1f}\n", "extent, for the collection", 1, milliseconds([&] { (void)index->extent(); }));
  fmt::print("{:<40} {:>8} {:>10.1f}\n", "years, for the collection", 1,
             milliseconds([&] { (void)index->folders_in("profiles"); }));
  for (const auto* ending : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + ending);
  return wrong;
}

// The gate of the online drag: 30 seeds of the square with its own yaw, from a drag 30 % wrong. Prints what is reached.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::estimator {
namespace {

struct Reached {
  double rms = 0, mean = 0, worst = 0, sd = 0, latency_rms = 0;
};

Reached fly(int seeds, double wrong, Mode mode, double latency, bool latency_known) {
  Reached out;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto s = hover(300, 17);
    s.seed = static_cast<std::uint64_t>(seed);
    s.wind.toward = {-1.03, 2.82};
    s.start_height = 20;
    s.sensors.latency = latency;
    s.path.front().kind = ingest::PathLeg::Kind::square;
    s.path.front().speed = 3;
    const auto flown = ingest::simulate(s);
    auto vehicle = flown->vehicle;
    vehicle.drag.linear *= wrong;
    vehicle.between_flights_rel_sd = 0.3;
    vehicle.latency_s = latency_known ? latency : 0.05;
    vehicle.covariance(ingest::p_latency, ingest::p_latency) = latency_known ? 0 : 0.08 * 0.08;
    EstimateSettings settings;
    settings.mode = mode;
    settings.online_drag = true;
    settings.air_density_kg_m3 = vehicle.air_density_kg_m3;
    const auto series = estimate_wind(flown->flight, vehicle, settings);
    const auto& drag = *series->diagnostics.online_drag;
    const double error = drag.factor * wrong - 1;
    out.rms += error * error / seeds, out.mean += error / seeds, out.sd += drag.sd / seeds;
    out.worst = std::max(out.worst, std::abs(error));
    out.latency_rms += std::pow(drag.latency - latency, 2) / seeds;
  }
  out.rms = std::sqrt(out.rms), out.latency_rms = std::sqrt(out.latency_rms);
  return out;
}

TEST(OnlineDragStudy, RmsOverThirtySeedsEndsWithinFivePercent) {
  constexpr int seeds = 30;
  for (const auto& [latency, known] : {std::pair{0.0, true}, {0.2, true}, {0.0, false}, {0.2, false}})
    for (const Mode mode : {Mode::smoothed, Mode::causal})
      for (const double wrong : {0.7, 1.3}) {
        const auto r = fly(seeds, wrong, mode, latency, known);
        fmt::print(
            "latency {:.1f} s {:<7} {:<8} start x {:.1f}: rms {:4.1f} %, mean {:+.1f} %, worst {:.1f} %, stated "
            "{:.1f} %, latency {:.0f} ms\n",
            latency, known ? "known" : "unknown", name(mode), wrong, 100 * r.rms, 100 * r.mean, 100 * r.worst,
            100 * r.sd, 1000 * r.latency_rms);
        EXPECT_LE(r.rms, 0.05);
      }
}

}  // namespace
}  // namespace quadsonde::estimator

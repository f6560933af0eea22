// A 20-minute flight, attitude at 50 Hz and velocity at 10 Hz: what a step, a pass, the whole estimate and the profile
// cost on one core, beside the classic filter on the same steps. Agreement first, then time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "estimator/filter/classic_filter.h"
#include "estimator/smoother/estimate.h"
#include "estimator/smoother/passes.h"
#include "ingest/motion/simulator.h"
#include "profiles/make_profile.h"
#include "tests/bench/report.h"

namespace {

using namespace quadsonde;

/// Processor time, so that another program on the machine is not measured too.
double best_of(int runs, const std::function<void()>& work) {
  double best = 1e9;
  for (int i = 0; i < runs; ++i) {
    const double start = bench::processor_seconds();
    work();
    best = std::min(best, bench::processor_seconds() - start);
  }
  return best;
}

ingest::Scenario twenty_minutes() {
  ingest::Scenario s;
  s.vehicle = ingest::published_vehicle();
  s.wind.model = ingest::WindField::Model::jet;
  ingest::PathLeg up;
  up.kind = ingest::PathLeg::Kind::climb;
  up.speed = 1;
  up.to_height = 610;
  up.heading = {ingest::HeadingRule::Kind::turning, 0, 20};
  auto down = up;
  down.to_height = 10;
  s.path = {up, down};
  s.sensors.attitude_rate = 50;
  return s;
}

void line(const char* what, double seconds, double unit, const char* unit_name, double limit) {
  fmt::print("{:<58} {:>9.3f} {:<3} limit {:g} {}\n", what, seconds / unit, unit_name, limit,
             seconds / unit <= limit ? "" : "ABOVE");
}

}  // namespace

int main() {
  const auto flown = ingest::simulate(twenty_minutes());
  estimator::StepSettings step_settings;
  step_settings.drag = flown->vehicle.drag.linear;
  const auto steps = estimator::make_steps(flown->flight, step_settings);
  const double n = static_cast<double>(steps.steps.size());
  estimator::PassSettings pass;
  pass.model.drag = flown->vehicle.drag;
  pass.trim_covariance = 0.26 * Eigen::Matrix2d::Identity();
  fmt::print("{} attitudes, {} velocity steps\n", flown->flight.attitude.size(), steps.steps.size());

  // Agreement: the filter run by hand is the forward pass.
  estimator::WindFilter<double> filter(pass.model, pass.limits);
  const auto by_hand = [&] {
    filter = estimator::WindFilter<double>(pass.model, pass.limits);
    filter.start(steps.steps[0].v, pass.trim, pass.trim_covariance);
    for (std::size_t k = 1; k < steps.steps.size(); ++k) filter.step(steps.steps[k].input, steps.steps[k].v, steps.steps[k].variance);
  };
  by_hand();
  pass.jump_test = false;
  const auto forward = estimator::run_forward(steps.steps, pass);
  if ((filter.state() - forward.x).norm() > 1e-9) {
    fmt::print("the filter and the forward pass disagree\n");
    return 1;
  }

  const double step = best_of(5, by_hand) / n;
  pass.model.trim_is_state = true;
  estimator::ClassicFilter classic{estimator::ClassicConstants{}};
  const double classic_step = best_of(5, [&] {
    for (const auto& s : steps.steps) classic.step({-s.input.slope.x(), -s.input.slope.y(), 1}, s.v);
  }) / n;
  pass.keep_trace = true;
  const double two_passes = best_of(5, [&] {
    auto run = estimator::run_forward(steps.steps, pass);
    estimator::smooth(run.trace);
  });
  const double laying = best_of(5, [&] { estimator::make_steps(flown->flight, step_settings); });
  ingest::Result<estimator::WindSeries> series = ingest::fail(ingest::Kind::no_answer, "not run");
  estimator::EstimateSettings settings;
  settings.takeoff = ingest::MslHeight{150};
  const double whole = best_of(3, [&] { series = estimator::estimate_wind(flown->flight, flown->vehicle, settings); });
  const double profile = best_of(5, [&] { (void)profiles::make_profile(*series); });
  line("causal step with its consider sensitivities", step, 1e-6, "us", 4);
  fmt::print("{:<58} {:>9.3f} us  (ratio {:.0f})\n", "classic filter, step", classic_step / 1e-6, step / classic_step);
  line("laying out the steps", laying, 1e-3, "ms", 50);
  line("one forward and backward pass", two_passes, 1e-3, "ms", 50);
  line("the whole estimate with its likelihood search", whole, 1, "s", 0.5);
  line("the profile, once the wind is estimated", profile, 1e-3, "ms", 10);
  fmt::print("{:<58} {:>9} B   limit 2048\n", "memory per step between the passes", sizeof(estimator::SmoothedStep));
  return 0;
}

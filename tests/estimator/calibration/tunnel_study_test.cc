// How good a calibration is that trusts its stated winds to 3 %: over 100 seeds, printed.
#include <fmt/format.h>

#include <array>

#include "ingest/motion/random.h"
#include "tests/estimator/calibration/made_runs.h"

namespace quadsonde {
namespace {

using estimator::calibrate_tunnel;
using estimator::drag_at;
using support::MadeRun;

struct Score {
  double squares = 0, errors = 0, sds = 0;
  int inside = 0, count = 0;
  void add(double relative_error, double relative_sd) {
    squares += relative_error * relative_error, errors += relative_error, sds += relative_sd * relative_sd;
    inside += std::abs(relative_error) <= 1.96 * relative_sd;
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
  double coverage() const { return static_cast<double>(inside) / count; }
};

struct Study {
  std::array<Score, 7> at;  // 2 to 8 m/s
  Score all;
  int quadratic = 0, refused = 0, noted = 0;
};

/// Runs at 0, 2, 4, 6 and 8 m/s, one turn of 60 s each; each run's true wind is drawn with the stated 3 %.
Study study(const ingest::DragLaw<double>& drag, int seeds) {
  Study out;
  ingest::Gaussian normal(20260);
  for (int seed = 0; seed < seeds; ++seed) {
    std::vector<estimator::TunnelRun> runs;
    for (const double speed : {0.0, 2.0, 4.0, 6.0, 8.0}) {
      MadeRun made;
      made.stated = speed;
      made.flown = speed * (1 + 0.03 * normal());
      made.drag = drag;
      made.seed = static_cast<std::uint64_t>(seed * 10 + 1 + static_cast<int>(speed));
      runs.push_back(support::fly(made));
    }
    const auto found = calibrate_tunnel(runs, support::published_settings());
    if (!found) {
      ++out.refused;
      continue;
    }
    out.quadratic += found->quadratic;
    out.noted += !found->notes.empty();
    for (std::size_t i = 0; i < out.at.size(); ++i) {
      const double speed = 2 + static_cast<double>(i), truth = drag.linear + drag.quadratic * speed;
      const auto c = drag_at(found->vehicle, speed);
      out.at[i].add(c.value / truth - 1, c.sd / truth);
      out.all.add(c.value / truth - 1, c.sd / truth);
    }
  }
  return out;
}

void print(const char* title, const Study& s) {
  fmt::print("{}: {} calibrations, {} with the quadratic term, {} refused, {} with a note\n", title, s.at[0].count, s.quadratic, s.refused, s.noted);
  fmt::print("  airspeed   c rms   mean   stated sd   inside 95 %\n");
  for (std::size_t i = 0; i < s.at.size(); ++i)
    fmt::print("  {:5d} m/s {:6.2f} % {:+5.2f} % {:7.2f} %     {:.3f}\n", i + 2, 100 * s.at[i].rms(), 100 * s.at[i].errors / s.at[i].count,
               100 * std::sqrt(s.at[i].sds / s.at[i].count), s.at[i].coverage());
  fmt::print("  2 to 8 m/s {:5.2f} %         {:7.2f} %     {:.3f}\n", 100 * s.all.rms(), 100 * std::sqrt(s.all.sds / s.all.count), s.all.coverage());
}

TEST(TunnelStudy, DragIsGoodTo3PercentAndItsIntervalsHoldWhatTheyPromise) {
  const auto s = study({0.2570, 0.004, 0, 0}, 100);
  print("delta .2570, kappa .004", s);
  EXPECT_EQ(s.refused, 0);
  EXPECT_LT(s.all.rms(), 0.03);
  EXPECT_GE(s.all.coverage(), 0.92);
  EXPECT_LE(s.all.coverage(), 0.98);
}

TEST(TunnelStudy, AlsoWhereTheDragIsLinearOrBendsMore) {
  const auto straight = study({0.2570, 0, 0, 0}, 30);
  print("delta .2570, kappa 0", straight);
  const auto bent = study({0.20, 0.02, 0, 0}, 30);
  print("delta .20, kappa .02", bent);
  for (const auto* s : {&straight, &bent}) {
    EXPECT_EQ(s->refused, 0);
    EXPECT_LT(s->all.rms(), 0.03);
    EXPECT_GE(s->all.coverage(), 0.90);  // 30 seeds: the bound of 100, widened
  }
}

}  // namespace
}  // namespace quadsonde

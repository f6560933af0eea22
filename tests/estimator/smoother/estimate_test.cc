#include "estimator/smoother/estimate.h"

#include <gtest/gtest.h>

#include "tests/estimator/smoother/made_flights.h"

namespace quadsonde::estimator {
namespace {

using ingest::Kind;

bool has_wind(const WindPoint& p) { return std::holds_alternative<WindEstimate>(p.wind); }
const WindEstimate& wind(const WindPoint& p) { return std::get<WindEstimate>(p.wind); }

EstimateSettings mode(Mode m) {
  EstimateSettings s;
  s.mode = m;
  return s;
}

TEST(EstimateWind, FindsTheWindOfATurningHoverInEveryMode) {
  const auto flown = *ingest::simulate(hover(180));
  // The smoothed and causal figures of design section 10 with room for one seed; classic is only to be there.
  EXPECT_LT(rmse(estimated(flown), flown.truth, 0), 0.22);
  EXPECT_LT(rmse(estimated(flown, mode(Mode::causal)), flown.truth, 20), 0.35);
  EXPECT_LT(rmse(estimated(flown, mode(Mode::classic)), flown.truth, 90), 1.0);
}

TEST(EstimateWind, DoesNotDependOnWhereTheLogsClockBegins) {
  const auto flown = *ingest::simulate(hover(60));
  auto shifted = flown.flight;
  const auto shift = ingest::seconds(1.7e9);
  const auto move = [&](auto& stream) {
    for (auto& t : stream.time) t = t + shift;
  };
  move(shifted.attitude), move(shifted.velocity), move(shifted.position), move(shifted.height_msl);
  const auto a = estimate_wind(flown.flight, flown.vehicle), b = estimate_wind(shifted, flown.vehicle);
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->points.size(), b->points.size());
  for (std::size_t i = 0; i < a->points.size(); ++i) {
    ASSERT_EQ(has_wind(a->points[i]), has_wind(b->points[i]));
    if (!has_wind(a->points[i])) continue;
    EXPECT_EQ(wind(a->points[i]).v_NA_N, wind(b->points[i]).v_NA_N) << i;
    EXPECT_EQ(wind(a->points[i]).covariance, wind(b->points[i]).covariance) << i;
    EXPECT_EQ((b->points[i].time - a->points[i].time), shift);
  }
}

TEST(EstimateWind, SaysThatATrimIsUnobservedAtAFixedHeadingAndItsIntervalHoldsTheTruth) {
  auto s = hover(120, 0);
  s.sensors.trim_roll_deg = 1.5;
  s.sensors.trim_pitch_deg = -1.2;
  const auto flown = *ingest::simulate(s);
  for (const auto m : {Mode::smoothed, Mode::causal}) {
    const auto series = estimated(flown, mode(m));
    EXPECT_LT(series.diagnostics.heading_index, 0.4);
    EXPECT_FALSE(series.diagnostics.trim_estimated);
    int inside = 0, count = 0;
    for (std::size_t i = 0; i < series.points.size(); ++i) {
      const auto& p = series.points[i];
      if (!has_wind(p)) continue;
      ASSERT_TRUE(p.reasons.has(Reason::trim_unobserved));
      ASSERT_EQ(p.quality, Quality::doubtful);
      const Eigen::Vector2d e = wind(p).v_NA_N - flown.truth[i].v_NA_N.head<2>();
      // 3 degrees of trim prior are 2.0 m/s of wind.
      EXPECT_GT(std::sqrt(wind(p).covariance(0, 0)), 1.9);
      inside += e.dot(wind(p).covariance.inverse() * e) < 5.99;
      ++count;
    }
    EXPECT_GT(count, 1000);
    EXPECT_EQ(inside, count);
  }
}

TEST(EstimateWind, FindsTheTrimOnceTheNoseTurns) {
  auto s = hover(180);
  s.sensors.trim_roll_deg = 2;
  s.sensors.trim_pitch_deg = -6;
  const auto flown = *ingest::simulate(s);
  const auto series = estimated(flown);
  EXPECT_TRUE(series.diagnostics.trim_estimated);
  EXPECT_NEAR(series.diagnostics.trim_deg.x(), 2, 0.15);
  EXPECT_NEAR(series.diagnostics.trim_deg.y(), -6, 0.15);
  EXPECT_LT(rmse(series, flown.truth, 0), 0.22);
  for (const auto& p : series.points) EXPECT_FALSE(p.reasons.has(Reason::trim_unobserved));
}

TEST(EstimateWind, CarriesTheClassPriorIntoItsInterval) {
  const auto flown = *ingest::simulate(hover(120));
  const auto series = estimate_wind(flown.flight, ingest::class_prior());
  ASSERT_TRUE(series);
  int inside = 0, count = 0;
  for (std::size_t i = 0; i < series->points.size(); ++i) {
    const auto& p = series->points[i];
    if (!has_wind(p)) continue;
    ASSERT_TRUE(p.reasons.has(Reason::uncalibrated));
    const Eigen::Vector2d e = wind(p).v_NA_N - flown.truth[i].v_NA_N.head<2>();
    inside += e.dot(wind(p).covariance.inverse() * e) < 5.99;
    // 35 % of the drag are 35 % of the wind, along it.
    const double along = wind(p).v_NA_N.dot(wind(p).covariance * wind(p).v_NA_N) / wind(p).v_NA_N.squaredNorm();
    EXPECT_GT(std::sqrt(along), 0.25 * wind(p).v_NA_N.norm()) << i;
    ++count;
  }
  ASSERT_GT(count, 1000);
  EXPECT_GT(inside, 0.93 * count) << "the published vehicle is within one sd of the class";
}

TEST(EstimateWind, HasNoEstimateUntilTheWindIsToldFromTheStartValues) {
  const auto flown = *ingest::simulate(hover(60));
  const auto series = estimated(flown, mode(Mode::causal));
  ASSERT_FALSE(has_wind(series.points[0]));
  EXPECT_EQ(std::get<NoEstimate>(series.points[0].wind).reason, Reason::converging);
  EXPECT_EQ(series.points[0].quality, Quality::none);
  std::size_t first = 0;
  while (!has_wind(series.points[first])) ++first;
  EXPECT_GT(first, 5u);
  EXPECT_LT(first, 100u);
  for (std::size_t i = first; i < series.points.size(); ++i) EXPECT_TRUE(has_wind(series.points[i])) << i;
}

TEST(EstimateWind, NeverHasAValueWhereThereIsNoAttitude) {
  auto flown = *ingest::simulate(hover(120));
  auto& attitude = flown.flight.attitude;
  ingest::Stream<Eigen::Quaterniond> holed;
  for (std::size_t i = 0; i < attitude.size(); ++i)
    if (attitude.time[i] < at(50) || attitude.time[i] > at(56)) holed.push(attitude.time[i], attitude.value[i]);
  attitude = holed;
  for (const auto m : {Mode::smoothed, Mode::causal, Mode::classic}) {
    const auto series = estimated(flown, mode(m));
    for (const auto& p : series.points) {
      const double t = ingest::to_seconds(p.time - at(0));
      if (t < 50.05 || t > 55.95) continue;
      ASSERT_FALSE(has_wind(p)) << t << " in mode " << name(m);
      EXPECT_EQ(std::get<NoEstimate>(p.wind).reason, Reason::no_attitude);
    }
    EXPECT_TRUE(has_wind(series.points.back()));
  }
}

/// Drops the velocities of an interval.
void gap(ingest::Flight& flight, double from, double to) {
  ingest::VelocityStream kept;
  for (std::size_t i = 0; i < flight.velocity.size(); ++i)
    if (flight.velocity.time[i] < at(from) || flight.velocity.time[i] > at(to)) {
      kept.push(flight.velocity.time[i], flight.velocity.value[i]);
      kept.sd.push_back(flight.velocity.sd[i]);
    }
  flight.velocity = kept;
}

TEST(EstimateWind, RestartsAfterAGapInTheVelocity) {
  auto flown = *ingest::simulate(hover(120));
  gap(flown.flight, 60, 75);
  const auto series = estimated(flown);
  EXPECT_EQ(series.diagnostics.restarts, 1);
  ASSERT_TRUE(series.trace);
  EXPECT_EQ(series.trace->breaks.size(), 1u);
  for (const auto& p : series.points) EXPECT_FALSE(p.time > at(60) && p.time < at(75)) << "no points where no data is";
}

TEST(EstimateWind, CoastsThroughAGapAsLongAsItsSettingAllows) {
  auto flown = *ingest::simulate(hover(120));
  gap(flown.flight, 60, 63);
  EXPECT_EQ(estimated(flown).diagnostics.restarts, 1);
  EstimateSettings patient;
  patient.max_gap_s = 5;
  EXPECT_EQ(estimated(flown, patient).diagnostics.restarts, 0);
}

TEST(EstimateWind, IsNotMisledByASingleVelocityFarOff) {
  auto flown = *ingest::simulate(hover(120));
  const auto clean = estimated(flown);
  for (std::size_t i = 300; i < 1200; i += 150) flown.flight.velocity.value[i] += Eigen::Vector3d(8, -5, 0);
  const auto spoilt = estimated(flown);
  EXPECT_GE(spoilt.diagnostics.rejected, 6);
  EXPECT_LT(rmse(spoilt, flown.truth, 0), rmse(clean, flown.truth, 0) + 0.03);
}

TEST(EstimateWind, FollowsAStepOfTheWindFromBothSides) {
  auto s = hover(160);
  s.wind.sigma_u = 0.1;
  s.wind.steps = {{100, Eigen::Vector2d(-3.8, 0)}};
  const auto flown = *ingest::simulate(s);
  const auto series = estimated(flown);
  EXPECT_EQ(series.diagnostics.jumps, 1);
  // Design section 4: 0.081 m/s over a flight with two steps at sigma_u .1, inflated half a second before detection.
  EXPECT_LT(rmse(series, flown.truth, 0), 0.2);
  EstimateSettings blind;
  blind.jump_test = false;
  EXPECT_GT(rmse(estimated(flown, blind), flown.truth, 0), 1.1 * rmse(series, flown.truth, 0));
}

TEST(EstimateWind, TakesTheLatencyOffItsTimes) {
  auto s = hover(60);
  s.sensors.latency = 0.2;
  auto flown = *ingest::simulate(s);
  flown.vehicle.latency_s = 0.2;
  const auto series = estimated(flown);
  for (std::size_t i = 0; i < series.points.size(); ++i)
    ASSERT_EQ(series.points[i].time, flown.flight.velocity.time[i] - ingest::seconds(0.2));
}

TEST(EstimateWind, PutsHeightsPlacesAndUtcWhereTheyAreKnown) {
  auto flown = *ingest::simulate(hover(60));
  EstimateSettings settings;
  auto p = estimated(flown, settings).points[300];
  EXPECT_TRUE(p.height_msl && p.utc && p.place);
  EXPECT_FALSE(p.height_agl) << "nobody told the take-off height";
  settings.takeoff = ingest::MslHeight{150};
  p = estimated(flown, settings).points[300];
  EXPECT_NEAR(p.height_agl->m, p.height_msl->m - 150, 1e-12);
  flown.flight.clock = {};
  flown.flight.height_msl = {};
  flown.flight.position = {};
  p = estimated(flown, settings).points[300];
  EXPECT_FALSE(p.height_msl || p.height_agl || p.utc || p.place);
}

TEST(EstimateWind, RefusesAFlightWithoutAttitudeOrVelocity) {
  auto flown = *ingest::simulate(hover(10));
  auto blind = flown.flight;
  blind.attitude = {};
  auto r = estimate_wind(blind, flown.vehicle);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().kind, Kind::missing);
  blind = flown.flight;
  blind.velocity = {};
  r = estimate_wind(blind, flown.vehicle);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().kind, Kind::missing);
  EXPECT_FALSE(r.error().hint.empty());
  blind = flown.flight;
  for (auto& t : blind.attitude.time) t = t + ingest::seconds(1000);  // never at the same time
  r = estimate_wind(blind, flown.vehicle);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().kind, Kind::no_answer);
}

TEST(EstimateWind, WidensForTheDragOfAnotherDay) {
  auto flown = *ingest::simulate(hover(120));
  const auto known = estimated(flown);
  flown.vehicle.between_flights_rel_sd = 0.06;
  const auto moving = estimated(flown);
  const auto& a = wind(known.points[600]);
  const auto& b = wind(moving.points[600]);
  EXPECT_EQ(a.v_NA_N, b.v_NA_N);
  const Eigen::Vector2d along = a.v_NA_N.normalized();
  const double added = along.dot((b.covariance - a.covariance) * along);
  EXPECT_NEAR(std::sqrt(added), 0.06 * a.v_NA_N.norm(), 0.2 * 0.06 * a.v_NA_N.norm())
      << "6 % of the drag, 6 % of the wind";
}

}  // namespace
}  // namespace quadsonde::estimator

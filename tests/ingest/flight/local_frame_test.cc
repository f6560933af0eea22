#include "ingest/flight/local_frame.h"

#include <gtest/gtest.h>

#include <cmath>

namespace quadsonde::ingest {
namespace {

constexpr GeoPoint toulouse{43.5657, 1.4815};
constexpr GeoPoint fiji{-17.7, 179.9999};

TEST(LocalFrame, RoundTripsWithinANanometre) {
  for (const auto origin : {toulouse, fiji, GeoPoint{78.9, 11.9}}) {
    const LocalFrame frame(origin, 180);
    for (const Eigen::Vector3d& p_NB_N :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(120, -340, -95), Eigen::Vector3d(-8000, 15000, -3000)}) {
      const auto [point, height] = frame.from_ned(p_NB_N);
      EXPECT_LT((frame.to_ned(point, height) - p_NB_N).norm(), 1e-8) << "GeographicLib promises 2e-10 m near the Earth";
    }
  }
}

TEST(LocalFrame, PointsNorthEastAndDown) {
  const LocalFrame frame(toulouse, 0);
  // One second of arc of latitude is 30.86 m at this latitude (meridian radius 6367 km on WGS84).
  const Eigen::Vector3d north = frame.to_ned({toulouse.lat_deg + 1 / 3600.0, toulouse.lon_deg}, 0);
  EXPECT_NEAR(north.x(), 30.86, 0.01);
  EXPECT_NEAR(north.y(), 0, 1e-6);
  const Eigen::Vector3d east = frame.to_ned({toulouse.lat_deg, toulouse.lon_deg + 1 / 3600.0}, 0);
  EXPECT_NEAR(east.y(), 30.92 * std::cos(toulouse.lat_deg * M_PI / 180), 0.06);
  EXPECT_NEAR(frame.to_ned(toulouse, 25).z(), -25, 1e-9);
}

TEST(Distance, IsTheShortestWayAlsoAcrossTheDateLine) {
  EXPECT_EQ(distance_m(toulouse, toulouse), 0);
  // A quarter of the meridian of WGS84, and one degree of the equator.
  EXPECT_NEAR(distance_m({0, 0}, {90, 0}), 10001965.729, 0.01);
  EXPECT_NEAR(distance_m({0, 179.5}, {0, -179.5}), 6378137.0 * M_PI / 180, 0.01);
}

Flight flying(const GeoPoint& origin, const Eigen::Vector3d& v_NB_N, double rate_hz, double log_rate_hz) {
  Flight flight;
  const LocalFrame frame(origin, 150);
  const int count = static_cast<int>(10 * log_rate_hz);
  for (int i = 0; i < count; ++i) {
    const double t = i / log_rate_hz, t_seen = std::floor(t * rate_hz + 1e-9) / rate_hz;
    const auto [point, height] = frame.from_ned(v_NB_N * t_seen);
    const LogTime time = LogTime{} + seconds(t);
    flight.position.push(time, point);
    flight.height_msl.push(LogTime{} + seconds(t), MslHeight{150 - v_NB_N.z() * t});
  }
  return flight;
}

TEST(DifferentiatePosition, FindsTheVelocityOfASteadyFlight) {
  const Eigen::Vector3d v_NB_N(3.2, -4.1, -1.5);
  for (const auto origin : {toulouse, fiji}) {
    const auto velocity = differentiate_position(flying(origin, v_NB_N, 10, 10));
    ASSERT_EQ(velocity.size(), 100u);
    EXPECT_EQ(velocity.origin, VelocityOrigin::differentiated);
    EXPECT_TRUE(velocity.sd.empty()) << "what the position's noise makes of it is not known";
    for (const auto& v : velocity.value) EXPECT_LT((v - v_NB_N).norm(), 1e-4) << "curvature of the Earth over 50 m";
  }
}

TEST(DifferentiatePosition, CountsARepeatedPositionOnce) {
  const Eigen::Vector3d v_NB_N(3, 4, 0);
  const auto velocity = differentiate_position(flying(toulouse, v_NB_N, 5, 50));
  ASSERT_GE(velocity.size(), 48u);
  ASSERT_LE(velocity.size(), 52u);
  for (std::size_t i = 2; i + 4 < velocity.size(); ++i)
    EXPECT_NEAR(velocity.value[i].head<2>().norm(), 5, 1e-3) << i << ": a stair would swing between 0 and 50 m/s";
}

TEST(DifferentiatePosition, PrefersTheLogsOwnLocalPosition) {
  Flight flight = flying(toulouse, {1, 0, 0}, 10, 10);
  for (std::size_t i = 0; i < flight.position.size(); ++i)
    flight.local_position.push(flight.position.time[i], Eigen::Vector3d(0, 0.2 * static_cast<double>(i), -5));
  const auto velocity = differentiate_position(flight);
  EXPECT_LT((velocity.value[50] - Eigen::Vector3d(0, 2, 0)).norm(), 1e-12);
}

TEST(DifferentiatePosition, HasNoVelocityOfTwoPositionsOrNone) {
  Flight flight;
  EXPECT_TRUE(differentiate_position(flight).empty());
  flight.position.push(LogTime{0}, toulouse);
  flight.position.push(LogTime{1'000'000'000}, toulouse);
  EXPECT_TRUE(differentiate_position(flight).empty());
}

}  // namespace
}  // namespace quadsonde::ingest

// One recorded flight in six formats: the same Flight within the step of each format, and the same mean wind.
// The six files were made from one PX4 log; PROVENANCE.md of the log samples tells what each of them keeps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "estimator/smoother/estimate.h"
#include "export/pipeline/load.h"
#include "ingest/flight/rotation.h"
#include "ingest/motion/vehicle.h"
#include "ingest/ulog/topic_reader.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using ingest::Flight;
using ingest::LogTime;

constexpr double degree = std::numbers::pi / 180;

/// What a format keeps of the flight: its steps, and which of the log's samples.
struct Format {
  const char* file;
  double attitude_deg, velocity_m_s, height_m, position_deg;  ///< largest difference that rounding can make
  bool thinned_attitude = false;  ///< the attitude stands at the 8 Hz of the local position only
  bool fused_velocity = false;    ///< the velocity is the filter's of the local position, not the receiver's
  const char* why = "";
};

/// For the names of tests: without it they would show the bytes of addresses, which change with every run.
void PrintTo(const Format& format, std::ostream* out) { *out << format.file; }

// Each step is half the last digit, on every axis that goes into the value.
constexpr Format formats[] = {
    {"derived/esc_flight.csv", 0.01, 9e-5, 6e-4, 6e-8, true, true, "7 digits of q, 4 decimals of v, 3 of the height"},
    {"derived/esc_flight.bin", 0.012, 2e-3, 6e-3, 6e-8, false, false, "angles and course 0.01 deg, speed 1 mm/s, 1 cm"},
    {"derived/esc_flight_v2.tlog", 1e-4, 8e-3, 6e-4, 6e-8, false, false,
     "float q, 1 cm/s and 0.01 deg, 1 mm, 1e-7 deg"},
    {"derived/esc_flight.data", 0.007, 1e-2, 6e-4, 6e-8, false, false, "q 2^-15, 1 cm/s on Earth-fixed axes, 1 mm"},
    {"mcap/esc_flight_json_lz4.mcap", 1e-4, 1e-6, 1e-6, 1e-9, false, false, "floats printed as doubles"},
    {"mcap/esc_flight_protobuf_zstd.mcap", 1e-4, 1e-6, 1e-6, 1e-9, true, false, "doubles, attitude at 8 Hz"},
};

std::string name_of(const Format& format) { return std::filesystem::path(format.file).filename().string(); }

product::FlightPart part_of(const std::string& file) {
  auto log = product::load_log(support::data_file("logs/" + file), {});
  if (!log) throw std::runtime_error(ingest::to_string(log.error()));
  return log->parts.at(0);
}

/// Difference of the two logs' clocks, other minus ours, so that equal samples have equal times: every format has the
/// local position at the log's own times; the sample of ours that is the first of the other's tells it.
ingest::Duration clock_difference(const Flight& other, const Flight& ours) {
  const auto& theirs = other.local_position;
  auto best = ours.local_position.time.front();
  double smallest = 1e9;
  for (std::size_t k = 0; k < ours.local_position.size(); ++k) {
    const double apart = (ours.local_position.value[k] - theirs.value.front()).norm();
    if (apart < smallest) smallest = apart, best = ours.local_position.time[k];
  }
  return theirs.time.front() - best;
}

struct Agreement {
  std::size_t compared = 0;
  double largest = 0;
};

/// Whether a sample stands for the one nearest in time, or repeats the last one before it, as a table's rows do.
enum class Like { nearest, last };

/// Samples of the other flight against their like in ours, at most `slack_s` away.
template <class S, class Difference>
Agreement compare(const S& other, const S& ours, ingest::Duration clock, Like like, double slack_s,
                  Difference difference) {
  Agreement agreement;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const auto t = other.time[i] - clock;
    const auto at = last_at_or_before(ours, t);
    if (at < 0 && like == Like::last) continue;
    auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at));
    if (like == Like::nearest && k + 1 < ours.size() && ours.time[k + 1] - t < t - ours.time[k]) ++k;
    if (std::abs(ingest::to_seconds(ours.time[k] - t)) > slack_s) continue;
    ++agreement.compared;
    agreement.largest = std::max(agreement.largest, difference(other.value[i], ours.value[k]));
  }
  return agreement;
}

/// vehicle_local_position's velocity, which the Flight of the ULog does not take.
ingest::VelocityStream fused_velocity() {
  const auto bytes = support::read_bytes(support::data_file("logs/ulog/esc_status_log.ulg"));
  const auto log = ingest::ulog::read(bytes, "esc_status_log.ulg", {}).value();
  const ingest::ulog::TopicReader reader(log, *ingest::ulog::find_topic(log, "vehicle_local_position"));
  const auto vx = reader.column("vx"), vy = reader.column("vy"), vz = reader.column("vz");
  ingest::VelocityStream stream;
  for (std::size_t i = 0; i < reader.size(); ++i) {
    const auto row = reader.row(i);
    stream.push(*reader.time(row),
                {ingest::ulog::real(row, vx), ingest::ulog::real(row, vy), ingest::ulog::real(row, vz)});
  }
  return stream;
}

/// The ULog's flight with no more than what the format keeps of it.
Flight reduced(Flight flight, const Format& format) {
  if (format.fused_velocity) flight.velocity = fused_velocity();
  if (!format.thinned_attitude) return flight;
  ingest::Stream<Eigen::Quaterniond> thin;
  // The table and the poses hold the last attitude before each local position.
  for (const auto t : flight.local_position.time)
    if (const auto at = last_at_or_before(flight.attitude, t); at >= 0)
      thin.push(t, flight.attitude.value[static_cast<std::size_t>(at)]);
  flight.attitude = std::move(thin);
  return flight;
}

struct MeanWind {
  Eigen::Vector2d v_NA_N = Eigen::Vector2d::Zero(), sd = Eigen::Vector2d::Zero();
};

/// Mean over the time from one instant to another, with the mean of the stated sd.
MeanWind mean_wind(const Flight& flight, LogTime from, LogTime to) {
  const auto series = estimator::estimate_wind(ingest::cut(flight, from, to), ingest::class_prior());
  if (!series) throw std::runtime_error(ingest::to_string(series.error()));
  MeanWind mean;
  double total = 0;
  const auto& points = series->points;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const auto* wind = std::get_if<estimator::WindEstimate>(&points[i].wind);
    if (!wind) continue;
    const double dt = ingest::to_seconds(points[i + 1].time - points[i].time);
    mean.v_NA_N += dt * wind->v_NA_N;
    mean.sd += dt * wind->covariance.diagonal().cwiseSqrt();
    total += dt;
  }
  mean.v_NA_N /= total, mean.sd /= total;
  return mean;
}

class OneFlightManyFormats : public ::testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.csv");
    ulog = part_of("ulog/esc_status_log.ulg");
    other = part_of(GetParam().file);
    clock = clock_difference(*other.boot, *ulog.boot);
  }
  product::FlightPart ulog, other;
  ingest::Duration clock{};
};

TEST_P(OneFlightManyFormats, IsTheSameFlightWithinTheStepOfTheFormat) {
  const auto& format = GetParam();
  const auto &a = *other.boot, &b = *ulog.boot;
  constexpr double slack = 0.0021;  // tlog and .data have whole milliseconds
  // Fixes are placed by their UTC, whose pairs spread by 23 ms; they are 200 ms apart. A table's rows repeat them.
  const auto like = format.fused_velocity ? Like::last : Like::nearest;
  const double fix_slack = format.fused_velocity ? 1.1 : 0.03;
  const auto attitude =
      compare(a.attitude, reduced(b, format).attitude, clock, Like::nearest, slack,
              [](const auto& x, const auto& y) { return x.angularDistance(y.normalized()) / degree; });
  const auto down = a.velocity.source.find("down of") != std::string::npos ? 2 : 3;  // the tlog's down is the filter's
  const auto velocity = compare(a.velocity, format.fused_velocity ? fused_velocity() : b.velocity, clock, Like::nearest,
                                format.fused_velocity ? slack : fix_slack,
                                [&](const auto& x, const auto& y) { return (x - y).head(down).norm(); });
  const auto height = compare(a.height_msl, b.height_msl, clock, like, fix_slack,
                              [](const auto& x, const auto& y) { return std::abs(x.m - y.m); });
  const auto position = compare(a.position, b.position, clock, like, fix_slack, [](const auto& x, const auto& y) {
    return std::max(std::abs(x.lat_deg - y.lat_deg), std::abs(x.lon_deg - y.lon_deg));
  });
  fmt::print(
      "{:<32} attitude {:.5f} deg of {}, velocity {:.5f} m/s of {}, height {:.5f} m of {}, place {:.2e} deg of {}"
      "; step: {}\n",
      name_of(format), attitude.largest, attitude.compared, velocity.largest, velocity.compared, height.largest,
      height.compared, position.largest, position.compared, format.why);
  EXPECT_LE(attitude.largest, format.attitude_deg);
  EXPECT_LE(velocity.largest, format.velocity_m_s);
  EXPECT_LE(height.largest, format.height_m);
  EXPECT_LE(position.largest, format.position_deg);
  EXPECT_GE(attitude.compared, a.attitude.size() * 95 / 100);
  EXPECT_GE(velocity.compared, a.velocity.size() * 95 / 100);
  EXPECT_GE(height.compared, a.height_msl.size() * 95 / 100);
  EXPECT_GE(position.compared, a.position.size() * 95 / 100);
}

TEST_P(OneFlightManyFormats, StandsAtTheSameUtc) {
  // Whole milliseconds of GPS time, and a table that states its UTC, against the median of the autopilot's own pairs.
  const auto by_utc = *ulog.boot->clock.utc_minus_log - *other.boot->clock.utc_minus_log;
  const double apart = ingest::to_seconds(by_utc - clock);
  fmt::print("{:<32} UTC differs by {:.4f} s, known to {:.2f} s ({})\n", name_of(GetParam()), apart,
             other.boot->clock.uncertainty_s, other.boot->clock.source);
  EXPECT_LT(std::abs(apart), 0.025) << "the receiver's times spread by 23 ms (LOGS.md, section 2)";
  EXPECT_LT(std::abs(apart), other.boot->clock.uncertainty_s);
}

TEST_P(OneFlightManyFormats, HasTheSameMeanWind) {
  const auto& format = GetParam();
  const auto from = std::max(ulog.segment.from, other.segment.from - clock);
  const auto to = std::min(ulog.segment.to, other.segment.to - clock);
  ASSERT_GT(ingest::to_seconds(to - from), 30);
  const auto theirs = mean_wind(other.airborne(), from + clock, to + clock);
  const auto whole = mean_wind(ulog.airborne(), from, to);
  const auto same = mean_wind(reduced(ulog.airborne(), format), from, to);
  const double apart = (theirs.v_NA_N - same.v_NA_N).norm(), from_whole = (theirs.v_NA_N - whole.v_NA_N).norm();
  const double sd = whole.sd.minCoeff();
  fmt::print(
      "{:<32} N {:+.3f} E {:+.3f} m/s (sd {:.2f}, {:.2f}); ULog N {:+.3f} E {:+.3f}: {:.3f} apart; ULog with what "
      "the format keeps N {:+.3f} E {:+.3f}: {:.3f} apart\n",
      name_of(format), theirs.v_NA_N.x(), theirs.v_NA_N.y(), theirs.sd.x(), theirs.sd.y(), whole.v_NA_N.x(),
      whole.v_NA_N.y(), from_whole, same.v_NA_N.x(), same.v_NA_N.y(), apart);
  EXPECT_LT(apart, 0.15);
  EXPECT_LT(from_whole, sd);
  if (!format.thinned_attitude) {
    EXPECT_LT(from_whole, 0.15);
  }
}

INSTANTIATE_TEST_SUITE_P(EscFlight, OneFlightManyFormats, ::testing::ValuesIn(formats), [](const auto& instance) {
  auto name = name_of(instance.param);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '.'; }, '_');
  return name;
});

}  // namespace
}  // namespace quadsonde

// Recorded flights beside a mast and under an anemometer, as a user estimates them: default settings, the drag given
// with 10 %, nothing chosen on the flight that judges. The limits are those of the project; PROVENANCE.md of the
// flights says how sure each reference is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "export/pipeline/analyse.h"
#include "ingest/csv/decompress.h"
#include "ingest/reference/text_table.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using Eigen::Vector2d;
using estimator::Reason;
using estimator::WindEstimate;

constexpr double degree = std::numbers::pi / 180;

/// The velocity of air that comes from a direction.
Vector2d v_NA_N(double speed, double from_deg) {
  return -speed * Vector2d(std::cos(from_deg * degree), std::sin(from_deg * degree));
}

/// A vehicle of which somebody knows the drag coefficient to a tenth, in the air of the day, and nothing else.
/// @param air_density  in which it was found [kg/m3]
product::VehicleInUse given_drag(double c, double air_density) {
  auto v = ingest::class_prior();
  v.id = "given", v.method = "given";
  v.drag.linear = c;
  v.covariance(ingest::p_linear, ingest::p_linear) = std::pow(0.1 * c, 2);
  v.covariance(ingest::p_quadratic, ingest::p_quadratic) = 0;
  v.air_density_kg_m3 = air_density;
  return {v, "given", "", {}};
}

/// The one that flew beside the mast: c is that of its flight Square, at 965.7 hPa, 11 C and 26 %.
product::VehicleInUse mast_vehicle() { return given_drag(0.262, ingest::air_density(96570, 284.4, 26)); }

product::FlightAnswer analysed(const std::filesystem::path& file, const product::VehicleInUse& vehicle,
                               const std::string& columns = "auto") {
  product::PipelineSettings settings;
  settings.input.columns = columns;
  const auto log = product::load_log(file, settings.input);
  if (!log) throw std::runtime_error(ingest::to_string(log.error()));
  auto answer = product::analyse(*log, log->parts.at(0), vehicle, settings, {});
  if (!answer) throw std::runtime_error(ingest::to_string(answer.error()));
  const auto& d = answer->series.diagnostics;
  fmt::print(
      "{}: trim {} (roll {:+.2f} +- {:.2f}, pitch {:+.2f} +- {:.2f} deg); {} jump{}, test {}; climb law {}: "
      "alpha {:+.3f} +- {:.3f} s/m, g2 {:+.3f} +- {:.3f} s2/m2; check: {}\n",
      file.filename().string(), d.trim_estimated ? "estimated" : "at its prior", d.trim_deg.x(), d.trim_sd_deg.x(),
      d.trim_deg.y(), d.trim_sd_deg.y(), d.jumps, d.jumps == 1 ? "" : "s", d.jump_test_off ? "off" : "on",
      d.climb_estimated ? "estimated" : "at its prior", d.climb_linear, d.climb_linear_sd, d.climb_quadratic,
      d.climb_quadratic_sd, answer->check ? ingest::name(answer->check->verdict) : "none");
  return std::move(*answer);
}

/// A compressed table by the names of its columns.
class Table {
 public:
  explicit Table(const std::filesystem::path& file) {
    const auto bytes = support::read_bytes(file);
    const auto plain = ingest::csv::decompress(bytes, file.filename().string());
    if (!plain) throw std::runtime_error(ingest::to_string(plain.error()));
    text_.assign(plain->bytes.begin(), plain->bytes.end());
    lines_ = ingest::split_lines(text_);
    header_ = ingest::split_cells(lines_.text.at(0), ',');
  }
  std::size_t rows() const { return lines_.text.size() - 1; }
  /// NaN for what is no number.
  std::vector<double> column(const char* name) const {
    const auto index = ingest::column(header_, name);
    if (!index) throw std::runtime_error(name);
    std::vector<double> values;
    for (std::size_t i = 1; i < lines_.text.size(); ++i)
      values.push_back(ingest::cell_number(ingest::split_cells(lines_.text[i], ','), index).value_or(NAN));
    return values;
  }

 private:
  std::string text_;
  ingest::TextLines lines_;
  std::vector<std::string_view> header_;
};

/// Wind at the mast by UTC [s]: the vector mean of the three levels around the vehicle, as the authors take it.
struct Mast {
  std::vector<double> time;
  std::vector<Vector2d> wind;

  explicit Mast(const std::filesystem::path& file) {
    const Table table(file);
    time = table.column("unix_time_s");
    wind.assign(table.rows(), Vector2d::Zero());
    for (const char* level : {"1470", "1800", "2130"}) {
      const auto speed = table.column(fmt::format("windHMag_{}cm", level).c_str()),
                 from = table.column(fmt::format("windHDir_{}cm", level).c_str());
      for (std::size_t i = 0; i < wind.size(); ++i) wind[i] += v_NA_N(speed[i], from[i]) / 3;
    }
  }
};

/// Ours and the mast's at one instant, with what is known of ours.
struct Pair {
  double time, v_up;
  Vector2d ours, mast;
  Eigen::Matrix2d covariance;
};

std::vector<Pair> pairs(const estimator::WindSeries& series, const Mast& mast) {
  std::vector<Pair> all;
  std::size_t k = 0;
  for (const auto& p : series.points) {
    const auto* wind = std::get_if<WindEstimate>(&p.wind);
    if (!wind || !p.utc) continue;
    const double t = static_cast<double>(p.utc->ns) * 1e-9;
    while (k + 1 < mast.time.size() && std::abs(mast.time[k + 1] - t) < std::abs(mast.time[k] - t)) ++k;
    if (std::abs(mast.time[k] - t) > 0.2) continue;
    all.push_back({t, p.v_up, wind->v_NA_N, mast.wind[k], wind->covariance});
  }
  return all;
}

struct Errors {
  double vector = 0, speed = 0;
  int windows = 0;
};

/// rms over means of so many seconds; the last, shorter one is left out. A vector's error is its length.
Errors errors_of_means(const std::vector<Pair>& all, double seconds) {
  std::map<int, std::pair<Vector2d, Vector2d>> sums;
  std::map<int, double> counts;
  for (const auto& p : all) {
    const int window = static_cast<int>((p.time - all.front().time) / seconds);
    auto& [ours, mast] = sums.try_emplace(window, Vector2d::Zero(), Vector2d::Zero()).first->second;
    ours += p.ours, mast += p.mast, counts[window] += 1;
  }
  Errors e;
  for (const auto& [window, sum] : sums) {
    if (counts[window] < 9 * seconds) continue;
    const Vector2d ours = sum.first / counts[window], mast = sum.second / counts[window];
    e.vector += (ours - mast).squaredNorm();
    e.speed += std::pow(ours.norm() - mast.norm(), 2);
    ++e.windows;
  }
  e.vector = std::sqrt(e.vector / e.windows), e.speed = std::sqrt(e.speed / e.windows);
  return e;
}

TEST(BesideAReference, AHoverBesideTheMastMeetsItWithinAThirdOfAMetrePerSecond) {
  const std::string file = "flights/epfl_wemuav/derived_FLY139__20210420_092926__Hover.csv.gz";
  QUADSONDE_NEEDS_DATA(file);
  const auto answer = analysed(support::data_file(file), mast_vehicle());
  const auto all = pairs(answer.series, Mast(support::data_file(file)));
  ASSERT_GT(all.size(), 4300u);
  const auto short_means = errors_of_means(all, 20), long_means = errors_of_means(all, 60);
  Vector2d ours = Vector2d::Zero(), mast = ours;
  Eigen::Matrix2d C = Eigen::Matrix2d::Zero();
  for (const auto& p : all) {
    const auto n = static_cast<double>(all.size());
    ours += p.ours / n, mast += p.mast / n, C += p.covariance / n;
  }
  fmt::print(
      "20 s means ({}): {:.3f} vector, {:.3f} speed; 60 s means ({}): {:.3f} vector; flight mean {:.2f} m/s off "
      "{:.2f} m/s, sd north {:.2f} east {:.2f}\n",
      short_means.windows, short_means.vector, short_means.speed, long_means.windows, long_means.vector,
      (ours - mast).norm(), mast.norm(), std::sqrt(C(0, 0)), std::sqrt(C(1, 1)));
  EXPECT_LE(short_means.vector, 0.45);
  EXPECT_LE(short_means.speed, 0.30);
  EXPECT_LE(long_means.vector, 0.28);
  EXPECT_LE((ours - mast).norm(), 0.3);
  const Vector2d off = ours - mast;
  EXPECT_LT(off.dot(C.inverse() * off), 4);
  // The nose stood still, so the trim stays at its prior and every value says so.
  EXPECT_FALSE(answer.series.diagnostics.trim_estimated);
  for (const auto& p : answer.series.points)
    if (std::holds_alternative<WindEstimate>(p.wind)) {
      ASSERT_TRUE(p.reasons.has(Reason::trim_unobserved));
    }
}

/// What our wind is of the mast's, by the vehicle's vertical motion: lengths of the mean vectors.
TEST(BesideAReference, ClimbsPausesAndDescentsBesideTheMastShowTheSameWind) {
  const std::string file = "flights/epfl_wemuav/derived_FLY168__20210503_143909__Vertical3ms.csv.gz";
  QUADSONDE_NEEDS_DATA(file);
  const auto answer = analysed(support::data_file(file), mast_vehicle());
  struct Phase {
    const char* name;
    double low, high;  ///< design notes, section 12: the share to reach
    Vector2d ours = Vector2d::Zero(), mast = Vector2d::Zero();
    double share() const { return ours.norm() / mast.norm(); }
  };
  Phase climb{"climb", 0.93, 1.04}, pause{"pause", 0.84, 0.95}, descent{"descent", 0.78, 0.88};
  for (const auto& p : pairs(answer.series, Mast(support::data_file(file)))) {
    auto& phase = p.v_up > 2 ? climb : p.v_up < -2 ? descent : pause;
    if (&phase == &pause && std::abs(p.v_up) > 0.5) continue;
    phase.ours += p.ours, phase.mast += p.mast;
  }
  for (const auto* phase : {&climb, &pause, &descent}) {
    fmt::print("{}: {:.2f} of the mast's speed\n", phase->name, phase->share());
    EXPECT_GE(phase->share(), phase->low) << phase->name;
    // Nearer to the mast than the range to reach is no failure.
    EXPECT_LE(phase->share(), std::max(phase->high, 1.04)) << phase->name;
  }
  for (const auto& p : answer.series.points)
    if (std::holds_alternative<WindEstimate>(p.wind) && p.v_up < -2.5) {
      EXPECT_TRUE(p.reasons.has(Reason::fast_descent));
    }
}

TEST(BesideAReference, ASurveyUnderAnAnemometerMeetsItsWindAndItsAirspeed) {
  const std::string file = "flights/sph_skyhub_wind/wind-trajectory1.csv.gz";
  QUADSONDE_NEEDS_DATA(file);
  const auto answer = analysed(support::data_file(file), given_drag(0.155, ingest::sea_level_air_density),
                               QUADSONDE_MAPS "/skyhub_exchanged.toml");
  const Table table(support::data_file(file));
  const auto elapsed = table.column("Elapsed"), air = table.column("AIR:Speed");
  Vector2d mean = Vector2d::Zero();
  double n = 0;
  struct Sum {
    double ours = 0, theirs = 0, n = 0;
  };
  std::map<int, Sum> windows;
  std::size_t k = 0;
  for (const auto& p : answer.series.points) {
    const auto* wind = std::get_if<WindEstimate>(&p.wind);
    if (!wind || !p.height_agl || p.height_agl->m < 45) continue;
    mean += wind->v_NA_N, n += 1;
    // The log's clock is the table's counter.
    const double t = ingest::to_seconds(p.time - ingest::LogTime{});
    while (k + 1 < elapsed.size() && std::abs(elapsed[k + 1] / 1000 - t) < std::abs(elapsed[k] / 1000 - t)) ++k;
    if (std::abs(elapsed[k] / 1000 - t) > 0.2 || std::isnan(air[k])) continue;
    auto& window = windows[static_cast<int>(t / 5)];
    window.ours += p.v_AB_N->norm(), window.theirs += air[k], window.n += 1;
  }
  mean /= n;
  double both = 0, theirs2 = 0;
  std::erase_if(windows, [](const auto& w) { return w.second.n < 20; });  // its position has 5 Hz
  for (auto& [i, w] : windows) {
    w.ours /= w.n, w.theirs /= w.n;
    both += w.ours * w.theirs, theirs2 += w.theirs * w.theirs;
  }
  const double scale = theirs2 / both;  // the anemometer reads so many times too much
  double square = 0;
  for (const auto& [i, w] : windows)
    square += std::pow(w.ours - w.theirs / scale, 2) / static_cast<double>(windows.size());
  const auto report = estimator::to_report({mean, Eigen::Matrix2d::Identity() * 0.01, true});
  const double off = (mean - v_NA_N(3.3, 77)).norm();
  fmt::print(
      "flight mean {:.2f} m/s from {:.0f} deg, {:.2f} m/s off; airspeed over 5 s ({}): rms {:.2f} m/s, the "
      "anemometer's scale {:.2f}\n",
      report.speed_m_s, report.from_deg.value_or(NAN), off, windows.size(), std::sqrt(square), scale);
  ASSERT_GT(windows.size(), 120u);
  EXPECT_LE(off, 0.6);
  EXPECT_LE(std::sqrt(square), 0.70);
  EXPECT_TRUE(answer.series.diagnostics.trim_estimated) << "without it the wind is 1 m/s off";
}

}  // namespace
}  // namespace quadsonde

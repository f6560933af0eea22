// The real tables, held against their own text.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>
#include <numbers>

#include "ingest/csv/decompress.h"
#include "ingest/csv/flight_from_csv.h"
#include "ingest/csv/table.h"
#include "ingest/flight/local_frame.h"
#include "ingest/flight/rotation.h"
#include "ingest/ulog/flight_from_ulog.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// A table as text, read by other means than the reader's: every cell by row and column name.
class RawTable {
 public:
  RawTable(const std::string& relative, char delimiter, std::size_t header_line = 1) {
    bytes_ = support::read_bytes(support::data_file(relative));
    if (csv::is_compressed(bytes_)) bytes_ = csv::decompress(bytes_, relative).value().bytes;
    std::string text(bytes_.begin(), bytes_.end());
    std::size_t line = 0, at = 0;
    while (at < text.size()) {
      const auto end = std::min(text.find('\n', at), text.size());
      std::vector<std::string> cells;
      std::size_t from = at;
      for (std::size_t i = at; i <= end; ++i)
        if (i == end || text[i] == delimiter) {
          cells.push_back(text.substr(from, i - from));
          from = i + 1;
        }
      at = end + 1;
      if (++line == header_line)
        for (std::size_t c = 0; c < cells.size(); ++c) names_[cells[c]] = c;
      else if (line > header_line)
        rows_.push_back(std::move(cells));
    }
  }
  double number(std::size_t row, const std::string& name) const { return std::stod(rows_.at(row).at(names_.at(name))); }
  std::size_t size() const { return rows_.size(); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::map<std::string, std::size_t> names_;
  std::vector<std::vector<std::string>> rows_;
};

LogContent sample(const std::string& relative, std::optional<ColumnMap> map = {}) {
  const auto bytes = support::read_bytes(support::data_file(relative));
  return read_csv(bytes, relative, {Reading::tolerant, std::move(map)}).value();
}

std::string detail(const LogContent& content, const std::string& key) {
  for (const auto& [k, v] : content.details)
    if (k == key) return v;
  return {};
}

TEST(CsvSamples, WemuavHoldsWhatItsTextSays) {
  for (const auto& [name, rows] : {std::pair("FLY139__20210420_092926__Hover", 4471),
                                   {"FLY139__20210420_093827__Square", 331},
                                   {"FLY168__20210503_143909__Vertical3ms", 511}}) {
    const auto file = fmt::format("flights/epfl_wemuav/derived_{}.csv.gz", name);
    QUADSONDE_NEEDS_DATA(file);
    const RawTable raw(file, ',');
    const auto content = sample(file);
    const auto& f = content.flights.at(0);
    EXPECT_EQ(detail(content, "map"), "wemuav");
    EXPECT_TRUE(f.problems.empty()) << "quaternion and angles agree";
    ASSERT_EQ(f.attitude.size(), static_cast<std::size_t>(rows));
    for (const auto row : {std::size_t{0}, f.attitude.size() / 2, f.attitude.size() - 1}) {
      Eigen::Quaterniond q(raw.number(row, "q1"), raw.number(row, "q2"), raw.number(row, "q3"), raw.number(row, "q4"));
      EXPECT_LT(f.attitude.value[row].angularDistance(q.normalized()), 1e-7) << "resampling left them a little short";
      EXPECT_NEAR(euler_from_q_NB(f.attitude.value[row]).pitch, raw.number(row, "pitch"), 1e-6) << "radians";
      EXPECT_EQ(f.velocity.value[row],
                Eigen::Vector3d(raw.number(row, "vn"), raw.number(row, "ve"), raw.number(row, "vd")));
      EXPECT_EQ(f.position.value[row].lat_deg, raw.number(row, "lati"));
      EXPECT_EQ(f.height_msl.value[row].m, raw.number(row, "alti"));
      EXPECT_EQ(f.accelerometer.value[row].z(), raw.number(row, "az"));
      EXPECT_EQ(f.rotors.value[row][2], static_cast<float>(raw.number(row, "motRpm_LB")));
      EXPECT_NEAR(static_cast<double>(f.attitude.time[row].ns) * 1e-9, raw.number(row, "unix_time_s"), 1e-6);
      EXPECT_EQ(f.clock.to_utc(f.attitude.time[row])->ns, f.attitude.time[row].ns);
    }
    EXPECT_TRUE(f.autopilot_wind.empty()) << "the mast's and the maker's wind are not read";
  }
}

TEST(CsvSamples, SkyhubIsReadAsNamedAndByRtk) {
  const std::string file = "flights/sph_skyhub_wind/wind-trajectory1.csv.gz";
  QUADSONDE_NEEDS_DATA(file);
  const RawTable raw(file, ',');
  const auto content = sample(file);
  const auto& f = content.flights.at(0);
  ASSERT_EQ(f.attitude.size(), 7754U);
  for (const std::size_t row : {0U, 4000U, 7753U}) {
    const auto angles = euler_from_q_NB(f.attitude.value[row]);
    EXPECT_NEAR(angles.roll / degree, raw.number(row, "Roll"), 1e-9);
    EXPECT_NEAR(angles.pitch / degree, raw.number(row, "Pitch"), 1e-9);
    EXPECT_NEAR(wrap_angle(angles.yaw - raw.number(row, "Yaw") * degree), 0, 1e-9);
    EXPECT_EQ(f.position.value[row].lat_deg, raw.number(row, "Latitude RTK"));
    EXPECT_EQ(f.height_ground.value[row].m, raw.number(row, "Altitude"));
    EXPECT_EQ(f.height_ellipsoid.value[row].m, raw.number(row, "Altitude RTK"));
    EXPECT_NEAR(to_seconds(f.attitude.time[row] - LogTime{0}), raw.number(row, "Elapsed") * 1e-3, 1e-9);
  }
  EXPECT_EQ(f.velocity.origin, VelocityOrigin::differentiated);
  // The slope of the position agrees with the logged ground speed.
  double sum2 = 0;
  std::size_t n = 0;
  for (std::size_t row = 0; row < raw.size() && row < 7754; ++row) {
    const auto at = last_at_or_before(f.velocity, f.attitude.time[row]);
    if (at < 0 || f.velocity.time[static_cast<std::size_t>(at)] != f.attitude.time[row]) continue;
    const double off = f.velocity.value[static_cast<std::size_t>(at)].norm() - raw.number(row, "Velocity");
    sum2 += off * off;
    ++n;
  }
  EXPECT_GT(n, 5000U);
  EXPECT_LT(std::sqrt(sum2 / static_cast<double>(n)), 0.5) << "at 5 m/s; the logged speed has a latency of its own";
  EXPECT_FALSE(f.clock.utc_minus_log) << "the table names no zone";
}

TEST(CsvSamples, TheUsersWordExchangesSkyhubsAngles) {
  const std::string file = "flights/sph_skyhub_wind/wind-trajectory1.csv.gz";
  QUADSONDE_NEEDS_DATA(file);
  const RawTable raw(file, ',');
  const auto map = read_column_map(std::filesystem::path(QUADSONDE_EXAMPLE_MAPS) / "skyhub_exchanged.toml").value();
  const auto content = sample(file, map);
  const auto angles = euler_from_q_NB(content.flights.at(0).attitude.value.at(4000));
  EXPECT_NEAR(angles.roll / degree, raw.number(4000, "Pitch"), 1e-9);
  EXPECT_NEAR(angles.pitch / degree, raw.number(4000, "Roll"), 1e-9);
}

TEST(CsvSamples, DroneDeployIsConvertedFromMilesAndFeet) {
  const std::string file = "flights/dronedeploy_dji/ipad-ios11-phantom4.log.gz";
  QUADSONDE_NEEDS_DATA(file);
  const RawTable raw(file, '\t', 28);
  const auto content = sample(file);
  const auto& f = content.flights.at(0);
  ASSERT_EQ(f.attitude.size(), 2323U);
  for (const std::size_t row : {30U, 1000U, 2000U}) {
    EXPECT_NEAR(f.velocity.value[row].x(), raw.number(row, "Aircraft Vel - X (mph)") * 0.44704, 1e-12);
    EXPECT_NEAR(f.velocity.value[row].z(), raw.number(row, "Aircraft Vel - Z (mph)") * 0.44704, 1e-12);
    EXPECT_NEAR(f.height_ground.value[row].m, raw.number(row, "Aircraft Barometric Altitude (ft)") * 0.3048, 1e-12);
    EXPECT_NEAR(euler_from_q_NB(f.attitude.value[row]).roll / degree, raw.number(row, "Aircraft Roll (Degrees)"), 1e-9);
  }
  EXPECT_EQ(f.vehicle.name, "Phantom 4 Pro");
  ASSERT_EQ(f.events.size(), 3U);
  EXPECT_EQ(f.events.value[0].text, "Mission did take off");
  EXPECT_EQ(to_iso8601(*f.clock.to_utc(f.attitude.time[0]), 0), "2018-05-23T20:50:18Z");
  EXPECT_TRUE(f.problems.empty());
}

/// Slope of one component of the velocity column on that of the position.
double slope_against_position(const Flight& f, int axis) {
  const auto own = differentiate_position(f, 2.0);
  double xy = 0, xx = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const auto at = last_at_or_before(f.velocity, own.time[i]);
    if (at < 0) continue;
    const double v = f.velocity.value[static_cast<std::size_t>(at)][axis];
    xy += own.value[i][axis] * v;
    xx += own.value[i][axis] * own.value[i][axis];
  }
  return xy / xx;
}

TEST(CsvSamples, VelocitiesOfEveryTableAgreeWithItsPositions) {
  for (const std::string file :
       {"flights/dronedeploy_dji/ipad-ios11-phantom4.log.gz", "flights/dronedeploy_dji/iphone-ios-11-3-matrice.log.gz",
        "flights/dronedeploy_dji/iphone-ios11-inspire.log.gz", "flights/dronedeploy_dji/pixel2-inspire2.log.gz",
        "flights/nmt_m600_trisonica/level0.csv.gz",
        "flights/epfl_wemuav/derived_FLY168__20210503_143909__Vertical3ms.csv.gz"}) {
    QUADSONDE_NEEDS_DATA(file);
    SCOPED_TRACE(file);
    const auto content = sample(file);
    const auto& f = content.flights.at(0);
    // Axes, signs and units: a wrong one of them gives 0, -1, 0.45 or 2.2.
    for (const int axis : {0, 1, 2}) {
      if (axis < 2 && file.find("Vertical") != std::string::npos) continue;  // it hardly moves sideways
      const double slope = slope_against_position(f, axis);
      EXPECT_GT(slope, 0.75) << "axis " << axis;
      EXPECT_LT(slope, 1.25) << "axis " << axis;
    }
  }
}

TEST(CsvSamples, NmtIsReadAsNamed) {
  const std::string file = "flights/nmt_m600_trisonica/level0.csv.gz";
  QUADSONDE_NEEDS_DATA(file);
  const RawTable raw(file, ',');
  const auto content = sample(file);
  const auto& f = content.flights.at(0);
  ASSERT_EQ(f.velocity.size(), 7303U);
  for (const std::size_t row : {0U, 3000U, 7302U}) {
    EXPECT_EQ(f.velocity.value[row],
              Eigen::Vector3d(raw.number(row, "Vy"), raw.number(row, "Vx"), -raw.number(row, "Vz")));
    EXPECT_NEAR(f.air.value[row].temperature_k.value(), raw.number(row, "T") + 273.15, 1e-9);
    EXPECT_NEAR(euler_from_q_NB(f.attitude.value[row]).pitch / degree, raw.number(row, "Pitch"), 1e-9);
  }
  EXPECT_EQ(to_iso8601(*f.clock.to_utc(f.attitude.time[0]), 0), "2023-04-19T14:10:05Z");
}

TEST(CsvSamples, TheEscFlightIsTheSameAsInItsUlog) {
  QUADSONDE_NEEDS_DATA("logs/derived/esc_flight.csv");
  const auto table = sample("logs/derived/esc_flight.csv");
  const auto bytes = support::read_bytes(support::data_file("logs/ulog/esc_status_log.ulg"));
  const auto ulog = read_ulog(bytes, "esc_status_log.ulg").value();
  const auto& a = table.flights.at(0);
  const auto& b = ulog.flights.at(0);
  ASSERT_EQ(a.local_position.size(), b.local_position.size());
  for (std::size_t i = 0; i < a.local_position.size(); ++i) {
    EXPECT_EQ(a.local_position.time[i], b.local_position.time[i]);
    EXPECT_LT((a.local_position.value[i] - b.local_position.value[i]).norm(), 1e-4) << "four digits";
  }
  // The table was made by the nearest attitude of the log; its digits are 7.
  for (std::size_t i = 0; i < a.attitude.size(); ++i) {
    const auto at =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(last_at_or_before(b.attitude, a.attitude.time[i]), 0));
    double nearest = 10;
    for (std::size_t k = at; k < std::min(at + 2, b.attitude.size()); ++k)
      nearest = std::min(nearest, a.attitude.value[i].angularDistance(b.attitude.value[k].normalized()));
    EXPECT_LT(nearest / degree, 0.01) << i;
  }
  EXPECT_NEAR(to_seconds(*a.clock.utc_minus_log - *b.clock.utc_minus_log), 0, 0.002);
  EXPECT_TRUE(a.problems.empty());
  EXPECT_TRUE(a.air.empty()) << "baro_temp_c is the board's";
}

// ---- Airdata: no sample may be shipped, so a small table of its layout ----

std::string airdata(bool metric) {
  std::string text = fmt::format(
      "time(millisecond),datetime(utc),latitude,longitude,height_above_takeoff({0}),altitude_above_seaLevel({0}),speed("
      "{1}),"
      "satellites, xSpeed({1}), ySpeed({1}), zSpeed({1}), compass_heading(degrees), pitch(degrees), "
      "roll(degrees),message\n",
      metric ? "meters" : "feet", metric ? "m/s" : "mph");
  const double m = metric ? 1 : 1 / 0.3048, v = metric ? 1 : 1 / 0.44704;
  for (int i = 0; i < 40; ++i)
    text += fmt::format(
        "{},2021-05-06 18:53:{:02},{:.8f},{:.8f},{:.6f},{:.6f},{:.6f},14,{:.6f},{:.6f},{:.6f},{:.1f}, {:.1f}, "
        "{:.1f},{}\n",
        i * 100, i / 10, 47.5 + i * 2e-6, 8.5 + i * 1e-6, m * i * 0.2, m * (430 + i * 0.2), v * 2.5, v * 2.2, v * 0.8,
        v * -2.0, 187.8, -3.5, 1.2, i == 5 ? "Take, off" : "");
  return text + text.substr(text.rfind('\n', text.size() - 2) + 1);  // the last row twice, as exports have it
}

TEST(CsvSamples, AirdataIsTheSameInMetresAndInFeet) {
  // A message with a comma stands in quotes.
  auto quoted = [](std::string text) {
    const auto at = text.find("Take, off");
    return text.replace(at, 9, "\"Take, off\"");
  };
  const auto metric = quoted(airdata(true)), imperial = quoted(airdata(false));
  const auto a = read_csv(as_bytes(metric), "a.csv").value(), b = read_csv(as_bytes(imperial), "b.csv").value();
  EXPECT_EQ(detail(a, "map"), "airdata");
  const auto& f = a.flights.at(0);
  const auto& g = b.flights.at(0);
  ASSERT_EQ(f.velocity.size(), 40U) << "a repeated time counts once";
  EXPECT_TRUE(f.problems.empty());
  EXPECT_EQ(f.velocity.value[0], Eigen::Vector3d(2.2, 0.8, -2.0));
  EXPECT_NEAR(f.height_ground.value[10].m, 2.0, 1e-9);
  EXPECT_NEAR(f.height_msl.value[10].m, 432.0, 1e-9);
  EXPECT_EQ(f.attitude.time[1].ns, 100000000);
  const auto angles = euler_from_q_NB(f.attitude.value[0]);
  EXPECT_NEAR(angles.roll / degree, 1.2, 1e-9);
  EXPECT_NEAR(angles.pitch / degree, -3.5, 1e-9);
  EXPECT_NEAR(wrap_angle(angles.yaw - 187.8 * degree), 0, 1e-9);
  ASSERT_EQ(f.events.size(), 1U);
  EXPECT_EQ(f.events.value[0].text, "Take, off");
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_LT((f.velocity.value[i] - g.velocity.value[i]).norm(), 1e-6);
    EXPECT_NEAR(f.height_ground.value[i].m, g.height_ground.value[i].m, 1e-6);
  }
}

}  // namespace
}  // namespace quadsonde::ingest

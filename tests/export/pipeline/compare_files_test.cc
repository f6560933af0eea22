#include "export/pipeline/compare_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "export/csv/flight_csv.h"
#include "export/csv/tables.h"
#include "export/pipeline/run_log.h"
#include "ingest/reference/metar.h"
#include "tests/export/made_up.h"
#include "tests/export/pipeline/flown.h"
#include "tests/export/report/xml_check.h"

namespace quadsonde::product {
namespace {

using support::write_text;
using testing::HasSubstr;

/// A flown ascent with all its products, the truth of it, and what a station and an airport at the same place would
/// have reported of the same air: its mean at 10 m, in m/s and in whole knots and tens of degrees.
struct Flown {
  support::TemporaryFolder folder;
  ingest::Simulation simulation = support::flown();

  Flown() {
    write_text(folder / "ascent.csv", flight_csv(simulation.flight));
    write_text(folder / "truth.csv", truth_csv(simulation.truth));
    write_text(folder / "vehicle.toml", ingest::to_toml(simulation.vehicle));
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double n = 0;
    for (const auto& t : simulation.truth)
      if (std::abs(t.height.m - 10) < 5) sum += t.v_NA_N.head<2>(), n += 1;
    const auto report = estimator::to_report({sum / n, Eigen::Matrix2d::Zero(), true});
    write_text(folder / "table.csv",
               fmt::format("utc,speed_min_m_s,speed_max_m_s,wind_from_deg,height_agl_m,lat_deg,lon_deg\n"
                           "2025-06-15T06:05:00Z,{0:.2f},{0:.2f},{1:.0f},10,43.5657,1.4815\n",
                           report.speed_m_s, *report.from_deg));
    write_text(folder / "metar.txt",
               fmt::format("LFBO 150605Z {:03}{:02}KT 9999\n", 10 * std::lround(*report.from_deg / 10),
                           std::lround(report.speed_m_s / ingest::knot)));
  }
  std::vector<std::filesystem::path> files(const std::vector<std::string>& names) const {
    std::vector<std::filesystem::path> paths;
    for (const auto& name : names) paths.push_back(folder / name);
    return paths;
  }
};

TEST(CompareFiles, OfASimulatedFlightWithReportsOfItsOwnWindGiveSmallErrors) {
  const Flown flown;
  RunRequest request;
  request.log = flown.folder / "ascent.csv";
  request.folder = flown.folder / "out";
  request.references = flown.files({"metar.txt", "table.csv", "truth.csv"});
  const auto run = run_log(request);
  ASSERT_TRUE(run) << ingest::to_string(run.error());
  const auto within = [](const Comparison& comparison) {
    for (const auto& reference : comparison.references) {
      const auto& s = reference.whole();
      ASSERT_GT(s.n, 0u) << reference.file;
      EXPECT_LT(std::abs(s.speed.bias), 0.6) << reference.file << ": 0.3 m/s of turbulence, half a knot of rounding";
      EXPECT_LT(std::abs(s.direction.bias), 10) << reference.file;
      EXPECT_LT(*s.normalised_error, 4) << reference.file;
    }
  };
  within(*run->flights.at(0).answer.comparison);
  for (const auto* name : {"out/ascent/profile.csv", "out/ascent/wind.csv", "out/ascent/profile.nc"}) {
    const auto compared = compare_files(flown.files({"metar.txt", name, "table.csv", "truth.csv"}), {});
    ASSERT_TRUE(compared) << ingest::to_string(compared.error());
    EXPECT_FALSE(compared->with_doubts()) << name;
    EXPECT_EQ(compared->taken.size(), 4u) << name;
    ASSERT_EQ(compared->flights.size(), 1u);
    within(compared->flights[0].comparison);
    EXPECT_EQ(support::xml_fault(compared_svg(compared->flights[0])), std::nullopt) << name;
  }
}

TEST(CompareFiles, ReadBackGiveTheScoresOfTheRunThatWroteThem) {
  const Flown flown;
  RunRequest request;
  request.log = flown.folder / "ascent.csv";
  request.folder = flown.folder / "out";
  request.references = flown.files({"truth.csv"});
  const auto run = run_log(request);
  ASSERT_TRUE(run);
  const auto compared = compare_files(flown.files({"out/ascent/wind.csv", "truth.csv"}), {});
  ASSERT_TRUE(compared);
  const auto& ours = *run->flights.at(0).answer.comparison->references[0].truth();
  const auto& again = *compared->flights.at(0).comparison.references[0].truth();
  EXPECT_EQ(ours.samples.n, again.samples.n);
  EXPECT_NEAR(ours.samples.rmsve, again.samples.rmsve, 1e-4) << "four decimals in the table";
  EXPECT_EQ(ours.legs.size(), again.legs.size()) << "the legs are found again in the heights";
}

TEST(CompareFiles, WithoutAProfileOrAReferenceAreWrongUsage) {
  const Flown flown;
  write_text(flown.folder / "p.csv", profile_csv(support::made_up_profile()));
  const auto no_profile = compare_files(flown.files({"metar.txt", "truth.csv"}), {});
  ASSERT_FALSE(no_profile);
  EXPECT_EQ(no_profile.error().kind, ingest::Kind::usage);
  EXPECT_THAT(no_profile.error().what, HasSubstr("no profile"));
  EXPECT_THAT(compare_files(flown.files({"p.csv"}), {}).error().what, HasSubstr("no reference"));
}

TEST(CompareFiles, ThatCannotBeUsedAreNamedAndTheOthersGoOn) {
  const Flown flown;
  write_text(flown.folder / "p.csv", profile_csv(support::made_up_profile()));
  write_text(flown.folder / "diary.txt", "Dear diary\n");
  write_text(flown.folder / "other.nc", "CDF\x01 but nothing more");
  const auto result =
      compare_files(flown.files({"p.csv", "diary.txt", "other.nc", "nowhere.txt", "ascent.csv", "metar.txt"}), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->failures.size(), 4u);
  EXPECT_EQ(result->flights.size(), 1u);
  EXPECT_TRUE(result->with_doubts());
  const auto nothing = compare_files(flown.files({"p.csv", "diary.txt"}), {});
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->flights.empty());
}

}  // namespace
}  // namespace quadsonde::product

#include <cmath>

#include "export/atomic_file.h"
#include "export/cf_netcdf/cf_netcdf.h"
#include "export/csv/tables.h"
#include "nc_reader.h"
#include "run_python.h"
#include "tests/export/made_up.h"

namespace quadsonde {
namespace {

using product::wind_netcdf;
using support::NcReader;

std::string bytes_of(const estimator::WindSeries& series) {
  auto bytes = wind_netcdf(series, support::made_up_source());
  EXPECT_TRUE(bytes) << (bytes ? "" : ingest::to_string(bytes.error()));
  return bytes.value_or("");
}

TEST(WindNetcdf, XarrayAndNcoReadTheNumbersOfTheCsv) {
  auto series = support::made_up_series();
  series.points[50].quality = estimator::Quality::doubtful;
  const support::TemporaryFolder folder;
  ASSERT_TRUE(product::write_wind_netcdf(folder / "wind.nc", series, support::made_up_source()));
  ASSERT_TRUE(product::write_file(folder / "wind.csv", product::wind_csv(series)));
  EXPECT_EQ(support::python(QUADSONDE_READ_BACK,
                            "wind" + support::quoted(folder / "wind.nc") + support::quoted(folder / "wind.csv")),
            "");
  EXPECT_EQ(support::python(QUADSONDE_CF_RULES, support::quoted(folder / "wind.nc")), "");
}

TEST(WindNetcdf, AStepWithoutAWindIsMissingAndSaysWhy) {
  const NcReader file(bytes_of(support::made_up_series()));
  ASSERT_EQ(file.length("obs"), 400u);
  EXPECT_TRUE(std::isnan(file.numbers("eastward_wind")[3]));
  EXPECT_EQ(file.numbers("wind_qc")[3], 9);
  EXPECT_EQ(file.numbers("wind_qc_reasons")[3], 1 << static_cast<int>(estimator::Reason::converging));
  EXPECT_EQ(file.numbers("wind_qc")[10], 1);
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_mode"), "smoothed");
}

TEST(WindNetcdf, StepsWithoutAPlaceAreLeftOutAndCounted) {
  auto series = support::made_up_series();
  for (int i = 0; i < 7; ++i) series.points[static_cast<std::size_t>(i)].place.reset();
  series.points[20].height_msl.reset();
  const NcReader file(bytes_of(series));
  EXPECT_EQ(file.length("obs"), 392u);
  EXPECT_NEAR(file.numbers("log_time")[0], 0.7, 1e-9);
  EXPECT_NE(file.attribute(nullptr, "comment").find("8 of 400 filter steps are left out"), std::string::npos);
}

TEST(WindNetcdf, TheClassicFilterHasNoUncertainty) {
  auto series = support::made_up_series();
  series.mode = estimator::Mode::classic;
  for (auto& p : series.points)
    if (auto* wind = std::get_if<estimator::WindEstimate>(&p.wind)) wind->has_covariance = false;
  const NcReader file(bytes_of(series));
  EXPECT_TRUE(std::isnan(file.numbers("eastward_wind_se")[100]));
  EXPECT_FALSE(std::isnan(file.numbers("eastward_wind")[100]));
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_mode"), "classic");
}

TEST(WindNetcdf, SameInputGivesTheSameBytesAlsoOverManyChunks) {
  const auto series = support::made_up_series(20000);
  const auto first = bytes_of(series);
  EXPECT_EQ(NcReader(first).length("obs"), 20000u);
  EXPECT_EQ(bytes_of(series), first);
}

TEST(WindNetcdf, WithoutUtcAPlaceOrAHeightThereIsNone) {
  const auto kind_without = [](auto take_away) {
    auto series = support::made_up_series();
    for (auto& p : series.points) take_away(p);
    const auto bytes = wind_netcdf(series, support::made_up_source());
    EXPECT_FALSE(bytes);
    return bytes ? std::string() : bytes.error().what;
  };
  EXPECT_NE(kind_without([](auto& p) { p.utc.reset(); }).find("UTC"), std::string::npos);
  EXPECT_NE(kind_without([](auto& p) { p.place.reset(); }).find("place"), std::string::npos);
  EXPECT_NE(kind_without([](auto& p) { p.height_msl.reset(); }).find("heights"), std::string::npos);
  EXPECT_FALSE(wind_netcdf({}, support::made_up_source()));
}

}  // namespace
}  // namespace quadsonde

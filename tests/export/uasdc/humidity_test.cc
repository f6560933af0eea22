#include "export/uasdc/humidity.h"

#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/data.h"

namespace quadsonde {
namespace {

using product::dew_point_k;
using product::mixing_ratio;
using product::saturation_vapour_pressure_pa;

TEST(Humidity, SaturationIsThatOfTheSteamTables) {
  // IAPWS R7-97, saturation line: 0.01, 20 and 40 deg C.
  EXPECT_NEAR(*saturation_vapour_pressure_pa(273.16), 611.66, 0.003 * 611.66);
  EXPECT_NEAR(*saturation_vapour_pressure_pa(293.15), 2339.3, 0.004 * 2339.3);
  EXPECT_NEAR(*saturation_vapour_pressure_pa(313.15), 7384.9, 0.004 * 7384.9);
}

TEST(Humidity, SaturatedAirHasItsOwnTemperatureAsDewPoint) {
  for (double t = 230; t <= 330; t += 7) EXPECT_NEAR(*dew_point_k(t, 100), t, 1e-9);
  EXPECT_LT(*dew_point_k(293.15, 50), 293.15);
}

TEST(Humidity, WhatCannotBeSaidIsEmpty) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(dew_point_k(293, 0)) << "dry air has none";
  EXPECT_EQ(mixing_ratio(293, 0, 1e5), 0.0) << "but it has a mixing ratio";
  for (const double t : {nan, 0.0, 200.0, 400.0}) {
    EXPECT_FALSE(dew_point_k(t, 50)) << t;
    EXPECT_FALSE(mixing_ratio(t, 50, 1e5)) << t;
  }
  for (const double humidity : {nan, -1.0, 1000.0}) EXPECT_FALSE(dew_point_k(293, humidity)) << humidity;
  for (const double p : {nan, -1.0, 0.0, 1000.0}) EXPECT_FALSE(mixing_ratio(300, 100, p)) << p;
}

std::vector<double> variable(int file, const char* name) {
  int id = -1, dimension = -1;
  std::size_t n = 0;
  EXPECT_EQ(nc_inq_varid(file, name, &id), NC_NOERR) << name;
  nc_inq_vardimid(file, id, &dimension);
  nc_inq_dimlen(file, dimension, &n);
  std::vector<double> values(n);
  EXPECT_EQ(nc_get_var_double(file, id, values.data()), NC_NOERR) << name;
  return values;
}

TEST(Humidity, GivesTheDewPointsOfTheCampaignsOwnSample) {
  const char* sample = "uasdc/raw_uas_to_netCDF_UASDC_operatorID_airframeID_20230327025804Z.nc";
  QUADSONDE_NEEDS_DATA(sample);
  int file = -1;
  ASSERT_EQ(nc_open(support::data_file(sample).c_str(), NC_NOWRITE, &file), NC_NOERR);
  const auto t = variable(file, "air_temperature"), humidity = variable(file, "relative_humidity"),
             dew = variable(file, "dew_point_temperature");
  nc_close(file);
  ASSERT_EQ(t.size(), 349u);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const auto ours = dew_point_k(t[i], humidity[i]);
    ASSERT_TRUE(ours);
    EXPECT_NEAR(*ours, dew[i], 0.1) << i;  // their formula is not stated
  }
}

}  // namespace
}  // namespace quadsonde

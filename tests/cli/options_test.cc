#include "cli/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace quadsonde::cli {
namespace {

TEST(Options, ReadNumbersWithoutALocaleAndWithinTheirRange) {
  double value = 1;
  Options options;
  options("bin_m", value, 1.0, 1000.0, "A bin.");
  auto& bin = options.last();
  EXPECT_EQ(bin.flag, "--bin-m");
  EXPECT_EQ(bin.set("12.5"), std::nullopt);
  EXPECT_EQ(value, 12.5);
  for (const auto* bad : {"0.5", "1001", "12,5", "1e999", "nan", "inf", "", "10 m"}) {
    EXPECT_TRUE(bin.set(bad)) << bad;
    EXPECT_EQ(value, 12.5) << bad;
  }
}

TEST(Options, TellUnitsByTheEndingOfTheName) {
  EXPECT_EQ(unit_of("bin_m"), "m");
  EXPECT_EQ(unit_of("velocity_sd_m_s"), "m/s");
  EXPECT_EQ(unit_of("air_density_kg_m3"), "kg/m3");
  EXPECT_EQ(unit_of("heading_sd_deg"), "deg");
  EXPECT_EQ(unit_of("gate_nis"), "");
}

TEST(Options, MapFlagsAndKeysOntoEachOther) {
  EXPECT_EQ(flag_of("takeoff_msl_m"), "--takeoff-msl-m");
  EXPECT_EQ(key_of("--takeoff-msl-m"), "takeoff_msl_m");
  EXPECT_EQ(key_of("takeoff-msl-m"), "takeoff_msl_m");
}

TEST(Options, SayThatASettingIsLeftOutRatherThanInventADefault) {
  std::optional<double> mass;
  Options options;
  options("mass_kg", mass, 0.01, 1000.0, "Mass.");
  EXPECT_EQ(options.last().facts, "kg; default not set; 0.01 to 1000");
  EXPECT_FALSE(mass);
}

}  // namespace
}  // namespace quadsonde::cli

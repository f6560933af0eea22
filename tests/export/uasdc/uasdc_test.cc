#include "export/uasdc/uasdc.h"

#include <cmath>

#include "export/atomic_file.h"
#include "tests/export/cf_netcdf/nc_reader.h"
#include "tests/export/cf_netcdf/run_python.h"
#include "tests/export/made_up.h"

namespace quadsonde {
namespace {

using estimator::Quality;
using product::AirRecord;
using product::NetcdfMetadata;
using product::Observations;
using support::NcReader;

NetcdfMetadata known() {
  NetcdfMetadata metadata;
  metadata.takeoff = ingest::GeoPoint{43.5657, 1.4815};
  metadata.takeoff_msl = ingest::MslHeight{150.4};
  metadata.station.operator_id = "007", metadata.station.airframe_id = "QS001";
  return metadata;
}

/// The made-up series as a climb and a descent.
estimator::WindSeries flown() {
  auto series = support::made_up_series();
  for (std::size_t i = 0; i < series.points.size(); ++i) series.points[i].v_up = i < 200 ? 11.5 : -11.5;
  return series;
}

Observations observed(const profiles::WindProfile& profile, const AirRecord& air = {}, bool keep_bad = false) {
  auto all = product::profile_observations(profile, flown(), air, known(), keep_bad, "UASDC netCDF");
  EXPECT_TRUE(all) << (all ? "" : ingest::to_string(all.error()));
  return all.value_or(Observations{});
}
std::string bytes_of(const Observations& observations, const NetcdfMetadata& metadata = known()) {
  auto bytes = product::uasdc_netcdf(observations, support::made_up_source(), metadata);
  EXPECT_TRUE(bytes) << (bytes ? "" : ingest::to_string(bytes.error()));
  return bytes.value_or("");
}

/// Air as sensors have it: 15 degrees at the ground, 0.65 degrees less every 100 m, 60 %.
ingest::Stream<ingest::AirSample> sensor(const estimator::WindSeries& series) {
  ingest::Stream<ingest::AirSample> air;
  air.source = "sensor file air.csv";
  for (const auto& p : series.points)
    air.push(p.time, {288.15 - 0.0065 * p.height_agl->m, 60.0, 99000 - 12 * p.height_agl->m});
  return air;
}

TEST(UasdcNetcdf, ObeysTheCampaignsRules) {
  const support::TemporaryFolder folder;
  const auto series = flown();
  const auto air = sensor(series);
  int number = 0;
  for (const AirRecord& record : {AirRecord{}, AirRecord{&air, nullptr}}) {
    const auto all = observed(support::made_up_profile(), record);
    const auto name = product::uasdc_file_name(known().station, all.all.front().utc);
    ASSERT_TRUE(name);
    std::filesystem::create_directory(folder / std::to_string(++number));
    const auto path = folder / std::to_string(number) / *name;
    ASSERT_TRUE(product::write_file(path, bytes_of(all)));
    EXPECT_EQ(support::python(QUADSONDE_UASDC_RULES, support::quoted(path)), "");
  }
}

TEST(UasdcNetcdf, WhatNobodyMeasuredIsThereWithoutAValue) {
  const NcReader file(bytes_of(observed(support::made_up_profile())));
  for (const char* name : {"air_temperature", "humidity_mixing_ratio", "air_pressure"}) {
    const auto values = file.numbers(name);
    ASSERT_EQ(values.size(), file.length("obs"));
    EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](double v) { return std::isnan(v); })) << name;
  }
  EXPECT_FALSE(file.has("relative_humidity"));
  EXPECT_FALSE(file.has("dew_point_temperature"));
  EXPECT_EQ(file.attribute("air_temperature", "comment"), "not measured on this flight");
}

TEST(UasdcNetcdf, SensorsAreAveragedOverTheInstantsOfTheirBin) {
  const auto series = flown();
  const auto air = sensor(series);
  const auto all = observed(support::made_up_profile(), {&air, nullptr});
  ASSERT_FALSE(all.all.empty());
  int with_air = 0;
  for (const auto& o : all.all) {
    if (!o.air.temperature_k) continue;
    ++with_air;
    const double middle = std::floor((o.altitude.m - 150) / 10) * 10 + 5;
    EXPECT_NEAR(*o.air.temperature_k, 288.15 - 0.0065 * middle, 0.0065 * 6) << o.altitude.m;
    EXPECT_NEAR(*o.air.relative_humidity_pct, 60, 1e-9);
    EXPECT_TRUE(o.air.mixing_ratio && o.air.dew_point_k && o.air.pressure_pa);
  }
  EXPECT_GT(with_air, 20);
  const NcReader file(bytes_of(all));
  EXPECT_EQ(file.attribute("air_temperature", "comment"), "by sensor file air.csv");
  EXPECT_TRUE(file.has("relative_humidity"));
}

TEST(UasdcNetcdf, TheAutopilotsBarometerGivesPressureButNoTemperature) {
  const auto series = flown();
  ingest::Stream<ingest::BarometerSample> barometer;
  barometer.source = "vehicle_air_data";
  for (const auto& p : series.points) barometer.push(p.time, {98000.0, 100.0});
  const auto all = observed(support::made_up_profile(), {nullptr, &barometer});
  EXPECT_EQ(all.pressure_from, "barometer of the autopilot (vehicle_air_data)");
  EXPECT_EQ(all.air_from, "");
  EXPECT_NEAR(*all.all[5].air.pressure_pa, 98000, 1e-6);
  EXPECT_FALSE(all.all[5].air.temperature_k);
  const auto air = sensor(series);
  EXPECT_LT(*observed(support::made_up_profile(), {&air, &barometer}).all[5].air.pressure_pa, 98990)
      << "what was made for it goes first";
}

TEST(UasdcNetcdf, BadIsLeftOutAndCountedUnlessKept) {
  auto profile = support::made_up_profile();
  profile.legs[0].bins[3].quality = Quality::bad;
  const auto all = observed(profile), kept = observed(profile, {}, true);
  EXPECT_EQ(all.bad_left_out, 1u);
  EXPECT_EQ(kept.all.size(), all.all.size() + 1);
  EXPECT_NE(NcReader(bytes_of(all)).attribute(nullptr, "comment").find("1 of quality bad"), std::string::npos);
}

TEST(UasdcNetcdf, ObservationsStandInTheOrderOfTimeAndOnlyWhereTheFlightWas) {
  const auto all = observed(support::made_up_profile());
  EXPECT_EQ(all.all.size(), 23u + 22u) << "the empty bin of the descent was never anywhere";
  for (std::size_t i = 1; i < all.all.size(); ++i) EXPECT_LE(all.all[i - 1].utc, all.all[i].utc);
  EXPECT_EQ(all.unplaced, 0u);
}

TEST(UasdcNetcdf, NorthIs360AndCalmIsZero) {
  auto profile = support::made_up_profile();
  profile.legs.resize(1);
  auto& bins = profile.legs[0].bins;
  bins[0].wind = support::estimate_of(5, 0, 0.1);
  bins[1].wind = support::estimate_of(0.03, 90, 0.001);
  bins[2].wind = support::estimate_of(0.3, 90, 0.3);
  const NcReader file(bytes_of(observed(profile)));
  const auto from = file.numbers("wind_direction"), speed = file.numbers("wind_speed");
  EXPECT_EQ(from[0], 360);
  EXPECT_EQ(from[1], 0);
  EXPECT_EQ(speed[1], 0);
  EXPECT_TRUE(std::isnan(from[2])) << "below twice its uncertainty";
  EXPECT_NEAR(speed[2], 0.3, 1e-9);
}

TEST(UasdcNetcdf, EveryStepOfASeriesCanBeAnObservation) {
  const auto series = flown();
  const auto air = sensor(series);
  const auto all = product::series_observations(series, {&air, nullptr}, false, "UASDC netCDF");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->all.size(), 400u);
  const NcReader file(bytes_of(*all));
  EXPECT_TRUE(std::isnan(file.numbers("wind_speed")[3])) << "not yet converged";
  EXPECT_FALSE(std::isnan(file.numbers("air_temperature")[3])) << "but measured";
  auto no_utc = series;
  for (auto& p : no_utc.points) p.utc.reset();
  EXPECT_NE(product::series_observations(no_utc, {}, false, "UASDC netCDF").error().hint.find("--start-utc"),
            std::string::npos);
}

TEST(UasdcFileName, HasOperatorAirframeAndFirstObservation) {
  // 2025-06-15T15:06:40.9Z: cut, not rounded.
  EXPECT_EQ(*product::uasdc_file_name(known().station, {1'750'000'000'900'000'000}),
            "UASDC_007_QS001_20250615150640Z.nc");
}

TEST(UasdcFileName, IsNotMadeUp) {
  for (auto take_away : {&product::Station::operator_id, &product::Station::airframe_id}) {
    auto station = known().station;
    (station.*take_away).clear();
    const auto name = product::uasdc_file_name(station, {0});
    ASSERT_FALSE(name);
    EXPECT_EQ(name.error().kind, ingest::Kind::usage);
    EXPECT_NE(name.error().hint.find("station.toml"), std::string::npos);
  }
  auto metadata = known();
  metadata.station = {};
  EXPECT_EQ(NcReader(bytes_of(observed(support::made_up_profile()), metadata)).attribute(nullptr, "platform_name"),
            "(none)");
}

TEST(UasdcNetcdf, SameInputGivesTheSameBytes) {
  const auto all = observed(support::made_up_profile());
  EXPECT_EQ(bytes_of(all), bytes_of(all));
}

TEST(UasdcNetcdf, WithoutAnyUsableWindThereIsNone) {
  auto profile = support::made_up_profile();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.quality = Quality::bad;
  const auto all =
      product::profile_observations(profile, support::made_up_series(), {}, known(), false, "UASDC netCDF");
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().kind, ingest::Kind::no_answer);
  EXPECT_NE(all.error().hint.find("--keep-bad"), std::string::npos);
  EXPECT_FALSE(product::uasdc_netcdf({}, support::made_up_source(), known()));
}

}  // namespace
}  // namespace quadsonde

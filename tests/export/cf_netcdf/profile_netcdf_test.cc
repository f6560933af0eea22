#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "export/atomic_file.h"
#include "export/cf_netcdf/cf_netcdf.h"
#include "export/cf_netcdf/hdf5_checksum.h"
#include "export/cf_netcdf/read_profile.h"
#include "export/csv/tables.h"
#include "export/geoid/geoid.h"
#include "nc_reader.h"
#include "profiles/air_levels.h"
#include "profiles/make_profile.h"
#include "run_python.h"
#include "tests/export/made_up.h"

namespace quadsonde {
namespace {

using estimator::Reason;
using product::NetcdfMetadata;
using product::profile_netcdf;
using support::NcReader;

constexpr ingest::UtcTime t0{1'750'000'000'000'000'000};

/// The made-up profile with the times of its legs: up, down 20 s later, all over both.
profiles::WindProfile flown() {
  auto profile = support::made_up_profile();
  const auto set = [&](std::size_t leg, double from, double to) {
    profile.legs[leg].utc_from = t0 + ingest::seconds(from);
    profile.legs[leg].utc_to = t0 + ingest::seconds(to);
  };
  set(0, 0, 300), set(1, 320, 700.5), set(2, 0, 700.5);
  return profile;
}
profiles::WindProfile merged_only() {
  auto profile = flown();
  profile.legs.erase(profile.legs.begin(), profile.legs.begin() + 2);
  return profile;
}
std::string bytes_of(const profiles::WindProfile& profile, const NetcdfMetadata& metadata = {}) {
  auto bytes = profile_netcdf(profile, support::made_up_source(), metadata);
  EXPECT_TRUE(bytes) << (bytes ? "" : ingest::to_string(bytes.error()));
  return bytes.value_or("");
}
ingest::Problem problem_of(const profiles::WindProfile& profile, const NetcdfMetadata& metadata = {}) {
  const auto bytes = profile_netcdf(profile, support::made_up_source(), metadata);
  EXPECT_FALSE(bytes);
  return bytes ? ingest::Problem{} : bytes.error();
}
void write_both(const support::TemporaryFolder& folder, const profiles::WindProfile& profile) {
  ASSERT_TRUE(product::write_profile_netcdf(folder / "profile.nc", profile, support::made_up_source()));
  ASSERT_TRUE(product::write_file(folder / "profile.csv", product::profile_csv(profile)));
}

TEST(ProfileNetcdf, XarrayNcoAndCdoReadTheNumbersOfTheCsv) {
  for (const auto& profile : {flown(), merged_only()}) {
    const support::TemporaryFolder folder;
    write_both(folder, profile);
    EXPECT_EQ(support::python(QUADSONDE_READ_BACK, "profile" + support::quoted(folder / "profile.nc") +
                                                       support::quoted(folder / "profile.csv")),
              "");
  }
}

TEST(ProfileNetcdf, ObeysCfAndAcddAndTheCheckFindsEveryBrokenRule) {
  const support::TemporaryFolder folder;
  write_both(folder, flown());
  EXPECT_EQ(support::python(QUADSONDE_CF_RULES, support::quoted(folder / "profile.nc")), "");
  EXPECT_EQ(support::python(QUADSONDE_CF_RULES, "--bites" + support::quoted(folder / "profile.nc")), "");
}

TEST(ProfileNetcdf, HoldsOneRecordForUpAndOneForDown) {
  const NcReader file(bytes_of(flown()));
  ASSERT_EQ(file.length("time"), 2u);
  EXPECT_EQ(file.numbers("leg"), (std::vector<double>{0, 1}));
  EXPECT_EQ(file.numbers("time_bnds"), (std::vector<double>{1.75e9, 1.75e9 + 300, 1.75e9 + 320, 1.75e9 + 700.5}));
  EXPECT_EQ(file.numbers("time"), (std::vector<double>{1.75e9 + 150, 1.75e9 + 510.25}));
}

TEST(ProfileNetcdf, HoldsTheMergedLegWhereThatIsAllThereIs) {
  const NcReader file(bytes_of(merged_only()));
  ASSERT_EQ(file.length("time"), 1u);
  EXPECT_EQ(file.numbers("leg"), std::vector<double>{2});
}

/// With everything that a bin can know.
profiles::WindProfile full() {
  auto profile = flown();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) {
      if (!bin.samples) continue;
      bin.sd_noise = 0.11, bin.sd_climb_law = 0.07;
      bin.pressure_pa = 99000 - 11 * bin.bottom, bin.temperature_k = 290 - 0.01 * bin.bottom;
      bin.relative_humidity_pct = 60 + 0.01 * bin.bottom;
    }
  profile.found = {{profiles::FoundLeg::Kind::ascent, ingest::LogTime{0}, ingest::LogTime{} + ingest::seconds(300), 300,
                    10.0, 240.0, 0.77, 0.1}};
  return profile;
}
profiles::WindProfile optimal() {
  auto profile = merged_only();
  auto& bins = profile.legs[0].bins;
  const auto n = static_cast<Eigen::Index>(bins.size());
  profile.method = profiles::Method::optimal;
  profile.optimal = profiles::OptimalDetails{{}, Eigen::MatrixXd::Identity(n, n) * 0.6, 0.6 * static_cast<double>(n)};
  profile.optimal->kernel(0, 1) = 0.25;
  for (auto& bin : bins) bin.resolution_m = 23.5, bin.freedom = 0.6, bin.sd_sampling.reset();
  return profile;
}

TEST(ProfileNetcdf, CarriesAllThatABinKnowsAndObeysTheRules) {
  for (const auto& profile : {full(), optimal()}) {
    const support::TemporaryFolder folder;
    write_both(folder, profile);
    EXPECT_EQ(support::python(QUADSONDE_READ_BACK, "profile" + support::quoted(folder / "profile.nc") +
                                                       support::quoted(folder / "profile.csv")),
              "");
    EXPECT_EQ(support::python(QUADSONDE_CF_RULES, support::quoted(folder / "profile.nc")), "");
  }
}

TEST(ProfileNetcdf, LeavesOutTheAirThatWasNotMeasuredAndTheKernelOfPlainBins) {
  const NcReader plain(bytes_of(flown())), measured(bytes_of(full())), nodes(bytes_of(optimal()));
  for (const auto* name : {"air_pressure", "air_temperature", "relative_humidity", "barometric_altitude"}) {
    EXPECT_FALSE(plain.has(name)) << name;
    EXPECT_TRUE(measured.has(name)) << name;
  }
  EXPECT_NEAR(measured.numbers("barometric_altitude")[0], *profiles::barometric_altitude(99000 - 110), 1e-9);
  EXPECT_FALSE(plain.has("averaging_kernel"));
  ASSERT_TRUE(nodes.has("averaging_kernel"));
  EXPECT_FLOAT_EQ(static_cast<float>(nodes.numbers("averaging_kernel")[1]), 0.25f) << "row by row";
}

TEST(ProfileNetcdf, TellsLegsLevelsAndTheUpDownTestAsTheJsonDoes) {
  const auto profile = full();
  const NcReader file(bytes_of(profile));
  const auto json = nlohmann::json::parse(product::profile_json(profile, support::made_up_source()));
  for (const auto& [attribute, key] : {std::pair("quadsonde_legs", "legs"), std::pair("quadsonde_levels", "levels"),
                                       std::pair("quadsonde_up_down", "up_down")})
    EXPECT_EQ(nlohmann::json::parse(file.attribute(nullptr, attribute)), json[key]) << attribute;
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_method"), "bins");
  EXPECT_EQ(json["legs"][0]["kind"], "ascent");
}

TEST(ProfileNetcdf, ReadAgainGivesThePartsOfTheUncertaintyAndTheAir) {
  const auto profile = full();
  // The made-up source has no real fingerprint, which a reader wants.
  auto source = support::made_up_source();
  source.sha256 = std::string(64, 'a');
  const auto stored = product::read_profile_netcdf(ingest::as_bytes(*profile_netcdf(profile, source)), "p.nc");
  ASSERT_TRUE(stored) << ingest::to_string(stored.error());
  const auto& bin = stored->records[0].bins[3];
  EXPECT_NEAR(*bin.noise, 0.11, 1e-6);
  EXPECT_NEAR(*bin.climb_law, 0.07, 1e-6);
  EXPECT_NEAR(*bin.calibration, 0.12, 1e-6);
  EXPECT_NEAR(*bin.trim, 0.05, 1e-6);
  EXPECT_NEAR(*bin.sampling, 0.3, 1e-6);
  EXPECT_NEAR(*bin.pressure_pa, 99000 - 11 * 40, 1e-9);
  EXPECT_FALSE(bin.freedom) << "bins have none";
  EXPECT_FALSE(stored->records[1].bins[14].noise) << "an empty bin has no error";
}

TEST(SectionNetcdf, HasARecordForEachAscentAndDescentAndIsNoProfileOfOneFlight) {
  profiles::Section section;
  const auto profile = full();
  for (int i = 0; i < 3; ++i)
    section.columns.push_back({"a b.ulg", profile.legs[static_cast<std::size_t>(i % 2)], t0 + ingest::seconds(1000 * i),
                               t0 + ingest::seconds(1000 * i + 300)});
  auto source = support::made_up_source();
  source.sha256 = std::string(64, 'a');
  const auto bytes = product::section_netcdf(section, source);
  ASSERT_TRUE(bytes) << ingest::to_string(bytes.error());
  const NcReader file(*bytes);
  EXPECT_EQ(file.numbers("leg"), (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(file.numbers("time"), (std::vector<double>{1.75e9 + 150, 1.75e9 + 1150, 1.75e9 + 2150}));
  EXPECT_EQ(file.text("profile_id").substr(0, 8), "a_b-1-up");
  const support::TemporaryFolder folder;
  ASSERT_TRUE(product::write_file(folder / "section.nc", *bytes));
  EXPECT_EQ(support::python(QUADSONDE_CF_RULES, support::quoted(folder / "section.nc")), "");
  EXPECT_EQ(product::read_profile_netcdf(ingest::as_bytes(*bytes), "s.nc").error().kind, ingest::Kind::unsupported);
  section.columns[1].from = section.columns[0].from, section.columns[1].to = section.columns[0].to;
  EXPECT_EQ(product::section_netcdf(section, source).error().kind, ingest::Kind::inconsistent);
}

TEST(ProfileNetcdf, RecordsStandInTheOrderOfTheirTimes) {
  auto profile = flown();
  std::swap(profile.legs[0].utc_from, profile.legs[1].utc_from);
  std::swap(profile.legs[0].utc_to, profile.legs[1].utc_to);
  const NcReader file(bytes_of(profile));
  EXPECT_EQ(file.numbers("leg"), (std::vector<double>{1, 0})) << "this flight came down first";
}

TEST(ProfileNetcdf, ALegWithoutAWindHasNoRecord) {
  auto profile = flown();
  for (auto& bin : profile.legs[1].bins) bin.wind = estimator::NoEstimate{Reason::no_samples}, bin.samples = 0;
  EXPECT_EQ(NcReader(bytes_of(profile)).numbers("leg"), std::vector<double>{0});
}

TEST(ProfileNetcdf, TheBinsOfAFlightKnowItsFirstAndLastSample) {
  auto series = support::made_up_series();
  for (std::size_t i = 0; i < series.points.size(); ++i) series.points[i].v_up = i < 200 ? 11.5 : -11.5;
  const auto profile = profiles::make_profile(series);
  ASSERT_TRUE(profile);
  ASSERT_EQ(profile->legs.size(), 3u);
  EXPECT_EQ(*profile->legs[0].utc_from, *series.points[10].utc) << "the first that has a wind";
  EXPECT_EQ(*profile->legs[1].utc_to, *series.points.back().utc);
  EXPECT_EQ(*profile->legs[2].utc_from, *profile->legs[0].utc_from);
  EXPECT_EQ(*profile->legs[2].utc_to, *profile->legs[1].utc_to);
}

TEST(ProfileNetcdf, AnEmptyBinIsMissingAndSaysWhy) {
  const NcReader file(bytes_of(flown()));
  const std::size_t empty = 23 + 14;  // of the second record
  for (const char* name :
       {"eastward_wind", "northward_wind", "wind_speed", "wind_from_direction", "eastward_wind_se", "wind_speed_se",
        "wind_sd_sampling", "wind_sd_calibration", "wind_sd_trim", "effective_n_obs", "sample_altitude", "sample_time"})
    EXPECT_TRUE(std::isnan(file.numbers(name)[empty])) << name;
  EXPECT_EQ(file.numbers("n_obs")[empty], 0);
  EXPECT_EQ(file.numbers("wind_qc")[empty], 9);
  EXPECT_EQ(file.numbers("wind_qc_reasons")[empty], 1 << static_cast<int>(Reason::no_samples));
  EXPECT_EQ(file.numbers("n_obs")[empty + 1], 100);
}

TEST(ProfileNetcdf, EachQualityHasItsFlagAndItsReasons) {
  auto profile = flown();
  profile.legs[0].bins[1].quality = estimator::Quality::bad;
  profile.legs[0].bins[1].reasons.add(Reason::model_fault);
  const NcReader file(bytes_of(profile));
  const auto flags = file.numbers("wind_qc"), reasons = file.numbers("wind_qc_reasons");
  EXPECT_EQ(flags[0], 1);
  EXPECT_EQ(reasons[0], 0);
  EXPECT_EQ(flags[1], 4);
  EXPECT_EQ(reasons[1], 1 << static_cast<int>(Reason::model_fault));
  EXPECT_FALSE(std::isnan(file.numbers("wind_speed")[1])) << "numbers stand also where they are bad";
  EXPECT_EQ(flags[23], 3);
  EXPECT_EQ(reasons[23], 1 << static_cast<int>(Reason::fast_descent));
}

TEST(ProfileNetcdf, NorthIs360AndACalmHasNoDirection) {
  auto profile = flown();
  profile.legs[0].bins[0].wind = support::estimate_of(5, 0, 0.1);
  profile.legs[0].bins[1].wind = support::estimate_of(5, 359.9999999, 0.1);
  profile.legs[0].bins[2].wind = support::estimate_of(0.1, 90, 0.1);
  const NcReader file(bytes_of(profile));
  const auto from = file.numbers("wind_from_direction");
  EXPECT_EQ(from[0], 360);
  EXPECT_EQ(from[1], 360);
  EXPECT_TRUE(std::isnan(from[2])) << "below twice its uncertainty";
  EXPECT_TRUE(std::isnan(file.numbers("wind_from_direction_se")[2]));
  EXPECT_NEAR(file.numbers("wind_speed")[2], 0.1, 1e-6);
}

TEST(ProfileNetcdf, AltitudeIsAboveTheSeaAndConvertsToTheOtherHeights) {
  const NcReader file(bytes_of(flown()));
  EXPECT_NEAR(file.numbers("surface_altitude")[0], 150, 1e-9);
  EXPECT_NEAR(file.numbers("altitude")[0], 165, 1e-9);
  EXPECT_NEAR(file.numbers("altitude_bnds")[1], 170, 1e-9);
  EXPECT_NEAR(file.numbers("height")[0], 15, 1e-9);
  EXPECT_NEAR(file.numbers("geoid_height")[0], *product::Geoid::open().undulation({43.5657, 1.4815}), 1e-9);
  EXPECT_EQ(file.attribute("crs", "geoid_name"), "EGM96");
  EXPECT_NE(file.attribute("geoid_height", "comment").find("0.25 degree"), std::string::npos) << "which grid it was";
}

TEST(ProfileNetcdf, BinsAboveTheSeaStayWhereTheyAre) {
  auto profile = flown();
  profile.datum = profiles::Datum::msl;
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.height_agl.reset();
  const NcReader file(bytes_of(profile));
  EXPECT_NEAR(file.numbers("altitude")[0], 15, 1e-9);
  EXPECT_FALSE(file.has("surface_altitude")) << "where take-off was is not known";
  EXPECT_FALSE(file.has("height")) << "a coordinate without values would forbid the data, by CF section 9.6";
}

TEST(ProfileNetcdf, WhatIsNotKnownIsLeftOut) {
  const NcReader file(bytes_of(flown()));
  for (const char* name :
       {"institution", "creator_name", "creator_email", "license", "project", "naming_authority", "acknowledgement"})
    EXPECT_EQ(file.attribute(nullptr, name), "(none)") << name;
  EXPECT_EQ(file.text("station_id"), "43.5657,1.4815") << "the site by its place: no identifier is made up";
  EXPECT_FALSE(file.has("upward_air_velocity")) << "nothing measured it";
}

TEST(ProfileNetcdf, WhatTheUserSaysStandsInTheFile) {
  NetcdfMetadata metadata;
  auto& station = metadata.station;
  station.wigos_id = "0-20000-0-15015", station.operator_id = "007", station.airframe_id = "QS001";
  station.institution = "Example Institute", station.license = "CC-BY-4.0", metadata.title = "A title";
  station.contact_name = "A Person", station.publisher_email = "data@example.org";
  station.platform_name = "quad-07", station.platform_type = "quadrotor", station.file = "station.toml";
  metadata.vehicle = "serial 1234";
  metadata.takeoff = ingest::GeoPoint{43.5, 1.5};
  metadata.takeoff_msl = ingest::MslHeight{151};
  const NcReader file(bytes_of(flown(), metadata));
  EXPECT_EQ(file.text("station_id"), "0-20000-0-15015");
  EXPECT_NE(file.attribute("station_id", "long_name").find("WIGOS"), std::string::npos);
  EXPECT_EQ(file.attribute(nullptr, "institution"), "Example Institute");
  EXPECT_EQ(file.attribute(nullptr, "title"), "A title");
  EXPECT_EQ(file.attribute(nullptr, "creator_name"), "A Person");
  EXPECT_EQ(file.attribute(nullptr, "creator_email"), "(none)") << "not said, so not there";
  EXPECT_EQ(file.attribute(nullptr, "publisher_email"), "data@example.org");
  EXPECT_EQ(file.attribute(nullptr, "platform"), "quadrotor quad-07") << "before the name in the log";
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_station_file"), "station.toml");
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_operator_id"), "007");
  EXPECT_EQ(file.numbers("lat")[0], 43.5);
  EXPECT_EQ(file.numbers("altitude")[0], 166);
}

TEST(ProfileNetcdf, AStationWithoutAWigosIdentifierGoesByItsName) {
  NetcdfMetadata metadata;
  metadata.station.name = "M\xc3\xbcllheim, \"field\"";
  const NcReader file(bytes_of(flown(), metadata));
  EXPECT_EQ(file.text("station_id"), metadata.station.name);
  EXPECT_EQ(file.attribute("station_id", "long_name").find("WIGOS"), std::string::npos);
}

TEST(ProfileNetcdf, NamesTheVehicleFileAndItsFingerprint) {
  auto source = support::made_up_source();
  EXPECT_EQ(NcReader(*profile_netcdf(flown(), source, {})).attribute(nullptr, "quadsonde_vehicle").find("sha256"),
            std::string::npos);
  source.vehicle_file = "quad-07.toml", source.vehicle_sha256 = "abcd";
  EXPECT_NE(NcReader(*profile_netcdf(flown(), source, {}))
                .attribute(nullptr, "quadsonde_vehicle")
                .find("\"file\":\"quad-07.toml\",\"sha256\":\"abcd\""),
            std::string::npos);
}

TEST(ProfileNetcdf, SaysWhereItsHeightsComeFrom) {
  auto source = support::made_up_source();
  const auto comment = [&] {
    const NcReader file(*profile_netcdf(flown(), source, {}));
    return file.attribute(nullptr, "comment") + "|" + file.attribute(nullptr, "quadsonde_heights");
  };
  EXPECT_NE(comment().find("that the log gives"), std::string::npos);
  EXPECT_NE(comment().find("|(none)"), std::string::npos);
  source.made_heights = "height above the ellipsoid (GPS) minus the geoid (EGM96)";
  EXPECT_EQ(comment().find("that the log gives"), std::string::npos);
  EXPECT_NE(comment().find("altitude is height above the ellipsoid (GPS)"), std::string::npos);
  EXPECT_NE(comment().find("|height above the ellipsoid (GPS) minus"), std::string::npos);
}

TEST(Hdf5Checksum, IsThatOfItsAuthorsOwnExamples) {
  // driver5() of lookup3.c.
  EXPECT_EQ(product::hdf5_checksum(""), 0xdeadbeefu);
  EXPECT_EQ(product::hdf5_checksum("Four score and seven years ago"), 0x17770551u);
}

TEST(ProfileNetcdf, SaysWhatItWasMadeOf) {
  const NcReader file(bytes_of(flown()));
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_input_file"), "hover.ulg");
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_input_sha256"), "00ff");
  EXPECT_NE(file.attribute(nullptr, "quadsonde_settings").find("\"bin_m\":10.0"), std::string::npos);
  EXPECT_NE(file.attribute(nullptr, "quadsonde_vehicle").find("\"linear_per_s\""), std::string::npos);
  EXPECT_NE(file.attribute(nullptr, "quadsonde_problems").find("a record is cut"), std::string::npos);
  EXPECT_EQ(file.attribute(nullptr, "quadsonde_problems").find("somewhere"), std::string::npos)
      << "a folder of the machine";
}

class Epoch {
 public:
  explicit Epoch(const char* value) {
    value ? ::setenv("SOURCE_DATE_EPOCH", value, 1) : ::unsetenv("SOURCE_DATE_EPOCH");
  }
  ~Epoch() { ::unsetenv("SOURCE_DATE_EPOCH"); }
};

TEST(ProfileNetcdf, SameInputGivesTheSameBytes) {
  const auto first = bytes_of(flown());
  ASSERT_GT(first.size(), 1000u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(bytes_of(flown()), first);
}

TEST(ProfileNetcdf, TheDateIsTheEpochAskedForElseTheEndOfTheLog) {
  NetcdfMetadata metadata;
  metadata.log_end = t0 + ingest::seconds(800);
  const auto date = [&](const char* epoch) {
    const Epoch set(epoch);
    return NcReader(bytes_of(flown(), metadata)).attribute(nullptr, "date_created");
  };
  EXPECT_EQ(date("1000000000"), "2001-09-09T01:46:40Z");
  EXPECT_EQ(date(nullptr), "2025-06-15T15:20:00Z");
  EXPECT_EQ(date("yesterday"), "2025-06-15T15:20:00Z");
  EXPECT_EQ(date("99999999999999"), "2025-06-15T15:20:00Z");
}

TEST(ProfileNetcdf, SeveralThreadsMayWriteAtOnce) {
  const auto expected = bytes_of(flown());
  std::vector<std::string> made(4);
  {
    std::vector<std::jthread> threads;
    for (auto& one : made)
      threads.emplace_back([&one] {
        for (int i = 0; i < 5; ++i) one = bytes_of(flown());
      });
  }
  for (const auto& one : made) EXPECT_EQ(one, expected);
}

TEST(ProfileNetcdf, WithoutUtcThereIsNone) {
  auto profile = flown();
  for (auto& leg : profile.legs) {
    leg.utc_from.reset(), leg.utc_to.reset();
    for (auto& bin : leg.bins) bin.utc.reset();
  }
  const auto problem = problem_of(profile);
  EXPECT_EQ(problem.kind, ingest::Kind::missing);
  EXPECT_NE(problem.hint.find("--start-utc"), std::string::npos);
  const support::TemporaryFolder folder;
  EXPECT_FALSE(product::write_profile_netcdf(folder / "a.nc", profile, support::made_up_source()));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ProfileNetcdf, WithoutAPlaceOrAHeightAboveTheSeaThereIsNone) {
  auto nowhere = flown(), no_height = flown();
  for (auto& leg : nowhere.legs)
    for (auto& bin : leg.bins) bin.place.reset();
  for (auto& leg : no_height.legs)
    for (auto& bin : leg.bins) bin.height_msl.reset();
  EXPECT_EQ(problem_of(nowhere).kind, ingest::Kind::missing);
  EXPECT_NE(problem_of(no_height).hint.find("--takeoff-msl"), std::string::npos);
  NetcdfMetadata metadata;
  metadata.takeoff_msl = ingest::MslHeight{100};
  EXPECT_EQ(NcReader(bytes_of(no_height, metadata)).numbers("altitude")[0], 115);
}

TEST(ProfileNetcdf, WithoutAnyWindThereIsNone) {
  auto profile = flown();
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.wind = estimator::NoEstimate{}, bin.samples = 0;
  EXPECT_EQ(problem_of(profile).kind, ingest::Kind::no_answer);
  profile.legs.clear();
  EXPECT_EQ(problem_of(profile).kind, ingest::Kind::no_answer);
}

TEST(ProfileNetcdf, LegsThatDoNotMatchAreRefused) {
  auto other_bins = flown(), same_mid = flown(), hole = flown();
  other_bins.legs[1].bins.pop_back();
  EXPECT_EQ(problem_of(other_bins).kind, ingest::Kind::inconsistent);
  same_mid.legs[1].utc_from = same_mid.legs[0].utc_from, same_mid.legs[1].utc_to = same_mid.legs[0].utc_to;
  EXPECT_EQ(problem_of(same_mid).kind, ingest::Kind::inconsistent);
  for (auto& leg : hole.legs) leg.bins.erase(leg.bins.begin() + 3);
  EXPECT_EQ(problem_of(hole).kind, ingest::Kind::inconsistent);
}

TEST(ProfileNetcdf, NamesThatAreNoTextDoNoHarm) {
  auto source = support::made_up_source();
  source.file = "we\xff\"'; rm <x> \xc3\xa9.ulg";
  NetcdfMetadata metadata;
  metadata.vehicle = std::string("a\0b\xf0", 4);
  const auto bytes = profile_netcdf(flown(), source, metadata);
  ASSERT_TRUE(bytes);
  const NcReader file(*bytes);
  EXPECT_EQ(file.attribute(nullptr, "id"), "we_____rm__x____-2");
  EXPECT_EQ(file.attribute(nullptr, "platform"), "multirotor ab\xef\xbf\xbd");
}

TEST(ProfileNetcdf, ATargetThatCannotBeWrittenIsLeftAsItWas) {
  const support::TemporaryFolder folder;
  const auto write = [&](const std::filesystem::path& path, bool overwrite = false) {
    return product::write_profile_netcdf(path, flown(), support::made_up_source(), {}, overwrite);
  };
  std::filesystem::create_directory(folder / "folder.nc");
  EXPECT_FALSE(write(folder / "folder.nc"));
  EXPECT_FALSE(write(folder / "not_there" / "a.nc"));
  support::write_bytes(folder / "old.nc", {1, 2, 3});
  EXPECT_FALSE(write(folder / "old.nc"));
  EXPECT_EQ(support::read_bytes(folder / "old.nc"), (std::vector<std::uint8_t>{1, 2, 3}));
  ASSERT_TRUE(write(folder / "old.nc", true));
  EXPECT_GT(support::read_bytes(folder / "old.nc").size(), 1000u);
}

TEST(ProfileNetcdf, ADiskThatFillsUpLeavesNothing) {
  const support::TemporaryFolder folder;
  // Files may not grow beyond 5 kB here: the write fails halfway, as on a full disk.
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{}, small{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  small = before;
  small.rlim_cur = 5000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto written = product::write_profile_netcdf(folder / "a.nc", flown(), support::made_up_source());
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ingest::Kind::write_failed);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace quadsonde

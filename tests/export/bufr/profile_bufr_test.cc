#include <cmath>

#include "decoded.h"
#include "export/bufr/bufr.h"
#include "tests/export/made_up.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using estimator::Quality;
using product::BufrForm;
using product::BufrRequest;
using product::NetcdfMetadata;
using profiles::Leg;
using profiles::LegName;
using support::EcMessage;
using support::MaybeNumber;

constexpr ingest::UtcTime t0{1'750'000'000'000'000'000};  // 2025-06-15T15:06:40Z
const MaybeNumber missing = std::nullopt;

NetcdfMetadata known() {
  NetcdfMetadata metadata;
  metadata.takeoff = ingest::GeoPoint{43.5657, 1.4815};
  metadata.takeoff_msl = ingest::MslHeight{150};
  metadata.station.wigos_id = "0-454-2-AWSNAMITAMBO";
  metadata.station.operator_id = "007", metadata.station.airframe_id = "QS001";
  return metadata;
}

/// One ascent of `count` bins from 0 m, wind from the west.
profiles::WindProfile ascent(int count, double bin_m = 10) {
  profiles::WindProfile profile;
  profile.bin_m = bin_m;
  Leg up{LegName::up, {}};
  for (int i = 0; i < count; ++i) {
    auto bin = support::bin_at(bin_m * i, 3 + 0.1 * i, 270, 0.4);
    bin.top = bin.bottom + bin_m;
    bin.place = ingest::GeoPoint{43.5657 + 1e-5 * i, 1.4815};
    up.bins.push_back(bin);
  }
  up.utc_from = t0, up.utc_to = t0 + ingest::seconds(130.5);
  profile.legs = {up};
  return profile;
}

/// The cases of the formats notes, section 3.4: around north, calm, missing, unknown direction.
profiles::WindProfile corner_cases() {
  auto profile = ascent(10);
  auto& bins = profile.legs[0].bins;
  const auto wind = [&](std::size_t i, double speed, double from, double sd) {
    bins[i].wind = support::estimate_of(speed, from, sd);
  };
  wind(0, 0.04, 90, 0.001);  // rounds to calm at 0.1 m/s
  wind(1, 1.2, 0, 0.1);      // north
  wind(2, 2.3, 359.6, 0.1);  // rounds to north
  wind(3, 2.3, 0.3, 0.1);    // the same from the other side
  wind(4, 5.25, 90, 0.1);
  bins[5].wind = estimator::NoEstimate{estimator::Reason::data_gap};
  bins[5].quality = Quality::none;
  wind(6, 0.5, 200, 0.4);  // direction not known
  bins[7].quality = Quality::doubtful;
  bins[8].quality = Quality::bad;
  return profile;
}

std::string bufr(const profiles::WindProfile& profile, BufrRequest request, const NetcdfMetadata& metadata = known(),
                 const product::AirRecord& air = {}) {
  const auto bytes = product::profile_bufr(profile, support::made_up_series(), air, metadata, request);
  EXPECT_TRUE(bytes) << (bytes ? "" : ingest::to_string(bytes.error()));
  return bytes.value_or("");
}
ingest::Problem problem_of(const profiles::WindProfile& profile, BufrRequest request = {}) {
  const auto bytes = product::profile_bufr(profile, support::made_up_series(), {}, known(), request);
  EXPECT_FALSE(bytes);
  return bytes ? ingest::Problem{} : bytes.error();
}

TEST(ProfilerBufr, BothDecodersGiveBackEveryValue) {
  const auto all = support::messages_in(bufr(ascent(12), {BufrForm::profiler}));
  ASSERT_EQ(all.size(), 1u);
  support::expect_decoders_agree(all[0]);
  const EcMessage m(all[0]);
  EXPECT_EQ(m.number("masterTablesVersionNumber"), MaybeNumber(31));
  EXPECT_EQ(m.number("wigosIssuerOfIdentifier"), MaybeNumber(454));
  EXPECT_EQ(m.text("wigosLocalIdentifierCharacter"), "AWSNAMITAMBO");
  EXPECT_EQ(m.number("heightOfStationGroundAboveMeanSeaLevel"), MaybeNumber(150));
  EXPECT_EQ(m.number(1, "latitude"), MaybeNumber(43.5657));
  EXPECT_EQ(m.number("measuringEquipmentType"), missing);
  for (std::size_t i = 0; i < 12; ++i) {
    const double x = static_cast<double>(i);
    EXPECT_EQ(m.number(i + 1, "height"), MaybeNumber(155 + 10 * x));
    EXPECT_NEAR(*m.number(i + 2, "latitude"), 43.5657 + 1e-5 * x, 1e-9);
    EXPECT_NEAR(*m.number(i + 1, "u"), 3 + 0.1 * x, 1e-9);
    EXPECT_EQ(m.number(i + 1, "v"), MaybeNumber(0));
    EXPECT_EQ(m.number(i + 1, "uncertaintyInUComponent"), MaybeNumber(0.4));
    EXPECT_EQ(m.number(i + 1, "uncertaintyInVComponent"), MaybeNumber(0.4));
    EXPECT_EQ(m.number(2 * i + 1, "qualityInformation"), MaybeNumber(0));
    EXPECT_EQ(m.number(i + 1, "w"), missing) << "nothing measured it";
    EXPECT_EQ(m.number(2 * i + 2, "qualityInformation"), missing);
    EXPECT_EQ(m.number(i + 1, "verticalResolution"), MaybeNumber(10));
  }
}

TEST(ProfilerBufr, ThePeriodHoldsTheWholeLegToTheMinute) {
  const EcMessage m(bufr(ascent(3), {BufrForm::profiler}));
  EXPECT_EQ(m.number("#1#year"), MaybeNumber(2025));
  EXPECT_EQ(m.number("#1#hour"), MaybeNumber(15));
  EXPECT_EQ(m.number("#1#minute"), MaybeNumber(6)) << "15:06:40 begins in minute 6";
  EXPECT_EQ(m.number("#2#hour"), MaybeNumber(15));
  EXPECT_EQ(m.number("#2#minute"), MaybeNumber(9)) << "15:08:50.5 ends before minute 9";
  EXPECT_EQ(m.number("typicalSecond"), MaybeNumber(40));
}

TEST(ProfilerBufr, MissingStaysMissingAndBadIsLeftOut) {
  const auto all = bufr(corner_cases(), {BufrForm::profiler});
  support::expect_decoders_agree(all);
  const EcMessage m(all);
  EXPECT_EQ(m.number("delayedDescriptorReplicationFactor"), MaybeNumber(9)) << "ten bins, one of them bad";
  EXPECT_EQ(m.number(6, "height"), MaybeNumber(205));
  for (const char* key : {"u", "v", "uncertaintyInUComponent", "uncertaintyInVComponent"})
    EXPECT_EQ(m.number(6, key), missing) << key;
  EXPECT_EQ(m.number(11, "qualityInformation"), missing);
  EXPECT_EQ(m.number(1, "u"), MaybeNumber(0)) << "calm is a wind of zero";
  EXPECT_EQ(m.number(1, "v"), MaybeNumber(0));
  EXPECT_EQ(m.number(15, "qualityInformation"), MaybeNumber(1)) << "doubtful is suspect";
  EXPECT_EQ(m.number(9, "height"), MaybeNumber(245)) << "after the bad one";
  const EcMessage kept(bufr(corner_cases(), {BufrForm::profiler, true}));
  EXPECT_EQ(kept.number("delayedDescriptorReplicationFactor"), MaybeNumber(10));
  EXPECT_EQ(kept.number(17, "qualityInformation"), MaybeNumber(1)) << "0 33 002 knows no worse";
}

TEST(ProfilerBufr, MoreThan254LevelsBecomeSeveralMessages) {
  for (const auto& [count, sizes] : std::map<int, std::vector<double>>{
           {254, {254}}, {255, {254, 1}}, {256, {254, 2}}, {300, {254, 46}}, {600, {254, 254, 92}}}) {
    const auto all = support::messages_in(bufr(ascent(count, 1), {BufrForm::profiler}));
    ASSERT_EQ(all.size(), sizes.size()) << count;
    double height = 150.5;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const EcMessage m(all[k]);
      EXPECT_EQ(m.number("delayedDescriptorReplicationFactor"), MaybeNumber(sizes[k]));
      for (std::size_t i = 1; i <= static_cast<std::size_t>(sizes[k]); ++i, ++height)
        ASSERT_EQ(m.number(i, "height"), MaybeNumber(std::round(height)));
    }
    support::expect_decoders_agree(all.back());
  }
}

TEST(ProfilerBufr, EachLegHasItsMessage) {
  auto profile = ascent(4);
  auto down = profile.legs[0], merged = profile.legs[0];
  down.name = LegName::down, merged.name = LegName::all;
  down.utc_from = t0 + ingest::seconds(200), down.utc_to = t0 + ingest::seconds(300);
  profile.legs = {profile.legs[0], down, merged};
  const auto all = support::messages_in(bufr(profile, {BufrForm::profiler}));
  ASSERT_EQ(all.size(), 2u) << "not a third time, merged";
  EXPECT_EQ(EcMessage(all[1]).number("#1#minute"), MaybeNumber(10));
}

TEST(ProfilerBufr, WhatDoesNotFitIsMissingAndTheRestStays) {
  auto profile = ascent(4);
  auto& bins = profile.legs[0].bins;
  bins[0].wind = support::estimate_of(450, 270, 0.4);
  bins[1].wind = support::estimate_of(5, 270, 500);
  std::get<estimator::WindEstimate>(bins[2].wind).v_NA_N.x() = std::nan("");
  const EcMessage m(bufr(profile, {BufrForm::profiler}));
  for (std::size_t rank : {1u, 3u})
    for (const char* key : {"u", "v", "uncertaintyInUComponent", "uncertaintyInVComponent"})
      EXPECT_EQ(m.number(rank, key), missing) << rank << key;
  EXPECT_EQ(m.number(2, "u"), MaybeNumber(5));
  EXPECT_EQ(m.number(2, "uncertaintyInUComponent"), missing);
  EXPECT_NEAR(*m.number(4, "u"), 3.3, 1e-9);
}

TEST(ProfilerBufr, WithoutAStationIdentifierItIsMissing) {
  auto metadata = known();
  metadata.station = {};
  const EcMessage m(bufr(ascent(2), {BufrForm::profiler}, metadata));
  EXPECT_EQ(m.number("wigosIdentifierSeries"), missing);
  EXPECT_EQ(m.number("wigosIssuerOfIdentifier"), missing);
  EXPECT_EQ(m.text("wigosLocalIdentifierCharacter"), "");
  EXPECT_EQ(m.number("blockNumber"), missing);
  metadata.station.wigos_id = "0-20000-0-07630";
  const EcMessage old(bufr(ascent(2), {BufrForm::profiler}, metadata));
  EXPECT_EQ(old.number("blockNumber"), MaybeNumber(7));
  EXPECT_EQ(old.number("stationNumber"), MaybeNumber(630));
}

/// Keys of the campaign's list and their descriptors, which stand once in a subset.
const std::map<std::string, std::string>& campaign_keys() {
  static const std::map<std::string, std::string> keys{{"wigosIdentifierSeries", "B01125"},
                                                       {"dewpointTemperature", "B12103"},
                                                       {"pressure", "B07004"},
                                                       {"nonCoordinateGeopotential", "B10003"},
                                                       {"height", "B07002"},
                                                       {"geopotentialHeight", "B07009"},
                                                       {"year", "B04001"},
                                                       {"month", "B04002"},
                                                       {"day", "B04003"},
                                                       {"hour", "B04004"},
                                                       {"minute", "B04005"},
                                                       {"second", "B04006"},
                                                       {"latitude", "B05001"},
                                                       {"longitude", "B06001"},
                                                       {"movingObservingPlatformSpeed", "B01013"},
                                                       {"detailedPhaseOfFlight", "B08009"},
                                                       {"flightLevel", "B07010"},
                                                       {"qualityInformation", "B33003"},
                                                       {"windDirection", "B11001"},
                                                       {"windSpeed", "B11002"},
                                                       {"airTemperature", "B12101"},
                                                       {"aircraftHumiditySensors", "B02170"},
                                                       {"relativeHumidity", "B13003"},
                                                       {"mixingRatio", "B13002"},
                                                       {"turbulentKineticEnergy", "B11073"},
                                                       {"meanTurbulenceIntensityEddyDissipationRate", "B11075"}};
  return keys;
}

void expect_campaign_decoders_agree(const std::string& message, std::size_t subsets) {
  const auto other = support::wreport_values(message);
  ASSERT_EQ(other.size(), subsets);
  const EcMessage m(message);
  for (const auto& [key, code] : campaign_keys()) {
    const auto values = m.numbers(key, subsets);
    for (std::size_t i = 0; i < subsets; ++i) {
      const auto of = support::of_code(other[i], code);
      ASSERT_EQ(of.size(), 1u) << code;
      ASSERT_EQ(of[0].has_value(), values[i].has_value()) << key << " of subset " << i;
      EXPECT_NEAR(of[0].value_or(0), values[i].value_or(0), 1e-9) << key << " of subset " << i;
    }
  }
}

TEST(CampaignBufr, NorthIs360CalmIsZeroAndMissingStaysMissing) {
  const auto message = bufr(corner_cases(), {BufrForm::uasdc});
  expect_campaign_decoders_agree(message, 9);
  const EcMessage m(message);
  EXPECT_EQ(m.numbers("windSpeed", 9), (std::vector<MaybeNumber>{0, 1.2, 2.3, 2.3, 5.3, missing, missing, 3.7, 3.9}));
  EXPECT_EQ(m.numbers("windDirection", 9),
            (std::vector<MaybeNumber>{0, 360, 360, 360, 90, missing, missing, 270, 270}));
  EXPECT_EQ(m.numbers("qualityInformation", 9), (std::vector<MaybeNumber>{0, 0, 0, 0, 0, missing, missing, 1, 0}));
  EXPECT_EQ(m.numbers("detailedPhaseOfFlight", 9), std::vector<MaybeNumber>(9, 5)) << "ascending";
  EXPECT_EQ(m.text("observerIdentification"), "007");
  EXPECT_EQ(m.text("aircraftRegistrationNumberOrOtherIdentification"), "QS001");
  const EcMessage kept(bufr(corner_cases(), {BufrForm::uasdc, true}));
  EXPECT_EQ(kept.numbers("qualityInformation", 10)[8], MaybeNumber(3)) << "bad";
}

TEST(CampaignBufr, TellsTimePlaceAndHeightOfEveryObservation) {
  const EcMessage m(bufr(ascent(3), {BufrForm::uasdc}));
  EXPECT_EQ(m.numbers("second", 3), (std::vector<MaybeNumber>{40, 50, 0}));
  EXPECT_EQ(m.numbers("minute", 3), (std::vector<MaybeNumber>{6, 6, 7}));
  EXPECT_EQ(m.numbers("flightLevel", 3), (std::vector<MaybeNumber>{155, 165, 175})) << "means of the samples";
  EXPECT_EQ(m.numbers("height", 3), (std::vector<MaybeNumber>{160, 170, 180})) << "steps of 10 m";
  EXPECT_NEAR(*m.numbers("latitude", 3)[2], 43.56572, 1e-9);
}

TEST(CampaignBufr, NothingIsMadeUpAboutTheAir) {
  const EcMessage m(bufr(ascent(3), {BufrForm::uasdc}));
  for (const char* key : {"airTemperature", "dewpointTemperature", "relativeHumidity", "mixingRatio", "pressure",
                          "geopotentialHeight", "turbulentKineticEnergy"})
    EXPECT_EQ(m.numbers(key, 3), std::vector<MaybeNumber>(3)) << key;
}

TEST(CampaignBufr, WhatASensorMeasuredIsThere) {
  // A series that is at 5 m and 15 m above take-off, one air sample at each.
  estimator::WindSeries series;
  ingest::Stream<ingest::AirSample> air;
  for (int i = 0; i < 20; ++i) {
    series.points.push_back(support::point_at(i, i < 10 ? 5 : 15, support::estimate_of(3, 270)));
    series.points.back().v_up = 1;
  }
  air.push(series.points[5].time, {285.15, 80.0, 99000.0});
  air.push(series.points[15].time, {284.15, std::nullopt, std::nullopt});
  auto profile = ascent(2);
  profile.legs[0].name = LegName::all;
  const auto message = product::profile_bufr(profile, series, {&air, nullptr}, known(), {BufrForm::uasdc});
  ASSERT_TRUE(message);
  expect_campaign_decoders_agree(*message, 2);
  const EcMessage m(*message);
  EXPECT_EQ(m.numbers("airTemperature", 2), (std::vector<MaybeNumber>{285.15, 284.15}));
  EXPECT_EQ(m.numbers("relativeHumidity", 2), (std::vector<MaybeNumber>{80, missing}));
  EXPECT_EQ(m.numbers("pressure", 2), (std::vector<MaybeNumber>{99000, missing}));
  EXPECT_NEAR(*m.numbers("mixingRatio", 2)[0], 0.00714, 1e-4);
  EXPECT_EQ(m.numbers("mixingRatio", 2)[1], missing);
  EXPECT_NEAR(*m.numbers("dewpointTemperature", 2)[0], 281.8, 0.1);
}

TEST(CampaignBufr, ManyObservationsBecomeSeveralMessages) {
  const auto all = support::messages_in(bufr(ascent(4500, 1), {BufrForm::uasdc}));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(EcMessage(all[0]).number("numberOfSubsets"), MaybeNumber(2000));
  EXPECT_EQ(EcMessage(all[2]).number("numberOfSubsets"), MaybeNumber(500));
  expect_campaign_decoders_agree(all[2], 500);
}

TEST(CampaignBufr, ASingleObservationIsAMessageToo) {
  const auto message = bufr(ascent(1), {BufrForm::uasdc});
  expect_campaign_decoders_agree(message, 1);
  EXPECT_EQ(EcMessage(message).number("windSpeed"), MaybeNumber(3));
}

TEST(OwnBufr, KeepsTenthsOfADegreeAndSpeedsWithoutADirection) {
  const auto message = bufr(corner_cases(), {BufrForm::own});
  support::expect_decoders_agree(message);
  const EcMessage m(message);
  const MaybeNumber speeds[] = {0.04, 1.2, 2.3, 2.3, 5.25, missing, 0.5, 3.7, 3.9};
  const MaybeNumber from[] = {90, 360, 359.6, 0.3, 90, missing, missing, 270, 270};
  const MaybeNumber quality[] = {0, 0, 0, 0, 0, missing, 0, 1, 0};
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(m.number(i + 1, "windSpeed"), speeds[i]) << i;
    EXPECT_EQ(m.number(i + 1, "windDirection"), from[i]) << i;
    EXPECT_EQ(m.number(i + 1, "qualityInformation"), quality[i]) << i;
  }
  EXPECT_EQ(m.number("second"), MaybeNumber(50)) << "15:08:50.5, the end of the leg";
  EXPECT_EQ(m.number(1, "timePeriod"), MaybeNumber(-131)) << "130.5 s before it";
  EXPECT_EQ(m.number(3, "timePeriod"), MaybeNumber(-121)) << "the second level was 120.5 s before it";
  EXPECT_EQ(m.number("timeSignificance"), MaybeNumber(2));
}

TEST(OwnBufr, IsSplitLikeTheOthers) {
  const auto all = support::messages_in(bufr(ascent(300, 1), {BufrForm::own}));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(EcMessage(all[1]).number("delayedDescriptorReplicationFactor"), MaybeNumber(46));
}

TEST(ProfileBufr, SameInputGivesTheSameBytes) {
  for (const auto form : {BufrForm::profiler, BufrForm::uasdc, BufrForm::own})
    EXPECT_EQ(bufr(corner_cases(), {form}), bufr(corner_cases(), {form}));
}

TEST(ProfileBufr, WithoutUtcOrWindOrRoomThereIsNone) {
  auto no_utc = ascent(3), all_bad = ascent(3), no_wind = ascent(3), thin = ascent(3, 0.5);
  no_utc.legs[0].utc_from.reset(), no_utc.legs[0].utc_to.reset();
  for (auto& bin : no_utc.legs[0].bins) bin.utc.reset();
  for (auto& bin : all_bad.legs[0].bins) bin.quality = Quality::bad;
  for (auto& bin : no_wind.legs[0].bins) bin.wind = estimator::NoEstimate{};
  for (const auto form : {BufrForm::profiler, BufrForm::uasdc, BufrForm::own}) {
    EXPECT_NE(problem_of(no_utc, {form}).what.find("no BUFR without UTC"), std::string::npos);
    EXPECT_NE(problem_of(all_bad, {form}).hint.find("--keep-bad"), std::string::npos);
    EXPECT_EQ(problem_of(no_wind, {form}).kind, ingest::Kind::no_answer);
    EXPECT_NE(problem_of(thin, {form}).hint.find("--bin-m"), std::string::npos);
  }
}

TEST(CampaignBufr, WithoutAnyDirectionThereIsNoMessageFullOfNothing) {
  auto calm = ascent(3);
  for (auto& bin : calm.legs[0].bins) bin.wind = support::estimate_of(0.8, 200, 0.6);
  const auto problem = problem_of(calm, {BufrForm::uasdc});
  EXPECT_EQ(problem.kind, ingest::Kind::no_answer);
  EXPECT_NE(problem.hint.find("--bufr profiler"), std::string::npos);
  EXPECT_FALSE(bufr(calm, {BufrForm::profiler}).empty());
}

TEST(CampaignBufr, UsesTheCampaignsOwnList) {
  QUADSONDE_NEEDS_DATA("uasdc/nc2bufr_UASDC_operatorID_airframeID_20230327025804Z.bufr");
  const auto theirs =
      support::read_bytes(support::data_file("uasdc/nc2bufr_UASDC_operatorID_airframeID_20230327025804Z.bufr"));
  const auto descriptors = [](const std::string& message) {
    const EcMessage m(message);
    return m.numbers("unexpandedDescriptors", 31);
  };
  EXPECT_EQ(descriptors(bufr(ascent(2), {BufrForm::uasdc})), descriptors({theirs.begin(), theirs.end()}));
}

}  // namespace
}  // namespace quadsonde

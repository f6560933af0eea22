#include "export/bufr/bufr_message.h"

#include <cmath>
#include <limits>

#include "decoded.h"
#include "export/bufr/elements.h"

namespace quadsonde {
namespace {

using product::BufrMessage;
using product::within;
using support::EcMessage;
using support::MaybeNumber;

constexpr double nan_ = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
constexpr ingest::UtcTime t0{1'777'890'600'000'000'000};  // 2026-05-04T10:30:00Z

/// Wind speed and direction of several subsets.
BufrMessage::Header winds(std::size_t subsets) { return {t0, {11001, 11002}, {}, subsets}; }

TEST(BufrMessage, ANanInAnArrayIsMissingAndNotTheSmallestValue) {
  // ecCodes 2.28 given [10, NaN, 20] writes 10, 10, 20 without a word.
  BufrMessage message(winds(3));
  message.set("windSpeed", std::vector<MaybeNumber>{10, nan_, 20});
  message.set("windDirection", std::vector<MaybeNumber>{std::nullopt, 90, -inf});
  const auto bytes = message.finish();
  ASSERT_TRUE(bytes) << ingest::to_string(bytes.error());
  const EcMessage decoded(*bytes);
  EXPECT_EQ(decoded.numbers("windSpeed", 3), (std::vector<MaybeNumber>{10, std::nullopt, 20}));
  EXPECT_EQ(decoded.numbers("windDirection", 3), (std::vector<MaybeNumber>{std::nullopt, 90, std::nullopt}));
  const auto other = support::wreport_values(*bytes);
  ASSERT_EQ(other.size(), 3u);
  EXPECT_EQ(other[0][1].number, MaybeNumber(10));
  EXPECT_EQ(other[1][1].number, std::nullopt);
  EXPECT_EQ(other[2][1].number, MaybeNumber(20));
}

TEST(BufrMessage, AnArrayOfNothingButNansIsMissingAndNotZero) {
  BufrMessage message(winds(3));
  message.set("windSpeed", std::vector<MaybeNumber>{nan_, nan_, nan_});
  message.set("windDirection", std::vector<MaybeNumber>(3));
  const auto bytes = message.finish();
  ASSERT_TRUE(bytes);
  EXPECT_EQ(EcMessage(*bytes).numbers("windSpeed", 3), std::vector<MaybeNumber>(3));
  EXPECT_EQ(EcMessage(*bytes).numbers("windDirection", 3), std::vector<MaybeNumber>(3));
}

TEST(BufrMessage, AScalarNanIsMissingAndWhatWasNeverSetIsToo) {
  BufrMessage message(winds(1));
  message.set("windSpeed", nan_);
  const auto bytes = message.finish();
  ASSERT_TRUE(bytes);
  EXPECT_EQ(EcMessage(*bytes).number("windSpeed"), std::nullopt);
  EXPECT_EQ(EcMessage(*bytes).number("windDirection"), std::nullopt);
}

TEST(BufrMessage, MoreLevelsThanItsCounterHoldsAreRefused) {
  // ecCodes 2.28 takes 300 and writes 44; 255 means missing.
  for (const long count : {255L, 256L, 300L, -1L}) {
    BufrMessage message({t0, {301150, 309021}, {count}});
    const auto bytes = message.finish();
    ASSERT_FALSE(bytes) << count;
    EXPECT_EQ(bytes.error().kind, ingest::Kind::write_failed);
    EXPECT_NE(bytes.error().what.find("number of levels"), std::string::npos);
  }
  BufrMessage most({t0, {301150, 309021}, {254}});
  const auto bytes = most.finish();
  ASSERT_TRUE(bytes);
  EXPECT_EQ(support::of_code(support::wreport_values(*bytes)[0], "B31001"), std::vector<MaybeNumber>{254});
}

TEST(BufrMessage, TheFirstErrorIsToldWithItsKey) {
  BufrMessage message(winds(2));
  message.set("windSpeeed", std::vector<MaybeNumber>{1, 2});
  message.set("windSpeed", std::vector<MaybeNumber>{1, 2, 3});
  const auto bytes = message.finish();
  ASSERT_FALSE(bytes);
  EXPECT_NE(bytes.error().what.find("windSpeeed"), std::string::npos) << bytes.error().what;
}

TEST(BufrMessage, ADescriptorThatNobodyKnowsIsAnErrorAndSaysNothingOfItsOwn) {
  testing::internal::CaptureStderr();
  BufrMessage message({t0, {311013}});
  EXPECT_FALSE(message.finish());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(BufrElement, KeepsToItsStepsAndToWhatItsBitsCanSay) {
  namespace element = product::element;
  EXPECT_EQ(within(element::wind_component, 1.26), MaybeNumber(1.3));
  EXPECT_EQ(within(element::wind_component, -409.6), MaybeNumber(-409.6));
  EXPECT_EQ(within(element::wind_component, 409.4), MaybeNumber(409.4));
  EXPECT_EQ(within(element::wind_component, 409.5), std::nullopt) << "all ones means missing";
  EXPECT_EQ(within(element::wind_component, -409.7), std::nullopt);
  EXPECT_EQ(within(element::altitude, 494.26), MaybeNumber(490));
  EXPECT_EQ(within(element::height, -1000), MaybeNumber(-1000));
  EXPECT_EQ(within(element::height, 130070), MaybeNumber(130070));
  EXPECT_EQ(within(element::height, 130071), std::nullopt);
  EXPECT_EQ(within(element::mixing_ratio, 0.0123456789), MaybeNumber(0.0123456789));
  for (const double none : {nan_, inf, -inf, 1e300}) EXPECT_EQ(within(element::height, none), std::nullopt);
  EXPECT_FALSE(std::signbit(*within(element::wind_component, -0.04))) << "no minus zero";
}

TEST(BufrMessage, TimesAreCutToTheSecondAlsoBeforeAndAfterTheTurnOfAYear) {
  const auto t = product::split_utc({1'767'225'599'999'999'999});
  EXPECT_EQ(t.year, 2025);
  EXPECT_EQ(t.month, 12);
  EXPECT_EQ(t.day, 31);
  EXPECT_EQ(t.hour, 23);
  EXPECT_EQ(t.minute, 59);
  EXPECT_EQ(t.second, 59);
}

}  // namespace
}  // namespace quadsonde

#include "ingest/flight/time.h"

#include <gtest/gtest.h>

#include <limits>

namespace quadsonde::ingest {
namespace {

constexpr std::int64_t gps_epoch_unix_s = 315964800;

struct LeapSecond {
  const char* from;
  int gps_minus_utc;
};
// IERS Bulletin C, as in formats/LOGS.md section 7.
constexpr LeapSecond leap_seconds[] = {
    {"1980-01-06", 0},  {"1981-07-01", 1},  {"1982-07-01", 2},  {"1983-07-01", 3},  {"1985-07-01", 4},
    {"1988-01-01", 5},  {"1990-01-01", 6},  {"1991-01-01", 7},  {"1992-07-01", 8},  {"1993-07-01", 9},
    {"1994-07-01", 10}, {"1996-01-01", 11}, {"1997-07-01", 12}, {"1999-01-01", 13}, {"2006-01-01", 14},
    {"2009-01-01", 15}, {"2012-07-01", 16}, {"2015-07-01", 17}, {"2017-01-01", 18},
};

TEST(GpsTime, CountsEveryLeapSecondFromItsOwnMidnightOn) {
  for (const auto& row : leap_seconds) {
    const auto midnight = parse_iso8601(row.from);
    ASSERT_TRUE(midnight) << row.from;
    const std::int64_t gps_s = midnight->ns / 1'000'000'000 - gps_epoch_unix_s + row.gps_minus_utc;
    EXPECT_EQ(gps_minus_utc_s(gps_s), row.gps_minus_utc) << row.from;
    if (row.gps_minus_utc > 0) {
      EXPECT_EQ(gps_minus_utc_s(gps_s - 1), row.gps_minus_utc - 1) << row.from;
    }
  }
  EXPECT_EQ(gps_minus_utc_s(1'481'000'000), 18) << "none since 2017";
}

TEST(GpsTime, GivesTheWorkedValuesOfTheLogNotes) {
  EXPECT_EQ(to_iso8601(utc_from_gps(2046, 312'816'600), 3), "2019-03-27T14:53:18.600Z");
  EXPECT_EQ(to_iso8601(utc_from_gps(1966, 38'980'800), 3), "2017-09-10T10:49:22.800Z");
}

TEST(GpsTime, BeginsAtItsEpoch) { EXPECT_EQ(to_iso8601(utc_from_gps(0, 0), 0), "1980-01-06T00:00:00Z"); }

TEST(Iso8601, IsReadInEveryFormThatLogsWrite) {
  const UtcTime t{1'795'435'200'250'000'000};
  for (const auto* text : {"2026-11-23T12:00:00.250Z", "2026-11-23 12:00:00.25", "2026-11-23T12:00:00,250z",
                           "2026/11/23 12:00:00.250", "  2026-11-23T12:00:00.250Z ", "2026-11-23T14:00:00.25+02:00",
                           "2026-11-23T06:30:00.250-0530", "2026-11-23T13:00:00.250 +01"}) {
    const auto read = parse_iso8601(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(read->ns, t.ns) << text;
  }
  EXPECT_EQ(parse_iso8601("2026-11-23T12:00Z")->ns, t.ns - 250'000'000);
  EXPECT_EQ(parse_iso8601("2026-11-23")->ns, t.ns - 43'200'250'000'000);
}

TEST(Iso8601, RefusesWhatIsNoTime) {
  for (const auto* text : {"",
                           "Z",
                           "2026",
                           "2026-11",
                           "2026-13-01",
                           "2026-02-30",
                           "2026-11-23T",
                           "2026-11-23T12",
                           "2026-11-23T12:60",
                           "2026-11-23T25:00:00",
                           "2026-11-23T24:00:01",
                           "2026-11-23T12:00:00Zulu",
                           "2026-11-23T12:00:00+2",
                           "2026-11-23T12:00:00+24:00",
                           "2026-11-23T12:00:00+02:60",
                           "0026-11-23",
                           "-026-11-23",
                           "12:00:00",
                           "23.11.2026",
                           "2026-11-23T-1:00:00",
                           "9999-12-31T00:00:00Z"})
    EXPECT_FALSE(parse_iso8601(text)) << text;
}

TEST(Iso8601, IsWrittenWithZAndNeverRoundsUpToAnInstantYetToCome) {
  const UtcTime almost{1'795'435'199'999'999'999};
  EXPECT_EQ(to_iso8601(almost, 0), "2026-11-23T11:59:59Z");
  EXPECT_EQ(to_iso8601(almost, 3), "2026-11-23T11:59:59.999Z");
  EXPECT_EQ(to_iso8601(almost, 6), "2026-11-23T11:59:59.999999Z");
  EXPECT_EQ(to_iso8601(almost, 9), "2026-11-23T11:59:59.999999999Z");
  EXPECT_EQ(to_iso8601(UtcTime{-1}, 9), "1969-12-31T23:59:59.999999999Z") << "before 1970 too";
  EXPECT_EQ(to_iso8601(UtcTime{951'782'400'000'000'000}, 0), "2000-02-29T00:00:00Z");
}

TEST(Iso8601, BothWaysGivesTheSameNanosecond) {
  for (const std::int64_t ns : {0LL, 1LL, -1LL, 1'234'567'890'123'456'789LL, -1'234'567'890'987'654'321LL}) {
    const auto back = parse_iso8601(to_iso8601(UtcTime{ns}, 9));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->ns, ns);
  }
}

TEST(Duration, FromSecondsIsTheNearestNanosecondAndSaturates) {
  EXPECT_EQ(seconds(1.5).count(), 1'500'000'000);
  EXPECT_EQ(seconds(-2e-10).count(), 0);
  EXPECT_EQ(seconds(-6e-10).count(), -1);
  EXPECT_EQ(seconds(1e30).count(), 9'200'000'000'000'000'000);
  EXPECT_EQ(seconds(-std::numeric_limits<double>::infinity()).count(), -9'200'000'000'000'000'000);
  EXPECT_EQ(seconds(std::numeric_limits<double>::quiet_NaN()).count(), 0);
}

TEST(Clock, KnowsNoUtcUntilItIsTold) {
  const Clock clock;
  EXPECT_FALSE(clock.to_utc(LogTime{5}));
  EXPECT_FALSE(clock.to_log(UtcTime{5}));
  EXPECT_FALSE(ClockEstimator{}.estimate("nothing").utc_minus_log);
}

TEST(Clock, ConvertsBothWaysByOneOffset) {
  ClockEstimator estimator;
  estimator.add(LogTime{1'000}, UtcTime{1'600'000'000'000'001'000});
  const Clock clock = estimator.estimate("GPS week and time");
  EXPECT_EQ(clock.source, "GPS week and time");
  EXPECT_EQ(clock.to_utc(LogTime{7})->ns, 1'600'000'000'000'000'007);
  EXPECT_EQ(clock.to_log(UtcTime{1'600'000'000'000'000'007})->ns, 7);
}

TEST(Clock, IsNotLedAstrayByWrongDatesBeforeTheFix) {
  ClockEstimator estimator;
  const std::int64_t offset = 1'600'000'000'000'000'000;
  for (std::int64_t i = 0; i < 100; ++i) {
    const LogTime t{i * 200'000'000};
    // Until the fix the receiver tells 1980, then for a moment a date half a day off.
    const std::int64_t told = i < 30 ? 315'964'800'000'000'000 : i < 40 ? offset + 43'200'000'000'000 : offset;
    const std::int64_t jitter = (i % 5 - 2) * 10'000'000;
    estimator.add(t, UtcTime{t.ns + told + jitter});
  }
  const Clock clock = estimator.estimate("GPS");
  ASSERT_TRUE(clock.utc_minus_log);
  EXPECT_NEAR(static_cast<double>(clock.utc_minus_log->count() - offset), 0, 2e7) << "within the jitter of 20 ms";
  EXPECT_LT(clock.uncertainty_s, 0.15) << "the wrong dates do not widen it";
  EXPECT_GE(clock.uncertainty_s, 0.1) << "the receiver's own delay is never known";
}

TEST(Clock, AdmitsTheSpreadOfItsPairs) {
  ClockEstimator estimator;
  for (std::int64_t i = 0; i < 101; ++i) estimator.add(LogTime{0}, UtcTime{(i % 2 ? 1 : -1) * 400'000'000});
  EXPECT_GT(estimator.estimate("x").uncertainty_s, 0.4);
}

TEST(Latency, IsTheMedianAgeWithoutWhatIsNone) {
  EXPECT_FALSE(latency_of({}));
  const auto latency = latency_of({0.01, 0.02, 0.03, -5, 1e9});
  ASSERT_TRUE(latency);
  EXPECT_DOUBLE_EQ(latency->median_s, 0.02);
  EXPECT_FALSE(latency->at_least);
  EXPECT_FALSE(latency_of({0.01, -1, -1})) << "mostly nonsense is no answer";
}

// A receiver whose fixes are logged 20 to 100 ms after they were made, on a clock that drifts by 50 ppm: of the delay
// the log shows what comes on top of the least.
TEST(Latency, AgainstUtcShowsWhatIsLaterThanTheQuickest) {
  ClockEstimator estimator;
  EXPECT_FALSE(estimator.latency());
  for (std::int64_t i = 0; i < 6000; ++i) {
    const UtcTime utc{1'600'000'000'000'000'000 + i * 200'000'000};
    const std::int64_t delay = 20'000'000 + (i * 7 % 9) * 10'000'000, drift = i * 10'000;
    // Before the fix the date is wrong.
    const std::int64_t told = i < 10 ? utc.ns - 86'400'000'000'000 : utc.ns;
    estimator.add(LogTime{i * 200'000'000 + delay + drift}, UtcTime{told});
  }
  const auto latency = estimator.latency();
  ASSERT_TRUE(latency);
  EXPECT_TRUE(latency->at_least);
  EXPECT_NEAR(latency->median_s, 0.040, 0.005);
}

}  // namespace
}  // namespace quadsonde::ingest

// Points are not differences: each forbidden sum is a concept that must not hold.
#include <gtest/gtest.h>

#include <concepts>

#include "ingest/flight/height.h"
#include "ingest/flight/time.h"

namespace quadsonde::ingest {
namespace {

template <class A, class B>
concept Addable = requires(A a, B b) {
  a + b;
};
template <class A, class B>
concept Subtractable = requires(A a, B b) {
  a - b;
};
template <class A, class B>
concept Comparable = requires(A a, B b) {
  a < b;
}
|| requires(A a, B b) { a == b; };
template <class From, class To>
concept Converts = std::convertible_to<From, To> || std::constructible_from<To, From>;

// Instants.
static_assert(!Addable<LogTime, LogTime> && !Addable<UtcTime, UtcTime>, "two instants have no sum");
static_assert(!Addable<LogTime, UtcTime> && !Addable<UtcTime, LogTime>);
static_assert(!Subtractable<LogTime, UtcTime> && !Subtractable<UtcTime, LogTime>, "clocks do not mix");
static_assert(!Comparable<LogTime, UtcTime> && !Comparable<UtcTime, LogTime>);
static_assert(!Converts<LogTime, UtcTime> && !Converts<UtcTime, LogTime>, "only a Clock converts");
static_assert(!Addable<LogTime, double> && !Addable<UtcTime, double>, "a bare number has no unit");
static_assert(!Addable<Duration, LogTime>, "a duration has no instant added to it");
static_assert(Addable<LogTime, Duration> && Addable<UtcTime, Duration> && Subtractable<LogTime, Duration>);
static_assert(std::same_as<decltype(LogTime{} - LogTime{}), Duration>);
static_assert(std::same_as<decltype(UtcTime{} - UtcTime{}), Duration>);

// Heights: three data, nine pairs.
template <class A, class B>
constexpr bool apart = !Addable<A, B> && !Subtractable<A, B> && !Comparable<A, B> && !Converts<A, B>;
static_assert(apart<MslHeight, GroundHeight> && apart<GroundHeight, MslHeight>);
static_assert(apart<MslHeight, EllipsoidHeight> && apart<EllipsoidHeight, MslHeight>);
static_assert(apart<GroundHeight, EllipsoidHeight> && apart<EllipsoidHeight, GroundHeight>);
static_assert(!Addable<MslHeight, MslHeight> && !Addable<GroundHeight, GroundHeight> &&
                  !Addable<EllipsoidHeight, EllipsoidHeight>,
              "two heights have no sum");
static_assert(!std::convertible_to<MslHeight, double> && !std::convertible_to<double, MslHeight>);
static_assert(std::same_as<decltype(MslHeight{} - MslHeight{}), double>);

TEST(Heights, ConvertOnlyThroughTheTakeoffPointOrTheGeoid) {
  EXPECT_EQ(above_takeoff(MslHeight{260}, MslHeight{150}), GroundHeight{110});
  EXPECT_EQ(above_sea(GroundHeight{110}, MslHeight{150}), MslHeight{260});
  EXPECT_EQ(above_geoid(EllipsoidHeight{200}, 48.5), MslHeight{151.5});
}

TEST(LogTime, DifferencesAndSumsAgree) {
  const LogTime a{100}, b{350};
  EXPECT_EQ((b - a).count(), 250);
  EXPECT_EQ(a + (b - a), b);
  EXPECT_EQ(b - Duration(250), a);
}

}  // namespace
}  // namespace quadsonde::ingest

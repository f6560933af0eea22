// One fault in a BUFR message, and the rule that finds it.
#include <fstream>
#include <functional>
#include <iterator>

#include "export/bufr/bufr_message.h"
#include "faulty.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using product::BufrForm;
using support::broken_rules;

std::string message_of(BufrForm form) {
  auto series = support::made_up_series();
  for (std::size_t i = 0; i < series.points.size(); ++i) series.points[i].v_up = i < 200 ? 11.5 : -11.5;
  auto bytes = product::profile_bufr(support::made_up_profile(), series, {}, support::known_site(), {form, false});
  EXPECT_TRUE(bytes) << (bytes ? "" : ingest::to_string(bytes.error()));
  return bytes.value_or("");
}

/// The first message alone.
std::string one_message() {
  const auto all = message_of(BufrForm::profiler);
  const auto octet = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<unsigned char>(all[at])); };
  return all.substr(0, octet(4) << 16 | octet(5) << 8 | octet(6));
}

TEST(ValidateBufr, FindsNothingWrongWithOurOwnMessages) {
  for (const auto form : {BufrForm::profiler, BufrForm::uasdc, BufrForm::own})
    EXPECT_EQ(broken_rules(message_of(form), "profile.bufr"), std::set<std::string>{});
}

struct ByteFault {
  const char* rule;
  void (*inject)(std::string& message);
};
/// Of the same name for GoogleTest.
std::ostream& operator<<(std::ostream& out, const ByteFault& fault) { return out << fault.rule; }
class BufrByteFault : public testing::TestWithParam<ByteFault> {};

TEST_P(BufrByteFault, IsFound) {
  auto bytes = one_message();
  GetParam().inject(bytes);
  EXPECT_TRUE(broken_rules(bytes, "faulty.bufr").contains(GetParam().rule));
}

// Section 0 has 8 octets; section 1 begins at 8 and section 3 behind it, as there is no section 2.
std::size_t third_section(const std::string& message) { return 8 + static_cast<unsigned char>(message[10]); }

constexpr ByteFault byte_faults[] = {
    {"bufr.end", [](std::string& m) { m.replace(m.size() - 4, 4, "7778"); }},
    {"bufr.length", [](std::string& m) { m.resize(m.size() / 2); }},
    {"bufr.edition", [](std::string& m) { m[7] = 9; }},
    {"bufr.section-length", [](std::string& m) { m[third_section(m)] = 1; }},
    {"bufr.master-table", [](std::string& m) { m[8 + 3] = 10; }},
    {"bufr.table-version", [](std::string& m) { m[8 + 13] = 99; }},
    {"bufr.date", [](std::string& m) { m[8 + 17] = 13; }},
    {"bufr.time-typical", [](std::string& m) { m[8 + 16] = static_cast<char>(m[8 + 16] - 1); }},
    {"bufr.subsets", [](std::string& m) { m[third_section(m) + 4] = m[third_section(m) + 5] = 0; }},
    {"bufr.local-descriptor", [](std::string& m) { m[third_section(m) + 8] = static_cast<char>(200); }},
    {"bufr.decode",
     [](std::string& m) {
       m[third_section(m) + 7] = 0x3E;
       m[third_section(m) + 8] = 3;
     }},
};

INSTANTIATE_TEST_SUITE_P(Bytes, BufrByteFault, testing::ValuesIn(byte_faults),
                         [](const auto& fault) { return support::test_name(fault.param.rule); });

/// One level of wind and air with one thing changed.
using Change = std::function<void(product::BufrMessage&)>;
std::string level(const Change& change) {
  product::BufrMessage::Header header;
  header.typical = ingest::UtcTime{1'750'000'000'000'000'000};
  header.descriptors = {301150, 301011, 301013, 301021, 7007, 11001, 11002, 11110, 12101, 7004, 7007};
  product::BufrMessage message(header);
  message.set("wigosIdentifierSeries", 0), message.set("wigosIssuerOfIdentifier", 454),
      message.set("wigosIssueNumber", 2);
  message.set_text("wigosLocalIdentifierCharacter", "AWSNAMITAMBO");
  message.set("year", 2025), message.set("month", 6), message.set("day", 15);
  message.set("hour", 15), message.set("minute", 6), message.set("second", 40);
  message.set("latitude", 43.5), message.set("longitude", 1.5);
  message.set(1, "height", 160), message.set(2, "height", 170);
  message.set("windDirection", 270), message.set("windSpeed", 5.2), message.set("uncertaintyInUComponent", 0.3);
  message.set("airTemperature", 288), message.set("pressure", 99000);
  change(message);
  auto bytes = message.finish();
  EXPECT_TRUE(bytes) << (bytes ? "" : ingest::to_string(bytes.error()));
  return bytes.value_or("");
}

TEST(ValidateBufr, FindsEachImplausibleValueByItsRuleAlone) {
  using M = product::BufrMessage;
  EXPECT_EQ(broken_rules(level([](M&) {}), "x.bufr"), std::set<std::string>{});
  const std::pair<const char*, Change> faults[] = {
      {"bufr.direction", [](M& m) { m.set("windDirection", 400); }},
      {"bufr.calm", [](M& m) { m.set("windDirection", 0); }},
      {"bufr.half-a-wind", [](M& m) { m.set("windSpeed", std::nullopt); }},
      {"bufr.uncertainty", [](M& m) { m.set("uncertaintyInUComponent", -0.3); }},
      {"bufr.not-missing", [](M& m) { m.set("airTemperature", 0); }},
      {"bufr.place", [](M& m) { m.set("latitude", std::nullopt); }},
      {"bufr.time", [](M& m) { m.set("month", std::nullopt); }},
      {"bufr.heights", [](M& m) { m.set(2, "height", 100); }},
      {"bufr.station", [](M& m) { m.set("wigosIssueNumber", std::nullopt); }},
  };
  for (const auto& [rule, change] : faults)
    EXPECT_EQ(broken_rules(level(change), "x.bufr"), support::only(rule)) << rule;
}

TEST(ValidateBufr, ReadsTheOctetsOfOldEditionsWhereTheyStand) {
  // Edition 3 has its data sub-category (here 91 and 0) where edition 4 does not, and the year without a century.
  for (const auto* name : {"reference/bufr/pilot-ecmwf-geopotential.bufr", "reference/bufr/synop-oddgust.bufr"}) {
    QUADSONDE_NEEDS_DATA(name);
    std::ifstream in(support::data_file(name), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(broken_rules(bytes, name), support::only("bufr.edition-old")) << name;
    bytes[8 + 10] = 99;
    EXPECT_TRUE(broken_rules(bytes, name).contains("bufr.table-version")) << name;
  }
}

TEST_P(BufrByteFault, LeavesTheOtherMessagesReadable) {
  auto bytes = one_message();
  GetParam().inject(bytes);
  const auto both = bytes + one_message();
  const auto said = product::validate({reinterpret_cast<const std::uint8_t*>(both.data()), both.size()}, "two.bufr");
  ASSERT_TRUE(said);
  EXPECT_TRUE(std::any_of(said->findings.begin(), said->findings.end(),
                          [](const auto& f) { return f.where.starts_with("message 1"); }));
  EXPECT_FALSE(std::any_of(said->findings.begin(), said->findings.end(), [](const auto& f) {
    return f.where.starts_with("message 2") && f.rule->severity == product::Severity::error;
  }));
}

}  // namespace
}  // namespace quadsonde

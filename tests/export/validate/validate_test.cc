#include "export/validate/validate.h"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "faulty.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using ingest::Kind;

ingest::Result<product::Validation> validated(const std::string& bytes, const std::string& name) {
  return product::validate({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name);
}

TEST(Validate, RefusesWhatIsNoneOfItsKinds) {
  const auto text = validated("time_s,wind_east_m_s\n0,3\n", "wind.csv");
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().kind, Kind::unsupported);
  const auto empty = validated("", "empty.nc");
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().kind, Kind::unsupported);
  EXPECT_FALSE(product::validate_file("/"));
  EXPECT_FALSE(product::validate_file("nowhere.nc"));
}

TEST(Validate, KeepsToEightyColumnsAndEndsWithTheVerdict) {
  const auto cut = validated(std::string("CDF\x01") + std::string(40, 'x'), "cut.nc");
  ASSERT_TRUE(cut);
  EXPECT_FALSE(cut->conformant());
  const auto text = product::validation_text(*cut);
  std::istringstream lines(text);
  std::string line, last;
  for (; std::getline(lines, line); last = line) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_EQ(last, "not conformant: 1 error, 0 warnings, 0 notes");
}

TEST(Validate, GivesTheSameAsJson) {
  const auto said = validated(support::profile_file(), "profile.nc");
  ASSERT_TRUE(said);
  const auto json = nlohmann::json::parse(product::validation_json(*said));
  EXPECT_EQ(json["schema"], "quadsonde.validation/1");
  EXPECT_EQ(json["conformant"], true);
  EXPECT_EQ(json["findings"].size(), said->findings.size());
  for (const auto& finding : json["findings"]) EXPECT_FALSE(finding["source"].get<std::string>().empty());
}

TEST(Validate, HasNoRuleThatNothingUses) {
  std::string code;
  for (const auto& entry : std::filesystem::directory_iterator(QUADSONDE_SOURCE "/export/validate")) {
    if (entry.path().extension() != ".cc") continue;
    std::ifstream file(entry.path());
    code.append(std::istreambuf_iterator<char>(file), {});
  }
  for (const auto& rule : product::all_rules())
    EXPECT_NE(code.find("rule(\"" + std::string(rule.id) + "\")"), std::string::npos) << rule.id;
}

}  // namespace
}  // namespace quadsonde

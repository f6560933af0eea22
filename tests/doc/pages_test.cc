#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

#include "estimator/smoother/wind_series.h"
#include "export/csv/section_tables.h"
#include "export/csv/tables.h"

namespace quadsonde {
namespace {

namespace fs = std::filesystem;
using estimator::Quality;
using estimator::Reason;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> pages() {
  std::vector<fs::path> found = {QUADSONDE_SOURCE "/README.md", QUADSONDE_SOURCE "/estimator/MODEL.md"};
  for (const auto& entry : fs::directory_iterator(QUADSONDE_SOURCE "/doc"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  return found;
}

/// The part of doc/why_doubtful.md that speaks of one quality: from its heading to the next.
std::string section_of(const std::string& page, Quality quality) {
  const std::string headings[] = {"## Only told", "(`doubtful`)", "(`bad`)", "(`none`)"};
  const auto begin = page.find(headings[static_cast<int>(quality)]);
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find("\n## ", begin) - begin);
}

TEST(Pages, ExplainEveryReasonUnderTheQualityThatFollowsFromIt) {
  const auto page = text_of(QUADSONDE_SOURCE "/doc/why_doubtful.md");
  ASSERT_FALSE(page.empty());
  for (int i = 0; i < static_cast<int>(Reason::count); ++i) {
    const auto reason = static_cast<Reason>(i);
    const auto section = section_of(page, estimator::at_best(reason));
    EXPECT_NE(section.find(fmt::format("| `{}` |", estimator::name(reason))), std::string::npos)
        << estimator::name(reason) << " has no row among the " << estimator::name(estimator::at_best(reason));
  }
}

/// The names in the first line of a table.
std::vector<std::string> columns_of(const std::string& csv) {
  std::vector<std::string> names;
  std::istringstream line(csv.substr(0, csv.find('\n')));
  for (std::string name; std::getline(line, name, ',');) names.push_back(name);
  return names;
}

/// The names in the first cells of a page's table under a heading, in their order.
std::vector<std::string> rows_under(const std::string& page, const std::string& heading) {
  const auto begin = page.find(heading);
  if (begin == std::string::npos) return {};
  const auto section = page.substr(begin, page.find("\n## ", begin) - begin);
  const std::regex row(R"(\n\| `([^`]+)` \|)");
  std::vector<std::string> names;
  for (std::sregex_iterator match(section.begin(), section.end(), row), end; match != end; ++match)
    names.push_back((*match)[1]);
  return names;
}

TEST(Pages, ExplainEveryColumnOfTheTablesInItsOrder) {
  const auto page = text_of(QUADSONDE_SOURCE "/doc/columns.md");
  EXPECT_EQ(rows_under(page, "## `wind.csv`"), columns_of(product::wind_csv({})));
  auto columns = columns_of(product::profile_csv({}));
  EXPECT_EQ(rows_under(page, "## `profile.csv`"), columns);
  for (const auto& column : rows_under(page, "## A section")) columns.push_back(column);
  EXPECT_EQ(columns_of(product::section_csv({})), columns);
}

TEST(Pages, LinkOnlyToWhatIsThere) {
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  for (const auto& path : pages()) {
    const auto text = text_of(path);
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match)
      EXPECT_TRUE(fs::exists(path.parent_path() / (*match)[1].str())) << path.filename() << ": " << (*match)[1];
  }
}

}  // namespace
}  // namespace quadsonde

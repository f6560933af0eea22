#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "cli/options.h"
#include "export/pipeline/settings.h"
#include "tests/cli/program.h"

namespace quadsonde::cli {
namespace {

using support::quadsonde;
using testing::HasSubstr;

const std::vector<std::string> verbs{"run", "info", "estimate", "profile", "convert", "simulate"};

TEST(Help, ListsEveryVerbAndFitsIn80Columns) {
  const support::TemporaryFolder folder;
  const auto overview = quadsonde({"--help"}, folder.path());
  EXPECT_EQ(overview.code, 0);
  for (const auto& verb : verbs) {
    EXPECT_THAT(overview.out, HasSubstr("  " + verb + " "));
    const auto help = quadsonde({verb, "--help"}, folder.path());
    EXPECT_EQ(help.code, 0) << verb;
    EXPECT_EQ(help.err, "") << verb;
    for (const auto* common : {"--output", "--json", "--force", "--quiet", "--settings"})
      EXPECT_THAT(help.out, HasSubstr(common)) << verb;
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << verb << ": " << line;
  }
}

TEST(Help, TellsUnitDefaultAndRangeOfEverySetting) {
  product::PipelineSettings settings;
  Options options;
  product::describe(settings, options);
  const support::TemporaryFolder folder;
  for (const auto* verb : {"run", "profile"}) {
    auto help = quadsonde({verb, "--help"}, folder.path()).out;
    std::replace(help.begin(), help.end(), '\n', ' ');
    std::string plain;
    for (const char c : help)
      if (c != ' ' || plain.empty() || plain.back() != ' ') plain += c;
    for (const auto& option : options.all()) {
      EXPECT_THAT(plain, HasSubstr(option.on_by_default ? "[no-]" + option.flag.substr(2) : option.flag)) << verb;
      EXPECT_THAT(plain, HasSubstr("(" + option.facts + ")")) << verb << " " << option.flag;
      EXPECT_THAT(plain, HasSubstr(option.sentence)) << verb << " " << option.flag;
    }
  }
  EXPECT_EQ(options.find("bin_m")->facts, "m; default 10; 1 to 1000");
}

TEST(Help, NamesTheVersion) {
  const support::TemporaryFolder folder;
  EXPECT_THAT(quadsonde({"--version"}, folder.path()).out,
              testing::MatchesRegex("quadsonde [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Usage, WrongOnesExitWith2AndSayWhereTheHelpIs) {
  const support::TemporaryFolder folder;
  support::place_flight(folder / "a.csv");
  const std::vector<std::vector<std::string>> wrong{{},
                                                    {"fly"},
                                                    {"profile"},
                                                    {"profile", "a.csv", "--no-such-flag"},
                                                    {"profile", "a.csv", "--bin-m", "0"},
                                                    {"profile", "a.csv", "--bin-m", "ten"},
                                                    {"profile", "a.csv", "--leg", "sideways"},
                                                    {"profile", "a.csv", "-o", "x.xyz"},
                                                    {"profile", "a.csv", "--settings", "none.toml"},
                                                    {"estimate", "a.csv", "--flight", "7"},
                                                    {"convert", "a.csv"},
                                                    {"convert", "a.csv", "-o", "x.txt"},
                                                    {"run", "a.csv", "--vehicle", "class:balloon"}};
  for (const auto& arguments : wrong) {
    const auto ended = quadsonde(arguments, folder.path());
    EXPECT_EQ(ended.code, 2) << testing::PrintToString(arguments) << ended.err;
    if (arguments.empty()) continue;  // prints the overview
    EXPECT_EQ(ended.out, "") << testing::PrintToString(arguments);
    EXPECT_THAT(ended.err, HasSubstr("error: ")) << testing::PrintToString(arguments);
  }
  EXPECT_EQ(support::tree(folder.path()), std::vector<std::string>{"a.csv"});
}

}  // namespace
}  // namespace quadsonde::cli

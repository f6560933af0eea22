// Every file of the samples through the program as a user would give it, and the table of what came out:
//   test_replay_samples --gtest_filter=Samples.EndInAnAnswerOrInAClearProblem
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace quadsonde {
namespace {

using Json = nlohmann::json;
using support::Ended;

/// Everything below a folder of the data but the conformance set, which is one kind of file 416 times.
std::vector<std::filesystem::path> files_below(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(support::data_file(folder)))
    if (entry.is_regular_file() && entry.path().string().find("mcap-conformance") == std::string::npos)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string text_or(const Json& json, const std::string& otherwise) {
  return json.is_string() ? json.get<std::string>() : otherwise;
}

std::string vehicle_of(const Json& boot) {
  std::vector<std::string> words;
  for (const auto* key : {"autopilot", "firmware", "airframe"}) {
    auto word = text_or(boot[key], "");
    if (word.size() > 18) word = word.substr(0, 18);
    if (!word.empty()) words.push_back(word);
  }
  if (boot["rotors"].is_number()) words.push_back(fmt::format("{} rotors", boot["rotors"].get<int>()));
  if (boot["simulated"] == true) words.push_back("simulated");
  return words.empty() ? "-" : fmt::format("{}", fmt::join(words, ", "));
}

std::string streams_of(const Json& boot) {
  std::vector<std::string> words;
  for (const auto& stream : boot["streams"]) {
    const auto rate = stream["rate_hz"];
    words.push_back(stream["name"].get<std::string>() +
                    (rate.is_number() ? fmt::format(" {:.0f}", rate.get<double>()) : ""));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// "3: 37 bytes belong to no message and were skipped, ..."
std::string problems_of(const Json& facts) {
  std::vector<std::string> words;
  for (const auto& problem : facts["problems"]) words.push_back(text_or(problem["what"], "?").substr(0, 60));
  return words.empty() ? "none" : fmt::format("{}: {}", words.size(), fmt::join(words, "; "));
}

std::string last_sentence(const std::string& err) {
  const auto at = err.rfind("error: ");
  auto text = at == std::string::npos ? std::string("?") : err.substr(at + 7);
  std::replace(text.begin(), text.end(), '\n', ' ');
  text = text.substr(0, text.find(" -> "));
  const auto colon = text.find(": ");
  return colon == std::string::npos ? text : text.substr(colon + 2, 140);
}

/// Mean of all instants: "1.0 m/s from 132 (sd 0.9), good 0 %".
std::string wind_of(const Json& wind) {
  double east = 0, north = 0, sd = 0, n = 0, good = 0;
  const auto& points = wind["rows"];
  for (const auto& point : points) {
    if (!point["wind_east_m_s"].is_number()) continue;
    east += point["wind_east_m_s"].get<double>(), north += point["wind_north_m_s"].get<double>();
    if (point["sd_wind_east_m_s"].is_number())
      sd +=
          std::hypot(point["sd_wind_east_m_s"].get<double>(), point["sd_wind_north_m_s"].get<double>()) / std::sqrt(2);
    good += point["quality"] == "good";
    n += 1;
  }
  if (n == 0) return "none";
  const double from = std::fmod(std::atan2(-east, -north) * 180 / M_PI + 360, 360);
  return fmt::format("{:.1f} m/s from {:.0f} (sd {:.1f}), {:.0f} % good", std::hypot(east, north) / n, from, sd / n,
                     100 * good / n);
}

void expect_clear(const Ended& ended, const std::filesystem::path& file) {
  EXPECT_TRUE(ended.code == 0 || ended.code == 1 || ended.code == 3) << ended.code << "\n" << ended.err;
  if (ended.code != 1) return;
  auto err = ended.err;
  err.erase(std::remove_if(err.begin(), err.end(), [](char c) { return c == '\n' || c == ' '; }), err.end());
  EXPECT_NE(err.find(file.filename().string()), std::string::npos) << "the message names no file: " << ended.err;
  EXPECT_NE(ended.err.find("->"), std::string::npos) << "the message says no next step: " << ended.err;
  EXPECT_TRUE(ended.out.empty());
}

std::string row_of(const std::filesystem::path& file) {
  const support::TemporaryFolder folder;
  const auto name = std::filesystem::relative(file, support::data_file("")).string();
  const auto info = support::quadsonde({"info", file.string(), "--json"}, folder.path());
  expect_clear(info, file);
  if (info.code == 1) return fmt::format("| {} | - | - | - | - | - | {} |", name, last_sentence(info.err));
  const auto facts = Json::parse(info.out);
  const auto answer = support::quadsonde({"estimate", file.string(), "--json"}, folder.path());
  expect_clear(answer, file);
  EXPECT_TRUE(facts["can_give_wind"] == true || answer.code == 1) << "info says that there is no wind to be had";
  double longest = 0;
  for (const auto& flight : facts["flights"]) longest = std::max(longest, flight["duration_s"].get<double>());
  const auto& boots = facts["boots"];
  return fmt::format("| {} | {}, {} messages | {} | {} x {:.0f} s | {} | {} | {} |", name,
                     text_or(facts["format"], "?"), facts["messages"].get<std::uint64_t>(),
                     boots.empty() ? "-" : vehicle_of(boots[0]), facts["flights"].size(), longest,
                     boots.empty() ? "-" : streams_of(boots[0]), problems_of(facts),
                     answer.code == 1 ? "no: " + last_sentence(answer.err) : wind_of(Json::parse(answer.out)));
}

TEST(Samples, EndInAnAnswerOrInAClearProblem) {
  QUADSONDE_NEEDS_DATA("logs/PROVENANCE.md");
  fmt::print(
      "| file | format | vehicle | flights, longest | streams, Hz | problems | wind |\n|--|--|--|--|--|--|--|\n");
  std::size_t rows = 0;
  for (const auto* folder : {"logs", "flights"})
    for (const auto& file : files_below(folder)) {
      SCOPED_TRACE(file.string());
      fmt::print("{}\n", row_of(file));
      std::fflush(stdout);
      ++rows;
    }
  EXPECT_GT(rows, 60u);
}

TEST(Samples, OfTheMcapConformanceSetAreReadWithoutAFlight) {
  QUADSONDE_NEEDS_DATA("logs/mcap-conformance");
  const support::TemporaryFolder folder;
  std::vector<std::string> arguments{"info", "--json"};
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(support::data_file("logs/mcap-conformance")))
    if (entry.path().extension() == ".mcap") arguments.push_back(entry.path().string()), ++files;
  const auto ended = support::quadsonde(arguments, folder.path());
  EXPECT_TRUE(ended.code == 0 || ended.code == 3) << ended.code << ended.err.substr(0, 500);
  const auto all = Json::parse(ended.out);
  ASSERT_EQ(all.size(), files);
  for (const auto& facts : all) EXPECT_EQ(facts["can_give_wind"], false) << facts["file"];
}

/// What the program says to a sample, without line breaks.
std::string said(const Ended& ended) {
  std::string text;
  for (const char c : ended.err + ended.out) {
    const bool blank = c == '\n' || c == ' ';
    if (!blank || (!text.empty() && text.back() != ' ')) text += blank ? ' ' : c;
  }
  return text;
}

struct NoFlight {
  const char* file;
  const char* said;
  int code;
};

TEST(Samples, ThatAreNoFlightOfAMultirotorAreSaidToBeNone) {
  QUADSONDE_NEEDS_DATA("logs/PROVENANCE.md");
  const support::TemporaryFolder folder;
  const NoFlight samples[] = {
      {"logs/ulog/roboto_fmuv5_test.ulg", "the vehicle never leaves the ground", 1},
      {"logs/ulog/sample_logging_tagged_and_default_params.ulg", "the vehicle never leaves the ground", 1},
      {"logs/ulog/sitl_iris_v18.ulg", "the vehicle never leaves the ground", 1},
      {"logs/ulog/sample.ulg", "neither a valid velocity nor a valid position", 1},
      {"logs/ulog/sample_appended_multiple.ulg", "neither a valid velocity nor a valid position", 1},
      {"logs/ulog/sample_log_small.ulg", "a VTOL aircraft with wings", 1},
      {"logs/dataflash/pymavlink_test_plane.BIN", "a fixed-wing aircraft", 1},
      {"logs/tlog/uavlogviewer_vtol_sitl.tlog", "a VTOL aircraft with wings", 1},
      {"logs/paparazzi/09_05_13__14_38_13.data", "a fixed-wing aircraft", 1},
      {"logs/ulog/sample_px4_events.ulg", "the log is of a simulated flight", 3},
  };
  for (const auto& sample : samples) {
    const auto ended = support::quadsonde({"estimate", support::data_file(sample.file).string()}, folder.path());
    EXPECT_EQ(ended.code, sample.code) << sample.file;
    EXPECT_NE(said(ended).find(sample.said), std::string::npos) << sample.file << ": " << said(ended);
  }
  for (const auto* file : {"ulog/sitl_iris_v18.ulg", "ulog/sample_logging_tagged_and_default_params.ulg",
                           "ulog/sample_px4_events.ulg", "tlog/uavlogviewer_vtol_sitl.tlog"}) {
    const auto ended =
        support::quadsonde({"info", support::data_file("logs/" + std::string(file)).string()}, folder.path());
    EXPECT_NE(said(ended).find("simulated: no air moved"), std::string::npos) << file;
  }
}

}  // namespace
}  // namespace quadsonde

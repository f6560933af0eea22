// Every count and value of EXPECTED_COUNTS.json (three independent decoders agree on them).
#include <fstream>
#include <nlohmann/json.hpp>

#include "ingest/ulog/container.h"
#include "ingest/ulog/flight_from_ulog.h"
#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

nlohmann::json expected() {
  return nlohmann::json::parse(std::ifstream(support::data_file("logs/EXPECTED_COUNTS.json")));
}

class UlogSample : public ::testing::TestWithParam<const char*> {};

void check_value(const ulog::Log& log, const ulog::Topic& topic, std::size_t row, const std::string& path,
                 const nlohmann::json& want) {
  SCOPED_TRACE(topic.name + "." + path + " of row " + std::to_string(row));
  const auto column = ulog::find_column(log.formats, topic.name, path);
  ASSERT_TRUE(column);
  if (want.is_number_integer()) {
    EXPECT_EQ(ulog::integer(log.payload(topic, row), *column), want.get<std::int64_t>());
  } else if (want.is_string()) {
    EXPECT_EQ(want, "nan");
    EXPECT_TRUE(std::isnan(ulog::number(log.payload(topic, row), *column).value()));
  } else {
    EXPECT_DOUBLE_EQ(ulog::number(log.payload(topic, row), *column).value(), want.get<double>());
  }
}

TEST_P(UlogSample, HasTheCountsAndValuesOfIndependentDecoders) {
  const std::string name = std::string("ulog/") + GetParam();
  QUADSONDE_NEEDS_DATA("logs/" + name);
  const auto want = expected().at(name);
  const auto bytes = support::read_bytes(support::data_file("logs/" + name));
  const auto log = ulog::read(bytes, name).value();

  EXPECT_EQ(log.data_messages, want.at("data_messages"));
  EXPECT_EQ(log.start_us, want.at("start_timestamp_us"));
  EXPECT_EQ(log.parameters.size(), want.at("initial_params"));
  std::size_t untagged = 0;
  for (const auto& text : log.texts) untagged += !text.tag;
  EXPECT_EQ(untagged, want.at("logged_messages"));
  std::vector<int> dropouts;
  for (const auto& dropout : log.dropouts) dropouts.push_back(dropout.duration_ms);
  EXPECT_EQ(dropouts, want.at("dropouts_ms").get<std::vector<int>>());
  nlohmann::json counts = nlohmann::json::object();
  for (const auto& topic : log.topics)
    if (topic.messages > 0) counts[topic.name + "[" + std::to_string(topic.multi_id) + "]"] = topic.messages;
  EXPECT_EQ(counts, want.at("counts"));

  for (const auto& [topic_name, rows] : want.at("samples").items()) {
    const auto topic =
        std::find_if(log.topics.begin(), log.topics.end(), [&](const auto& t) { return t.name == topic_name; });
    ASSERT_NE(topic, log.topics.end());
    const std::pair<const char*, std::size_t> places[] = {
        {"first", 0}, {"mid", topic->payload_at.size() / 2}, {"last", topic->payload_at.size() - 1}};
    for (const auto& [place, row] : places)
      for (const auto& [path, value] : rows.at(place).items()) check_value(log, *topic, row, path, value);
  }
  for (const auto& problem : log.problems) ADD_FAILURE() << to_string(problem);
}

INSTANTIATE_TEST_SUITE_P(All, UlogSample,
                         ::testing::Values("esc_status_log.ulg", "roboto_fmuv5_test.ulg", "sample.ulg",
                                           "sample_appended_multiple.ulg", "sample_log_small.ulg",
                                           "sample_logging_tagged_and_default_params.ulg", "sample_px4_events.ulg",
                                           "sitl_iris_v18.ulg", "yule_powers.ulg", "yule_short_list.ulg",
                                           "yule_trig_stats.ulg"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           for (auto& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

}  // namespace
}  // namespace quadsonde::ingest

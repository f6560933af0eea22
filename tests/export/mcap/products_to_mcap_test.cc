// Winds and profiles in MCAP, read back by the schemas that stand in the file.
#include "export/mcap/products_to_mcap.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "export/csv/tables.h"
#include "export/mcap/foxglove_layout.h"
#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/mcap/message_decoder.h"
#include "ingest/mcap/reader.h"
#include "sample_flight.h"
#include "tests/export/made_up.h"

namespace quadsonde {
namespace {

using ingest::Json;
using product::FlightFileSettings;
using support::made_up_profile;
using support::made_up_series;
using support::made_up_source;

FlightFileSettings encoded(FlightFileSettings::Encoding encoding) {
  FlightFileSettings settings;
  settings.encoding = encoding;
  return settings;
}
constexpr auto kBoth = {FlightFileSettings::Encoding::protobuf, FlightFileSettings::Encoding::json};

/// Topics of a file, each with its messages, decoded by nothing but their schemas.
std::map<std::string, std::vector<Json>> decoded(ingest::Bytes bytes) {
  std::map<std::string, std::vector<Json>> topics;
  ingest::mcap::RecordReader reader(bytes, {ingest::Reading::strict, true, 1u << 28, ""});
  for (ingest::mcap::Record record; reader.next(record);) {
    if (record.op != ingest::mcap::Op::message) continue;
    const auto message = record.message();
    const auto& channel = *reader.registry().channel(message.channel_id);
    const auto* schema = reader.registry().schema(channel.schema_id);
    EXPECT_FALSE(schema->data.empty());
    auto decoder = ingest::decoder_for(channel, schema);
    Json json;
    EXPECT_TRUE(decoder && decoder->decode(message.data, json)) << channel.topic;
    json["log_time"] = message.log_time;
    topics[channel.topic].push_back(std::move(json));
  }
  EXPECT_TRUE(reader.complete());
  return topics;
}

/// Every column of a table has a field of its name; equal to half its last digit, or unknown in both.
void expect_row(const nlohmann::ordered_json& row, const Json& message) {
  for (const auto& [name, value] : row.items()) {
    if (name == "utc" || name == "leg" || (name == "mode" && !message.contains("mode"))) continue;
    if (value.is_null()) {
      EXPECT_FALSE(message.contains(name)) << name;
    } else if (value.is_number()) {
      ASSERT_TRUE(message.contains(name)) << name;
      EXPECT_NEAR(message[name].get<double>(), value.get<double>(), 0.006) << name;
    } else {
      EXPECT_EQ(message[name], Json(value)) << name;
    }
  }
}

TEST(WindMcap, HoldsEveryColumnOfTheTableUnderItsName) {
  const auto series = made_up_series();
  const auto rows = nlohmann::ordered_json::parse(product::wind_json(series, made_up_source()))["rows"];
  for (const auto encoding : kBoth) {
    const auto bytes = product::wind_mcap(series, made_up_source(), encoded(encoding));
    ASSERT_TRUE(bytes);
    const auto topics = decoded(ingest::as_bytes(*bytes));
    ASSERT_EQ(topics.size(), 1u);
    const auto& messages = topics.at("/quadsonde/wind");
    ASSERT_EQ(messages.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); i += 7) expect_row(rows[i], messages[i]);
    EXPECT_EQ(messages[0]["reasons"], Json({"converging"}));
  }
}

TEST(ProfileMcap, HoldsEveryColumnOfEveryLegUnderItsName) {
  const auto profile = made_up_profile();
  const auto rows = nlohmann::ordered_json::parse(product::profile_json(profile, made_up_source()))["rows"];
  for (const auto encoding : kBoth) {
    const auto bytes = product::profile_mcap(profile, made_up_source(), encoded(encoding));
    ASSERT_TRUE(bytes);
    const auto topics = decoded(ingest::as_bytes(*bytes));
    ASSERT_EQ(topics.size(), 3u);
    std::size_t row = 0;
    for (const auto* leg : {"up", "down", "all"}) {
      const auto& messages = topics.at(std::string("/quadsonde/profile/") + leg);
      ASSERT_EQ(messages.size(), 1u);
      EXPECT_EQ(messages[0]["leg"], leg);
      EXPECT_NEAR(messages[0]["up_down_chi2"].get<double>(), 41.2, 1e-9);
      for (const auto& bin : messages[0]["bins"]) expect_row(rows.at(row++), bin);
    }
    EXPECT_EQ(row, rows.size());
  }
}

TEST(ProductMcap, TellsWhereItsNumbersComeFrom) {
  const auto bytes = *product::wind_mcap(made_up_series(), made_up_source());
  ingest::mcap::RecordReader reader(ingest::as_bytes(bytes));
  std::map<std::string, std::string> found;
  for (ingest::mcap::Record record; reader.next(record);)
    if (record.op == ingest::mcap::Op::metadata) {
      const auto metadata = *ingest::mcap::parse_metadata(record.content);
      EXPECT_EQ(metadata.name, "quadsonde.product");
      for (const auto& [key, value] : metadata.metadata) found.emplace(key, value);
    }
  EXPECT_EQ(found["file"], "hover.ulg");
  EXPECT_EQ(found["sha256"], "00ff");
  EXPECT_EQ(Json::parse(found["settings"])["bin_m"], 10.0);
  EXPECT_EQ(Json::parse(found["problems"]).size(), 1u);
  EXPECT_TRUE(Json::parse(found["vehicle"]).contains("linear_per_s"));
}

TEST(ProductMcap, IsTheSameBytesForTheSameInput) {
  EXPECT_EQ(*product::profile_mcap(made_up_profile(), made_up_source()),
            *product::profile_mcap(made_up_profile(), made_up_source()));
}

TEST(ProductMcap, BesideAFlightChangesNothingThatIsReadOfIt) {
  const auto flight = support::sample_flight();
  const auto series = made_up_series();
  const auto profile = made_up_profile();
  const auto source = made_up_source();
  for (const auto encoding : kBoth) {
    ingest::mcap::MemorySink plain, full;
    ASSERT_TRUE(product::write_flight(plain, flight, encoded(encoding)));
    ASSERT_TRUE(product::write_flight(full, flight, encoded(encoding), {}, {&series, &profile, &source}));
    const auto a = ingest::read_mcap(plain.bytes(), "a.mcap"), b = ingest::read_mcap(full.bytes(), "b.mcap");
    ASSERT_TRUE(a && b);
    ASSERT_EQ(b->flights.size(), 1u);
    EXPECT_EQ(b->topics.size(), a->topics.size() + 4);
    EXPECT_EQ(b->messages, a->messages + series.points.size() + 3);
    const auto& f = a->flights[0];
    const auto& g = b->flights[0];
    EXPECT_EQ(f.velocity.time, g.velocity.time);
    EXPECT_EQ(f.velocity.value, g.velocity.value);
    EXPECT_EQ(f.autopilot_wind.time, g.autopilot_wind.time);
    EXPECT_EQ(f.position.time, g.position.time);
    EXPECT_EQ(f.problems.size(), g.problems.size());
    EXPECT_EQ(f.clock.utc_minus_log, g.clock.utc_minus_log);
  }
}

TEST(ProductMcap, AloneIsNoFlight) {
  for (const auto encoding : kBoth) {
    const auto bytes = *product::wind_mcap(made_up_series(), made_up_source(), encoded(encoding));
    const auto content = ingest::read_mcap(ingest::as_bytes(bytes), "wind.mcap");
    ASSERT_TRUE(content);
    EXPECT_TRUE(content->flights.empty());
    ASSERT_EQ(content->topics.size(), 1u);
    EXPECT_EQ(content->topics[0].name, "/quadsonde/wind");
  }
}

TEST(FoxgloveLayout, NamesOnlyPanelsThatItConfiguresAndTopicsOfALegThatIsThere) {
  const auto profile = made_up_profile();
  for (const auto* given : {static_cast<const profiles::WindProfile*>(nullptr), &profile}) {
    const auto layout = Json::parse(product::foxglove_layout(given));
    std::set<std::string> shown, configured;
    const std::function<void(const Json&)> collect = [&](const Json& node) {
      if (node.is_string()) {
        shown.insert(node.get<std::string>());
      } else {
        collect(node["first"]);
        collect(node["second"]);
      }
    };
    collect(layout["layout"]);
    for (const auto& [id, panel] : layout["configById"].items()) configured.insert(id);
    EXPECT_EQ(shown, configured);
    EXPECT_EQ(layout.dump().find("/quadsonde/profile/up") != std::string::npos, given != nullptr);
  }
}

TEST(FlightToMcap, KeepsTheLatencyThatALogTells) {
  auto flight = support::sample_flight();
  flight.velocity.latency = ingest::Latency{0.123, true};
  flight.attitude.latency = ingest::Latency{0.007, false};
  ingest::mcap::MemorySink sink;
  ASSERT_TRUE(product::write_flight(sink, flight));
  const auto back = ingest::read_mcap(sink.bytes(), "a.mcap")->flights.at(0);
  ASSERT_TRUE(back.velocity.latency && back.attitude.latency);
  EXPECT_EQ(back.velocity.latency->median_s, 0.123);
  EXPECT_TRUE(back.velocity.latency->at_least);
  EXPECT_EQ(back.attitude.latency->median_s, 0.007);
  EXPECT_FALSE(back.attitude.latency->at_least);
  EXPECT_FALSE(back.position.latency);
}

}  // namespace
}  // namespace quadsonde

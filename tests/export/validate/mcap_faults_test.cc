// One fault in an MCAP file, and the rule that finds it.
#include <fstream>
#include <iterator>

#include "faulty.h"
#include "ingest/mcap/records.h"
#include "ingest/mcap/sink.h"
#include "ingest/mcap/writer.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

namespace mcap = ingest::mcap;
using support::broken_rules;

ingest::Bytes view(const std::string& bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

std::string whole() {
  auto bytes = product::profile_mcap(support::made_up_profile(), support::known_source());
  EXPECT_TRUE(bytes);
  return bytes.value_or("");
}

std::size_t footer_at(const std::string& file) { return file.size() - mcap::kTailSize; }
std::size_t summary_at(const std::string& file) {
  return mcap::parse_footer(mcap::record_at(view(file), footer_at(file))->content)->summary_start;
}
/// Offset of the first record of a kind from an offset on; the end of the file where there is none.
std::size_t first_of(const std::string& file, mcap::Op op, std::size_t from) {
  for (auto at = from; at < file.size();) {
    const auto record = mcap::record_at(view(file), at);
    if (!record) return file.size();
    if (record->op == op) return at;
    at = record->end;
  }
  return file.size();
}
/// A summary whose CRC is not there is not checked by it.
void forget_summary_crc(std::string& file) { file.replace(file.size() - 8 - 4, 4, std::string(4, '\0')); }

/// A file of one JSON message, as the call changes it.
std::string json_file(const std::string& message, const std::string& encoding, const std::string& schema_encoding,
                      const std::string& schema) {
  mcap::MemorySink sink;
  mcap::Writer writer(sink, {});
  const auto id = writer.add_schema("Wind", schema_encoding, view(schema));
  const auto channel = writer.add_channel(*id, "/wind", encoding);
  for (const std::uint64_t time : {1u, 2u}) EXPECT_TRUE(writer.write({*channel, 0, time, time, view(message)}));
  EXPECT_TRUE(writer.close());
  return std::string(sink.bytes().begin(), sink.bytes().end());
}

TEST(ValidateMcap, FindsNothingWrongWithOurOwnFiles) {
  EXPECT_EQ(broken_rules(whole(), "profile.mcap"), std::set<std::string>{});
  const auto wind = product::wind_mcap(support::made_up_series(), support::known_source());
  EXPECT_EQ(broken_rules(*wind, "wind.mcap"), std::set<std::string>{});
  EXPECT_EQ(broken_rules(json_file("{\"speed\": 3}", "json", "jsonschema", "{}"), "json.mcap"),
            std::set<std::string>{});
}

struct McapFault {
  const char* rule;
  void (*inject)(std::string& file);
};
/// Of the same name for GoogleTest.
std::ostream& operator<<(std::ostream& out, const McapFault& fault) { return out << fault.rule; }
class McapByteFault : public testing::TestWithParam<McapFault> {};

TEST_P(McapByteFault, IsFound) {
  auto file = whole();
  GetParam().inject(file);
  EXPECT_TRUE(broken_rules(file, "faulty.mcap").contains(GetParam().rule));
}

constexpr McapFault faults[] = {
    {"mcap.header", [](std::string& f) { f[8] = 0x7F; }},
    {"mcap.end", [](std::string& f) { f.resize(summary_at(f)); }},
    {"mcap.chunk-crc",
     [](std::string& f) {
       const auto chunk = first_of(f, mcap::Op::chunk, 8);
       f[chunk + mcap::kHeadSize + 24] ^= 1;
     }},
    {"mcap.summary-crc", [](std::string& f) { f[summary_at(f) + 12] ^= 1; }},
    {"mcap.statistics",
     [](std::string& f) {
       const auto at = first_of(f, mcap::Op::statistics, summary_at(f));
       f[at + mcap::kHeadSize] ^= 1;
       forget_summary_crc(f);
     }},
    {"mcap.chunk-index",
     [](std::string& f) {
       const auto at = first_of(f, mcap::Op::chunk_index, summary_at(f));
       f[at + mcap::kHeadSize] ^= 1;
       forget_summary_crc(f);
     }},
    {"mcap.footer",
     [](std::string& f) {
       f[footer_at(f) + mcap::kHeadSize + 7] = 1;
       forget_summary_crc(f);
     }},
    {"mcap.data-end",
     [](std::string& f) {
       const auto at = first_of(f, mcap::Op::data_end, 8);
       f[at + mcap::kHeadSize] ^= 1;
     }},
};
INSTANTIATE_TEST_SUITE_P(Bytes, McapByteFault, testing::ValuesIn(faults),
                         [](const auto& fault) { return support::test_name(fault.param.rule); });

TEST(ValidateMcap, HoldsMessagesToTheirSchemas) {
  EXPECT_EQ(broken_rules(json_file("{\"speed\": ", "json", "jsonschema", "{}"), "x.mcap"),
            support::only("mcap.message"));
  EXPECT_EQ(broken_rules(json_file("abc", "protobuf", "protobuf", "no descriptor"), "x.mcap"),
            support::only("mcap.schema"));
}

TEST(ValidateMcap, ThinksNothingOfTheConformanceFilesButOfTheirAbsentSummaries) {
  QUADSONDE_NEEDS_DATA("logs/mcap-conformance");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(support::data_file("logs/mcap-conformance"))) {
    if (entry.path().extension() != ".mcap") continue;
    std::ifstream in(entry.path(), std::ios::binary);
    auto rules = broken_rules({std::istreambuf_iterator<char>(in), {}}, entry.path().filename().string());
    rules.erase("mcap.no-summary");
    EXPECT_EQ(rules, std::set<std::string>{}) << entry.path().filename();
    ++files;
  }
  EXPECT_GT(files, 400u);
}

}  // namespace
}  // namespace quadsonde

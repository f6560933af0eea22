// The fuzzers' corpus and what they found, as a unit test.
#include <functional>

#include "tests/fuzz/mcap/seeds.h"
#include "tests/fuzz/mcap/targets.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

const std::pair<const char*, std::function<void(ingest::Bytes)>> kTargets[] = {
    {"reader", fuzz::mcap_reader}, {"indexed", fuzz::mcap_indexed}, {"flight", fuzz::mcap_flight}, {"schema", fuzz::mcap_schema}};

TEST(McapFuzzCorpus, KeepsEveryPromiseOfEveryTarget) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(QUADSONDE_MCAP_CORPUS)) {
    const auto bytes = support::read_bytes(entry.path());
    for (const auto& [name, target] : kTargets) {
      SCOPED_TRACE(entry.path().filename().string() + " in " + name);
      target(bytes);
    }
    ++files;
  }
  EXPECT_GT(files, 0u);
}

TEST(McapFuzzSeeds, KeepEveryPromiseOfEveryTarget) {
  for (const auto& [name, bytes] : fuzz::mcap_seeds()) {
    SCOPED_TRACE(name);
    for (const auto& [ignored, target] : kTargets) target(bytes);
  }
}

}  // namespace
}  // namespace quadsonde

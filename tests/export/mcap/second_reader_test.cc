#include <cstdlib>
#include <fstream>

#include "export/mcap/flight_to_mcap.h"
#include "sample_flight.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

std::filesystem::path node_modules() {
  const char* named = std::getenv("QUADSONDE_NODE_MODULES");
  return named ? named : QUADSONDE_NODE_MODULES_DEFAULT;
}

/// Runs npm's @mcap/core over a file; its exit code.
int run_second_reader(const std::filesystem::path& file, const std::filesystem::path& log) {
  const auto command = "node '" + std::string(QUADSONDE_MCAP_CORE_CHECK) + "' '" + node_modules().string() + "' '" +
                       file.string() + "' > '" + log.string() + "' 2>&1";
  return std::system(command.c_str());
}

TEST(SecondMcapReader, OpensWhatWeWriteWithItsCrcChecksOn) {
  if (!std::filesystem::exists(node_modules() / "@mcap" / "core") || std::system("node --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs node and npm's @mcap/core, @mcap/support in QUADSONDE_NODE_MODULES";
  using Compression = product::FlightFileSettings::Compression;
  using Encoding = product::FlightFileSettings::Encoding;
  const support::TemporaryFolder folder;
  for (const auto compression : {Compression::none, Compression::lz4, Compression::zstd}) {
    for (const auto encoding : {Encoding::protobuf, Encoding::json}) {
      const product::FlightFileSettings settings{encoding, compression, true, true};
      ASSERT_TRUE(product::write_flight(folder / "f.mcap", support::sample_flight(), settings, support::sample_truth()));
      EXPECT_EQ(run_second_reader(folder / "f.mcap", folder / "log"), 0)
          << [&] { const auto b = support::read_bytes(folder / "log"); return std::string(b.begin(), b.end()); }();
    }
  }
}

}  // namespace
}  // namespace quadsonde

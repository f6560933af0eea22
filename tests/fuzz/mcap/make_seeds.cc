// Writes the seeds into a folder: fuzz_mcap_seeds tests/fuzz/mcap/corpus
#include <fstream>

#include "tests/fuzz/mcap/seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  for (const auto& [name, bytes] : quadsonde::fuzz::mcap_seeds())
    std::ofstream(std::string(argv[1]) + "/seed_" + name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return 0;
}

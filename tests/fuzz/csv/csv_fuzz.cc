#include "ingest/csv/decompress.h"
#include "ingest/csv/flight_from_csv.h"
#include "tests/fuzz/sound.h"

using namespace quadsonde;

namespace {

/// Compressed input may hold more rows than it has bytes; the limits of decompression bound them.
constexpr std::size_t most_rows = std::size_t{64} << 20;

void read(ingest::Bytes table, const ingest::CsvReadSettings& settings) {
  auto content = ingest::read_csv(table, "fuzz.csv", settings);
  if (content)
    for (auto& flight : content->flights) ingest::tidy(flight);
  fuzz::require_sound(content, most_rows);
}

}  // namespace

/// A table alone, or a column map, a line "---", and a table.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ingest::Bytes bytes(data, size);
  (void)ingest::looks_like_table(bytes);
  if (ingest::csv::is_compressed(bytes)) {
    const auto plain = ingest::csv::decompress(bytes, "fuzz.csv", {1 << 20, 300, 1 << 16});
    fuzz::require(!plain || plain->bytes.size() <= (1 << 20));
  }
  ingest::CsvReadSettings settings;
  read(bytes, settings);
  settings.mode = ingest::Reading::strict;
  read(bytes, settings);
  const auto text = ingest::as_text(bytes);
  const auto line = text.find("\n---\n");
  if (line == std::string_view::npos) return 0;
  auto map = ingest::parse_column_map(text.substr(0, line + 1), "fuzz.toml");
  if (!map) return 0;
  settings.map = std::move(*map);
  settings.mode = ingest::Reading::tolerant;
  read(bytes.subspan(line + 5), settings);
  return 0;
}

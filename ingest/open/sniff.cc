#include "ingest/open/sniff.h"

#include <algorithm>

#include "ingest/csv/decompress.h"
#include "ingest/csv/flight_from_csv.h"
#include "ingest/dataflash/flight_from_dataflash.h"
#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "ingest/ulog/container.h"

namespace quadsonde::ingest {
namespace {

Bytes head(Bytes bytes, std::size_t size) { return bytes.first(std::min(bytes.size(), size)); }

bool begins_with(Bytes bytes, Bytes magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

/// No control characters but blanks in the first pages: text in any 8-bit encoding.
bool is_text(Bytes bytes) {
  const auto first = head(bytes, 8192);
  return std::all_of(first.begin(), first.end(),
                     [](auto c) { return c >= 0x20 || (c >= 0x07 && c <= 0x0D) || c == 0x02; });
}

bool holds_at(Bytes bytes, std::size_t at, std::string_view text) {
  return bytes.size() >= at + text.size() && as_text(bytes.subspan(at, text.size())) == text;
}

/// The recorder file of the aircraft: "BUILD" at byte 16, later "DJI_LOG_V3" at 242, or "LOGH" at the start
/// (as DatCon and later tools tell them).
bool is_dji_dat(Bytes bytes) {
  return holds_at(bytes, 16, "BUILD") || holds_at(bytes, 242, "DJI_LOG_V") || holds_at(bytes, 0, "LOGH");
}

/// The record of the app (DJIFlightRecord_*.txt): place and length of its details, then a format version.
bool is_dji_record(Bytes bytes) {
  if (bytes.size() < 100) return false;
  const auto details_at = load<std::uint64_t>(bytes.data());
  const auto details = load<std::uint16_t>(bytes.data() + 8);
  const auto version = bytes[10];
  if (version == 0 || version > 20 || details_at < 12 || details_at > bytes.size()) return false;
  return details <= bytes.size() - details_at && bytes[11] == 0;
}

}  // namespace

Container sniff(Bytes bytes) {
  static constexpr std::uint8_t mcap_magic[] = {0x89, 'M', 'C', 'A', 'P'};
  if (begins_with(bytes, mcap_magic)) return Container::mcap;
  if (begins_with(bytes, ulog::magic)) return Container::ulog;
  if (csv::is_compressed(bytes)) return Container::compressed;
  if (is_dji_dat(bytes)) return Container::dji_native;
  if (is_text(bytes)) {
    if (as_text(head(bytes, 4096)).find("<configuration") != std::string_view::npos) return Container::paparazzi_log;
    if (looks_like_table(bytes)) return Container::table;
    if (looks_like_paparazzi_data(head(bytes, 1 << 16))) return Container::paparazzi_data;
    return Container::text;
  }
  if (looks_like_tlog(head(bytes, 1 << 16))) return Container::mavlink;
  if (looks_like_dataflash(head(bytes, 1 << 16))) return Container::dataflash;
  if (is_dji_record(bytes)) return Container::dji_native;
  return Container::unknown;
}

}  // namespace quadsonde::ingest

#include "ingest/open/open_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "ingest/csv/decompress.h"
#include "ingest/csv/flight_from_csv.h"
#include "ingest/dataflash/flight_from_dataflash.h"
#include "ingest/flight/local_frame.h"
#include "ingest/mavlink/flight_from_mavlink.h"
#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/open/mapped_file.h"
#include "ingest/open/sensor_file.h"
#include "ingest/open/sniff.h"
#include "ingest/paparazzi/flight_from_paparazzi.h"
#include "ingest/ulog/flight_from_ulog.h"

namespace quadsonde::ingest {
namespace {

constexpr const char* what_is_read =
    "PX4 .ulg, ArduPilot .bin, MAVLink .tlog, Paparazzi .data, MCAP and tables (.csv, also .gz or .zst) can be read";

Result<LogContent> read_native_dji(const std::string& file) {
  return fail(Kind::unsupported, "this is a native DJI file; its content is encrypted", {file, {}, {}, {}},
              "export it as a table first: Airdata CSV, DroneDeploy flight record, or DatCon CSV (with --columns), "
              "and give that");
}

/// Text that no reader knows; the name may have promised something else.
Result<LogContent> explain_text(Bytes bytes, const std::filesystem::path& path, const OpenSettings& settings) {
  const auto ending = path.extension().string();
  for (const auto* binary : {".ulg", ".bin", ".BIN", ".tlog", ".mcap"})
    if (ending == binary)
      return fail(Kind::not_a_log, fmt::format("this is a text file, not the {} log that its name says", ending),
                  {path.string(), {}, {}, {}}, "check what was copied; a table of a flight is read under any name");
  CsvReadSettings csv;
  csv.mode = settings.mode;
  return read_csv(bytes, path.string(), csv);  // its error says which columns were expected
}

Result<LogContent> read_any_mcap(Bytes bytes, const std::string& file, const OpenSettings& settings) {
  McapReadSettings mcap;
  mcap.mode = settings.mode;
  if (settings.topics) {
    std::ifstream text(*settings.topics, std::ios::binary);
    if (!text)
      return fail(Kind::unreadable, "the topic map cannot be read", {settings.topics->string(), {}, {}, {}},
                  "check the path given to --topics");
    const std::string toml{std::istreambuf_iterator<char>(text), std::istreambuf_iterator<char>()};
    auto map = parse_topic_map(toml, settings.topics->string());
    if (!map) return fail(std::move(map.error()));
    mcap.topics = std::move(*map);
  }
  return read_mcap(bytes, file, mcap);
}

/// The other file of a Paparazzi pair, if it is there.
std::optional<MappedFile> sibling(const std::filesystem::path& path, std::initializer_list<const char*> endings) {
  for (const auto* ending : endings) {
    auto other = path;
    other.replace_extension(ending);
    std::error_code ignored;
    if (other == path || !std::filesystem::is_regular_file(other, ignored)) continue;
    if (auto file = MappedFile::open(other)) return std::move(*file);
  }
  return std::nullopt;
}

Result<LogContent> read_paparazzi_pair(Bytes data, const std::filesystem::path& path, const OpenSettings& settings) {
  PaparazziReadSettings paparazzi;
  paparazzi.mode = settings.mode;
  const auto log = sibling(path, {".log", ".LOG"});
  return read_paparazzi(data, log ? std::optional(log->bytes()) : std::nullopt, path.string(), paparazzi);
}

Result<LogContent> read_paparazzi_log(Bytes log, const std::filesystem::path& path, const OpenSettings& settings) {
  const auto data = sibling(path, {".data", ".DATA"});
  if (!data)
    return fail(Kind::missing, "this Paparazzi .log holds the settings; the .data with the messages is not beside it",
                {path.string(), {}, {}, {}}, "put the .data beside it");
  PaparazziReadSettings paparazzi;
  paparazzi.mode = settings.mode;
  auto other = path;
  return read_paparazzi(data->bytes(), log, other.replace_extension(".data").string(), paparazzi);
}

Result<LogContent> dispatch(Bytes bytes, const std::filesystem::path& path, const OpenSettings& settings);

/// Reads what is inside a compressed file; a cut one loses its last, perhaps incomplete, line.
Result<LogContent> read_compressed(Bytes bytes, const std::filesystem::path& path, const OpenSettings& settings) {
  auto plain = csv::decompress(bytes, path.string());
  if (!plain) return fail(std::move(plain.error()));
  if (plain->cut && settings.mode == Reading::strict) return fail(*plain->cut);
  Bytes inside = plain->bytes;
  if (csv::is_compressed(inside))
    return fail(Kind::unsupported, "this is a compressed file inside a compressed file", {path.string(), {}, {}, {}},
                "decompress it once");
  const auto container = sniff(inside);
  if (plain->cut && (container == Container::table || settings.columns)) {
    const auto end = as_text(inside).rfind('\n');
    inside = inside.first(end == std::string_view::npos ? 0 : end + 1);
  }
  auto content = dispatch(inside, path, settings);
  if (content && plain->cut) content->problems.insert(content->problems.begin(), *plain->cut);
  return content;
}

Result<LogContent> dispatch(Bytes bytes, const std::filesystem::path& path, const OpenSettings& settings) {
  const auto file = path.string();
  const auto container = sniff(bytes);
  const bool text =
      container == Container::table || container == Container::text || container == Container::paparazzi_data;
  if (text && settings.columns) return read_csv(bytes, file, {settings.mode, settings.columns});
  switch (container) {
    case Container::compressed:
      return read_compressed(bytes, path, settings);
    case Container::ulog:
      return read_ulog(bytes, file, {settings.mode});
    case Container::table:
      return read_csv(bytes, file, {settings.mode, {}});
    case Container::text:
      return explain_text(bytes, path, settings);
    case Container::dji_native:
      return read_native_dji(file);
    case Container::mcap:
      return read_any_mcap(bytes, file, settings);
    case Container::dataflash:
      return read_dataflash(bytes, file, {settings.mode});
    case Container::mavlink:
      return read_mavlink(bytes, file, {settings.mode, {}});
    case Container::paparazzi_data:
      return read_paparazzi_pair(bytes, path, settings);
    case Container::paparazzi_log:
      return read_paparazzi_log(bytes, path, settings);
    case Container::unknown:
      break;
  }
  return fail(Kind::not_a_log, "these bytes are no flight log that is known here", {file, {}, {}, {}}, what_is_read);
}

void shift_datum(Flight& flight, double offset_m) {
  if (offset_m == 0) return;
  for (auto& h : flight.height_msl.value) h.m += offset_m;
  if (flight.origin && flight.origin->height_msl) flight.origin->height_msl->m += offset_m;
}

/// Every reader leaves its velocity empty where the log has none; the position may serve.
void complete_velocity(Flight& flight, LogContent& content) {
  if (!flight.velocity.empty() || flight.attitude.empty()) return;
  auto velocity = differentiate_position(flight);
  if (velocity.empty()) return;
  const auto from = flight.position.empty() ? flight.local_position.source : flight.position.source;
  velocity.source = fmt::format("slope of the position ({})", from);
  flight.velocity = std::move(velocity);
  tidy(flight);
  content.details.emplace_back("velocity", flight.velocity.source + ": the log has no velocity of its own");
}

Result<LogContent> finish(Result<LogContent> content, const OpenSettings& settings) {
  if (!content) return content;
  for (auto& flight : content->flights) {
    tidy(flight);
    complete_velocity(flight, *content);
    shift_datum(flight, settings.height_offset_m);
  }
  if (!settings.sensor) return content;
  const auto sensor = read_sensor_file(*settings.sensor);
  if (!sensor) return fail(sensor.error());
  for (auto& flight : content->flights) add_sensor(flight, *sensor, settings.sensor_offset_s);
  return content;
}

}  // namespace

Result<LogContent> open_log(Bytes bytes, const std::filesystem::path& path, const OpenSettings& settings) {
  if (bytes.empty())
    return fail(Kind::not_a_log, "the file is empty", {path.string(), {}, {}, {}},
                "copy the log from the vehicle again");
  return finish(dispatch(bytes, path, settings), settings);
}

Result<LogContent> open_log(const std::filesystem::path& path, const OpenSettings& settings) {
  const auto file = MappedFile::open(path);
  if (!file) return fail(file.error());
  return open_log(file->bytes(), path, settings);
}

}  // namespace quadsonde::ingest

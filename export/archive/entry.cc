#include "export/archive/entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "export/csv/numbers.h"
#include "export/sha256.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

constexpr const char* manifest_schema = "quadsonde.manifest/1";

ingest::UtcTime utc_of(double seconds) { return {std::llround(seconds * 1e3) * 1'000'000}; }

/// "multirotor X" or another platform of the attribute, else the id of the vehicle whose drag was used.
std::string vehicle_name(const StoredProfile& p) {
  constexpr std::string_view kind = "multirotor ";
  if (p.platform.size() > kind.size() && p.platform.starts_with(kind)) return p.platform.substr(kind.size());
  if (!p.platform.empty() && p.platform != "multirotor") return p.platform;
  const auto vehicle = Json::parse(p.vehicle, nullptr, false);
  if (vehicle.is_object() && vehicle.contains("id") && vehicle["id"].is_string() &&
      vehicle.value("method", Json()) != Json("prior"))
    return vehicle["id"].get<std::string>();
  return {};
}

double median_height(const StoredProfile& p) {
  std::vector<double> heights;
  for (std::size_t i = 0; i < p.bottom_msl_m.size(); ++i) heights.push_back(p.top_msl_m[i] - p.bottom_msl_m[i]);
  std::sort(heights.begin(), heights.end());
  return heights[heights.size() / 2];
}

void count_bins(ArchiveEntry& e, const StoredProfile& p) {
  double sum = 0;
  for (const auto& record : p.records) {
    for (std::size_t i = 0; i < record.bins.size(); ++i) {
      const auto& bin = record.bins[i];
      if (!bin.has_wind()) continue;
      const double speed = bin.speed.value_or(std::hypot(*bin.east, *bin.north));
      const bool first = e.bins++ == 0;
      e.bottom_msl_m = first ? p.bottom_msl_m[i] : std::min(e.bottom_msl_m, p.bottom_msl_m[i]);
      e.top_msl_m = first ? p.top_msl_m[i] : std::max(e.top_msl_m, p.top_msl_m[i]);
      e.speed_min_m_s = first ? speed : std::min(e.speed_min_m_s, speed);
      e.speed_max_m_s = first ? speed : std::max(e.speed_max_m_s, speed);
      sum += speed;
      ++(bin.quality == 1 ? e.good : bin.quality == 3 ? e.doubtful : e.bad);
    }
  }
  e.speed_mean_m_s = e.bins ? sum / e.bins : 0;
  e.quality = 2 * e.good >= e.bins                  ? ArchiveQuality::good
              : 2 * (e.good + e.doubtful) >= e.bins ? ArchiveQuality::doubtful
                                                    : ArchiveQuality::bad;
}

/// The parts of a version; what is no number counts as -1, so that a release goes before "0.1.0-dev".
std::array<int, 4> version_parts(std::string_view text) {
  std::array<int, 4> parts{0, 0, 0, 0};
  const char *at = text.data(), *end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    const auto [next, error] = std::from_chars(at, end, parts[static_cast<std::size_t>(i)]);
    if (error != std::errc()) break;
    at = next;
    if (at == end || *at != '.') break;
    ++at;
  }
  if (at != end) parts[3] = -1;
  return parts;
}

Json body_of(const ArchiveEntry& e) {
  const auto parsed = [](const std::string& text) {
    auto json = Json::parse(text, nullptr, false);
    return json.is_object() ? json : Json(text);
  };
  Json o = {{"schema", manifest_schema}, {"name", e.name}, {"folder", e.folder}, {"version", e.version}};
  o["netcdf"] = {{"file", e.name + ".nc"}, {"bytes", e.bytes}, {"sha256", e.sha256}};
  o["source"] = {{"file", e.input_file}, {"sha256", e.input_sha256}, {"flight", e.input_flight}};
  o["made_by"] = {{"quadsonde", e.tool_version}, {"date_created", e.date_created}};
  o["made_by"]["settings"] = parsed(e.settings), o["made_by"]["vehicle"] = parsed(e.vehicle_json);
  o["vehicle"] = e.vehicle, o["station"] = e.station, o["license"] = e.license, o["institution"] = e.institution;
  o["start_utc"] = utc_text(utc_of(e.start_s)), o["end_utc"] = utc_text(utc_of(e.end_s));
  o["start_s"] = e.start_s, o["end_s"] = e.end_s, o["lat_deg"] = e.lat_deg, o["lon_deg"] = e.lon_deg;
  o["bottom_msl_m"] = e.bottom_msl_m, o["top_msl_m"] = e.top_msl_m;
  o["surface_msl_m"] = e.surface_msl_m ? Json(*e.surface_msl_m) : Json();
  o["bin_m"] = e.bin_m, o["bins"] = e.bins, o["good"] = e.good, o["doubtful"] = e.doubtful, o["bad"] = e.bad;
  o["speed_min_m_s"] = e.speed_min_m_s, o["speed_mean_m_s"] = e.speed_mean_m_s, o["speed_max_m_s"] = e.speed_max_m_s;
  o["quality"] = std::string(name(e.quality));
  return o;
}

/// Throws what nlohmann throws on another type.
ArchiveEntry entry_of(const Json& o) {
  ArchiveEntry e;
  const auto text = [](const Json& of, const char* key) { return of.at(key).get<std::string>(); };
  const auto number = [&](const char* key) { return o.at(key).get<double>(); };
  const auto dumped = [](const Json& of) { return of.is_string() ? of.get<std::string>() : of.dump(); };
  const auto &nc = o.at("netcdf"), &source = o.at("source"), &made = o.at("made_by");
  e.name = text(o, "name"), e.folder = text(o, "folder"), e.version = o.at("version").get<int>();
  e.bytes = nc.at("bytes").get<std::uint64_t>(), e.sha256 = text(nc, "sha256");
  e.input_file = text(source, "file"), e.input_sha256 = text(source, "sha256");
  e.input_flight = source.at("flight").get<int>();
  e.flight_id = fmt::format("{}-{}", e.input_sha256, e.input_flight);
  e.tool_version = text(made, "quadsonde"), e.date_created = text(made, "date_created");
  e.settings = dumped(made.at("settings")), e.vehicle_json = dumped(made.at("vehicle"));
  e.vehicle = text(o, "vehicle"), e.station = text(o, "station"), e.license = text(o, "license");
  e.institution = text(o, "institution");
  e.start_s = number("start_s"), e.end_s = number("end_s"), e.lat_deg = number("lat_deg");
  e.lon_deg = number("lon_deg"), e.bottom_msl_m = number("bottom_msl_m"), e.top_msl_m = number("top_msl_m");
  if (!o.at("surface_msl_m").is_null()) e.surface_msl_m = number("surface_msl_m");
  e.bin_m = number("bin_m"), e.bins = o.at("bins").get<int>(), e.good = o.at("good").get<int>();
  e.doubtful = o.at("doubtful").get<int>(), e.bad = o.at("bad").get<int>();
  e.speed_min_m_s = number("speed_min_m_s"), e.speed_mean_m_s = number("speed_mean_m_s");
  e.speed_max_m_s = number("speed_max_m_s");
  e.quality = archive_quality(text(o, "quality")).value();
  return e;
}

/// Text out of bytes that may be no UTF-8: what JSON gives back is then what went in.
std::string clean(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

}  // namespace

std::string_view name(ArchiveQuality quality) {
  constexpr std::string_view words[] = {"good", "doubtful", "bad"};
  return words[static_cast<int>(quality)];
}

std::optional<ArchiveQuality> archive_quality(std::string_view word) {
  for (const auto quality : {ArchiveQuality::good, ArchiveQuality::doubtful, ArchiveQuality::bad})
    if (name(quality) == word) return quality;
  return std::nullopt;
}

std::string safe_name(std::string_view text, std::string_view otherwise) {
  constexpr std::string_view allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  std::string safe;
  for (const char c : text)
    if (allowed.find(c) != std::string_view::npos)
      safe += c;
    else if (!safe.empty() && safe.back() != '_')
      safe += '_';
  safe.erase(0, safe.find_first_not_of("._-"));
  safe.resize(std::min<std::size_t>(safe.size(), 40));
  while (!safe.empty() && (safe.back() == '_' || safe.back() == '.')) safe.pop_back();
  return safe.empty() ? std::string(otherwise) : safe;
}

ArchiveEntry make_entry(const StoredProfile& p, ingest::Bytes bytes) {
  ArchiveEntry e;
  e.input_file = clean(p.input_file), e.input_sha256 = p.input_sha256, e.input_flight = p.input_flight;
  e.flight_id = fmt::format("{}-{}", e.input_sha256, e.input_flight);
  e.sha256 = sha256_hex(bytes), e.bytes = bytes.size();
  e.tool_version = clean(p.version), e.date_created = clean(p.date_created);
  e.settings = clean(p.settings), e.vehicle_json = clean(p.vehicle);
  e.vehicle = clean(vehicle_name(p)), e.station = clean(p.station_id);
  e.license = clean(p.license), e.institution = clean(p.institution);
  e.start_s = p.records.front().from_s, e.end_s = p.records.front().to_s;
  for (const auto& record : p.records)
    e.start_s = std::min(e.start_s, record.from_s), e.end_s = std::max(e.end_s, record.to_s);
  e.lat_deg = p.lat_deg, e.lon_deg = p.lon_deg, e.surface_msl_m = p.surface_msl_m, e.bin_m = median_height(p);
  count_bins(e, p);
  const auto start = ingest::to_iso8601(ingest::UtcTime{static_cast<std::int64_t>(e.start_s) * 1'000'000'000}, 0);
  std::string stamp;  // 20250615T060012Z
  for (const char c : start)
    if (c != '-' && c != ':') stamp += c;
  const auto flight = sha256_hex(ingest::as_bytes(e.flight_id)).substr(0, 12);
  e.name = fmt::format("{}_{}_{}-{}", stamp, safe_name(e.vehicle, "multirotor"), flight, e.sha256.substr(0, 8));
  e.folder = fmt::format("profiles/{}/{}/{}/{}", start.substr(0, 4), start.substr(5, 2),
                         safe_name(e.station, "no-station"), e.name);
  return e;
}

bool better(const ArchiveEntry& a, const ArchiveEntry& b) {
  const auto va = version_parts(a.tool_version), vb = version_parts(b.tool_version);
  if (va != vb) return va > vb;
  if (a.version != b.version) return a.version > b.version;
  return a.name > b.name;
}

std::string manifest_text(const ArchiveEntry& entry) {
  auto object = body_of(entry);
  object["manifest_sha256"] = sha256_hex(ingest::as_bytes(json_text(object)));
  return json_text(object);
}

ingest::Result<ArchiveEntry> parse_manifest(const std::string& text, const std::string& file) {
  const auto damaged = fail(Kind::damaged, "this manifest is not as it was written", {file, {}, {}, {}},
                            "`quadsonde archive rebuild` makes it again from the netCDF");
  const auto object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return damaged;
  try {
    auto entry = entry_of(object);
    // One comparison covers the digest, every field, their order and the spelling of numbers.
    if (manifest_text(entry) != text) return damaged;
    return entry;
  } catch (const std::exception&) {
    return damaged;
  }
}

}  // namespace quadsonde::product

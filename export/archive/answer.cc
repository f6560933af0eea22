#include "export/archive/answer.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "export/csv/numbers.h"

namespace quadsonde::product {
namespace {

ingest::UtcTime utc(double seconds) { return {std::llround(seconds * 1e3) * 1'000'000}; }

std::string minute(double seconds) {
  auto text = ingest::to_iso8601(utc(seconds), 0).substr(0, 16);
  text[10] = ' ';
  return text;
}

/// Bytes of a text that are no continuation of a UTF-8 character, cut at so many.
std::string cut(const std::string& text, std::size_t columns) {
  std::size_t seen = 0, at = 0;
  for (; at < text.size(); ++at) {
    if ((static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) continue;
    if (++seen > columns) break;
  }
  return text.substr(0, at);
}

std::string plural(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// A field of CSV; RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

struct Field {
  const char* name;
  Json value;
};

/// The columns of CSV and JSON, in this order; new ones come at the end.
std::vector<Field> fields(const ArchiveEntry& e, const std::filesystem::path& root) {
  return {{"name", e.name},
          {"file", (root / e.file()).string()},
          {"start_utc", utc_text(utc(e.start_s))},
          {"end_utc", utc_text(utc(e.end_s))},
          {"lat_deg", json_number(e.lat_deg, digits::degrees)},
          {"lon_deg", json_number(e.lon_deg, digits::degrees)},
          {"bottom_msl_m", json_number(e.bottom_msl_m, digits::metres)},
          {"top_msl_m", json_number(e.top_msl_m, digits::metres)},
          {"takeoff_msl_m", json_number(e.surface_msl_m, digits::metres)},
          {"bin_m", json_number(e.bin_m, digits::metres)},
          {"vehicle", e.vehicle.empty() ? Json() : Json(e.vehicle)},
          {"station", e.station.empty() ? Json() : Json(e.station)},
          {"quality", std::string(name(e.quality))},
          {"bins", e.bins},
          {"bins_good", e.good},
          {"bins_doubtful", e.doubtful},
          {"bins_bad", e.bad},
          {"wind_speed_min_m_s", json_number(e.speed_min_m_s, digits::speed)},
          {"wind_speed_mean_m_s", json_number(e.speed_mean_m_s, digits::speed)},
          {"wind_speed_max_m_s", json_number(e.speed_max_m_s, digits::speed)},
          {"version", e.version},
          {"superseded", e.superseded},
          {"quadsonde", e.tool_version},
          {"source_file", e.input_file},
          {"source_sha256", e.input_sha256},
          {"source_flight", e.input_flight},
          {"sha256", e.sha256}};
}

Json object_of(const ArchiveEntry& e, const std::filesystem::path& root) {
  Json object = Json::object();
  for (auto& field : fields(e, root)) object[field.name] = std::move(field.value);
  return object;
}

Json findings_json(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const auto& f : findings)
    list.push_back({{"kind", std::string(name(f.kind))}, {"path", f.path}, {"what", f.what}});
  return list;
}

std::string findings_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const auto& f : findings) text += fmt::format("{:<11} {}\n            {}\n", name(f.kind), f.path, f.what);
  return text;
}

}  // namespace

std::string entries_text(const std::vector<ArchiveEntry>& entries) {
  if (entries.empty()) return "No profile fits.\n";
  std::string text = "start (UTC)       latitude longitude  top m  wind m/s quality  vehicle, station\n";
  std::set<std::string> flights;
  bool any_old = false, any_above_sea = false;
  for (const auto& e : entries) {
    flights.insert(e.flight_id);
    any_old = any_old || e.superseded, any_above_sea = any_above_sea || !e.surface_msl_m;
    // The top above take-off where that is known, else above the sea, which a star tells.
    const auto top =
        e.surface_msl_m ? fmt::format("{:.0f} ", e.top_msl_m - *e.surface_msl_m) : fmt::format("{:.0f}*", e.top_msl_m);
    auto who = e.vehicle;
    if (!e.station.empty()) who += (who.empty() ? "" : ", ") + e.station;
    text += fmt::format("{}{} {:>8.4f} {:>9.4f} {:>6} {:>9} {:<8} {}\n", minute(e.start_s), e.superseded ? "-" : " ",
                        e.lat_deg, e.lon_deg, top, fmt::format("{:.1f}-{:.1f}", e.speed_min_m_s, e.speed_max_m_s),
                        name(e.quality), cut(who, 16));
  }
  text += fmt::format("{} of {}.", plural(entries.size(), "profile", "profiles"),
                      plural(flights.size(), "flight", "flights"));
  if (any_above_sea) text += " *: above the sea.";
  if (any_old) text += " -: superseded.";
  return text + "\n--json and -o X.csv name their files.\n";
}

std::string entries_json(const std::vector<ArchiveEntry>& entries, const std::filesystem::path& root) {
  Json object = {{"schema", "quadsonde.archive_list/1"}, {"profiles", Json::array()}};
  for (const auto& e : entries) object["profiles"].push_back(object_of(e, root));
  return json_text(object);
}

std::string entries_csv(const std::vector<ArchiveEntry>& entries, const std::filesystem::path& root) {
  std::string text;
  for (const auto& field : fields({}, root)) text += (text.empty() ? "" : ",") + std::string(field.name);
  text += "\n";
  for (const auto& e : entries) {
    bool first = true;
    for (const auto& field : fields(e, root)) {
      if (!first) text += ",";
      first = false;
      if (field.value.is_string())
        text += quoted(field.value.get<std::string>());
      else if (!field.value.is_null())
        text += field.value.dump();
    }
    text += "\n";
  }
  return text;
}

std::string added_text(const Added& added) {
  auto text = fmt::format("{:<13} {}\n", name(added.outcome), added.entry.name);
  if (added.outcome == AddOutcome::superseding) text += fmt::format("{:<13} {}\n", "  instead of", added.other);
  if (added.entry.superseded) text += fmt::format("{:<13} {}\n", "  used is", added.other);
  return text;
}

std::string added_json(const std::vector<Added>& added, const std::filesystem::path& root) {
  Json object = {{"schema", "quadsonde.archive_add/1"}, {"profiles", Json::array()}};
  for (const auto& a : added) {
    Json one = {{"outcome", std::string(name(a.outcome))}};
    one["other_version"] = a.other.empty() ? Json() : Json(a.other);
    one.update(object_of(a.entry, root));
    object["profiles"].push_back(std::move(one));
  }
  return json_text(object);
}

std::string verify_text(const VerifyReport& r) {
  const auto looked = fmt::format("{}, {} looked at, {:.1f} MB of netCDF compared with their SHA-256",
                                  plural(r.profiles, "profile", "profiles"), plural(r.files, "file", "files"),
                                  static_cast<double>(r.bytes) * 1e-6);
  if (r.findings.empty()) return looked + ":\neverything is there and as it was written.\n";
  return findings_text(r.findings) + looked + ":\n" + plural(r.findings.size(), "thing is", "things are") + " wrong.\n";
}

std::string verify_json(const VerifyReport& r) {
  return json_text(Json{{"schema", "quadsonde.archive_verify/1"},
                        {"profiles", r.profiles},
                        {"files", r.files},
                        {"bytes", r.bytes},
                        {"findings", findings_json(r.findings)}});
}

std::string rebuild_text(const RebuildReport& r) {
  auto text = findings_text(r.findings);
  text +=
      fmt::format("Index and catalogue made again from the files of {}.\n", plural(r.profiles, "profile", "profiles"));
  if (r.remade_manifests)
    text += fmt::format("{} made again from the netCDF.\n", plural(r.remade_manifests, "manifest", "manifests"));
  if (!r.findings.empty()) text += plural(r.findings.size(), "thing is", "things are") + " wrong.\n";
  return text;
}

std::string rebuild_json(const RebuildReport& r) {
  return json_text(Json{{"schema", "quadsonde.archive_rebuild/1"},
                        {"profiles", r.profiles},
                        {"remade_manifests", r.remade_manifests},
                        {"findings", findings_json(r.findings)}});
}

}  // namespace quadsonde::product

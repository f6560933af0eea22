#include "export/archive/stac.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "export/csv/numbers.h"

namespace quadsonde::product {
namespace {

constexpr const char *json_type = "application/json", *collection_id = "quadsonde-profiles";

std::string utc(double seconds) { return utc_text(ingest::UtcTime{std::llround(seconds * 1e3) * 1'000'000}); }

/// Links up from a folder that lies so many folders below the root.
std::string up(std::size_t levels) {
  std::string path;
  for (std::size_t i = 0; i < levels; ++i) path += "../";
  return path.empty() ? "./" : path;
}
std::size_t depth(const std::string& folder) {
  return folder.empty() ? 0 : 1 + static_cast<std::size_t>(std::count(folder.begin(), folder.end(), '/'));
}

Json link(const char* rel, const std::string& href, const char* type = json_type) {
  return {{"rel", rel}, {"href", href}, {"type", type}};
}

Json catalogue(const char* type, const std::string& id, const std::string& title, const std::string& description) {
  return {{"type", type}, {"stac_version", "1.0.0"}, {"stac_extensions", Json::array()},
          {"id", id},     {"title", title},          {"description", description}};
}

std::string last_part(const std::string& folder) { return folder.substr(folder.rfind('/') + 1); }

/// profiles/2025/06/X -> profiles-2025-06-X
std::string id_of(std::string folder) {
  std::replace(folder.begin(), folder.end(), '/', '-');
  return folder;
}

/// What STAC takes as a licence: one word; free text stays beside it.
bool is_licence_word(const std::string& text) {
  return !text.empty() &&
         text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-") ==
             std::string::npos;
}

Json properties(const ArchiveEntry& e) {
  Json p = {{"title", fmt::format("Wind profile, {}", utc(e.start_s))},
            {"datetime", utc((e.start_s + e.end_s) / 2)},
            {"start_datetime", utc(e.start_s)},
            {"end_datetime", utc(e.end_s)}};
  if (ingest::parse_iso8601(e.date_created)) p["created"] = e.date_created, p["updated"] = e.date_created;
  p["platform"] = e.vehicle.empty() ? "multirotor" : e.vehicle;
  p["instruments"] = Json::array({"imu", "gnss"});
  if (is_licence_word(e.license)) p["license"] = e.license;
  p["version"] = fmt::format("{}", e.version);
  p["deprecated"] = e.superseded;
  p["processing:level"] = "binned profile";
  p["processing:software"]["quadsonde"] = e.tool_version;
  p["quadsonde:source_file"] = e.input_file;
  p["quadsonde:source_sha256"] = e.input_sha256;
  p["quadsonde:source_flight"] = e.input_flight;
  p["quadsonde:altitude_min"] = json_number(e.bottom_msl_m, 2);
  p["quadsonde:altitude_max"] = json_number(e.top_msl_m, 2);
  p["quadsonde:surface_altitude"] = json_number(e.surface_msl_m, 2);
  p["quadsonde:vertical_resolution"] = json_number(e.bin_m, 2);
  p["quadsonde:n_levels"] = e.bins;
  p["quadsonde:quality"] = std::string(name(e.quality));
  p["quadsonde:wind_speed_min"] = json_number(e.speed_min_m_s, 2);
  p["quadsonde:wind_speed_mean"] = json_number(e.speed_mean_m_s, 2);
  p["quadsonde:wind_speed_max"] = json_number(e.speed_max_m_s, 2);
  if (!e.station.empty()) p["quadsonde:station"] = e.station;
  if (!e.license.empty() && !is_licence_word(e.license)) p["quadsonde:license"] = e.license;
  return p;
}

/// Of an item in its own folder to one in another.
std::string way_to(const ArchiveEntry& from, const std::string& folder, const std::string& name) {
  return up(depth(from.folder)) + folder + "/" + name + ".json";
}

}  // namespace

std::string stac_item(const ArchiveEntry& e, const Versions& versions) {
  const double lon = std::round(e.lon_deg * 1e7) / 1e7, lat = std::round(e.lat_deg * 1e7) / 1e7;
  Json item = {{"type", "Feature"}, {"stac_version", "1.0.0"}};
  item["stac_extensions"] = Json::array({"https://stac-extensions.github.io/version/v1.2.0/schema.json",
                                         "https://stac-extensions.github.io/file/v2.1.0/schema.json",
                                         "https://stac-extensions.github.io/processing/v1.1.0/schema.json"});
  item["id"] = e.name, item["collection"] = collection_id;
  item["geometry"] = {{"type", "Point"}, {"coordinates", Json::array({lon, lat})}};
  item["bbox"] = Json::array({lon, lat, lon, lat});
  item["properties"] = properties(e);
  const auto root = up(depth(e.folder));
  Json links = Json::array({link("root", root + "catalog.json"), link("parent", "../catalog.json"),
                            link("collection", root + "collection.json")});
  const auto version = [&](const char* rel, const std::string& folder, const std::string& name) {
    if (!name.empty()) links.push_back(link(rel, way_to(e, folder, name), "application/geo+json"));
  };
  version("predecessor-version", versions.folder_of_predecessor, versions.predecessor);
  version("successor-version", versions.folder_of_successor, versions.successor);
  version("latest-version", versions.folder_of_latest, versions.latest);
  item["links"] = links;
  // A multihash: 0x12 is SHA-256, 0x20 its length.
  item["assets"]["netcdf"] = {{"href", "./" + e.name + ".nc"}, {"type", "application/x-netcdf"},
                              {"title", "CF netCDF profile"},  {"roles", Json::array({"data"})},
                              {"file:size", e.bytes},          {"file:checksum", "1220" + e.sha256}};
  item["assets"]["manifest"] = {{"href", "./manifest.json"},
                                {"type", json_type},
                                {"title", "what it was made of, and its SHA-256"},
                                {"roles", Json::array({"metadata"})}};
  return json_text(item);
}

std::string stac_root() {
  auto o = catalogue("Catalog", "quadsonde-archive", "quadsonde archive",
                     "Vertical wind profiles from multirotor flight logs.");
  o["links"] = Json::array({link("root", "./catalog.json"), link("child", "./collection.json")});
  return json_text(o);
}

std::string stac_collection(const ArchiveExtent& extent, const std::vector<std::string>& years) {
  auto o = catalogue("Collection", collection_id, "Wind profiles",
                     "Vertical wind profiles from multirotor flight logs, one CF netCDF per flight. A flight that was "
                     "processed again has several versions; the older ones are marked as deprecated.");
  o["keywords"] = Json::array({"wind", "profile", "boundary layer", "uncrewed aircraft"});
  // Each file states its own; the collection cannot speak for them.
  o["license"] = "various";
  Json box = Json::array({-180, -90, 180, 90}), interval = Json::array({nullptr, nullptr});
  if (extent.any) {
    box = Json::array({json_number(extent.west, 7), json_number(extent.south, 7), json_number(extent.east, 7),
                       json_number(extent.north, 7)});
    interval = Json::array({utc(extent.start_s), utc(extent.end_s)});
  }
  o["extent"]["spatial"]["bbox"].push_back(box);
  o["extent"]["temporal"]["interval"].push_back(interval);
  o["links"] = Json::array({link("root", "./catalog.json"), link("parent", "./catalog.json")});
  for (const auto& year : years) o["links"].push_back(link("child", "./profiles/" + year + "/catalog.json"));
  return json_text(o);
}

std::string stac_branch(const std::string& folder, const std::vector<std::string>& children) {
  auto o = catalogue("Catalog", id_of(folder), last_part(folder),
                     fmt::format("Wind profiles of {}.", folder.substr(folder.find('/') + 1)));
  const auto root = up(depth(folder));
  o["links"] = Json::array({link("root", root + "catalog.json"),
                            link("parent", depth(folder) == 2 ? root + "collection.json" : "../catalog.json")});
  for (const auto& child : children) o["links"].push_back(link("child", "./" + child + "/catalog.json"));
  return json_text(o);
}

std::string stac_leaf(const std::string& folder, const std::vector<std::string>& items) {
  auto o = catalogue("Catalog", id_of(folder), last_part(folder),
                     fmt::format("Wind profiles of {}.", folder.substr(folder.find('/') + 1)));
  o["links"] = Json::array({link("root", up(depth(folder)) + "catalog.json"), link("parent", "../catalog.json")});
  for (const auto& item : items)
    o["links"].push_back(link("item", "./" + item + "/" + item + ".json", "application/geo+json"));
  return json_text(o);
}

}  // namespace quadsonde::product

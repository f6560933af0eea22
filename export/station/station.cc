#include "export/station/station.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

#include "ingest/motion/toml_fields.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Problem;
using ingest::Result;
using ingest::TomlFields;

bool only_letters_and_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
}
bool only_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// A part of the identifier up to the next hyphen, which is taken off too.
std::optional<int> number_part(std::string_view& text, int most) {
  const auto end = text.find('-');
  if (end == std::string_view::npos || end == 0 || end > 5 || !only_digits(text.substr(0, end))) return std::nullopt;
  int value = 0;
  std::from_chars(text.data(), text.data() + end, value);
  text.remove_prefix(end + 1);
  return value <= most ? std::optional(value) : std::nullopt;
}

void check_identifiers(const Station& s, TomlFields station, TomlFields uasdc) {
  if (!s.wigos_id.empty() && !parse_wigos_id(s.wigos_id))
    station.complain("wigos_id",
                     "expected a WIGOS station identifier: series-issuer-number-local, such as 0-20000-0-15015",
                     station.find("wigos_id"));
  if (!s.operator_id.empty() && (s.operator_id.size() != 3 || !only_digits(s.operator_id)))
    uasdc.complain("operator_id", "expected three digits in quotes, such as \"007\"", uasdc.find("operator_id"));
  if (!s.airframe_id.empty() && (s.airframe_id.size() > 5 || !only_letters_and_digits(s.airframe_id)))
    uasdc.complain("airframe_id", "expected one to five letters and digits", uasdc.find("airframe_id"));
}

void read_who(TomlFields who, std::string& name, std::string& email, std::string& url) {
  who.set("name", name);
  who.set("email", email);
  who.set("url", url);
  who.leftover();
}

}  // namespace

std::optional<WigosId> parse_wigos_id(std::string_view text) {
  // The largest number of each width is "missing" in BUFR.
  const auto series = number_part(text, 14), issuer = number_part(text, 65534), number = number_part(text, 65534);
  if (!series || !issuer || !number || text.empty() || text.size() > 16 || !only_letters_and_digits(text))
    return std::nullopt;
  return WigosId{*series, *issuer, *number, std::string(text)};
}

Result<Station> parse_station(std::string_view toml, const std::string& file) {
  const auto parsed = ingest::parse_toml(toml, file);
  if (!parsed) return fail(parsed.error());
  std::optional<Problem> problem;
  TomlFields root(*parsed, "", file, problem);
  Station s;
  s.file = std::filesystem::path(file).filename().string();
  auto station = root.table("station"), uasdc = root.table("uasdc"), platform = root.table("platform"),
       data = root.table("data");
  station.set("wigos_id", s.wigos_id);
  station.set("name", s.name);
  uasdc.set("operator_id", s.operator_id);
  uasdc.set("airframe_id", s.airframe_id);
  platform.set("name", s.platform_name);
  platform.set("type", s.platform_type);
  read_who(root.table("contact"), s.contact_name, s.contact_email, s.contact_url);
  read_who(root.table("publisher"), s.publisher_name, s.publisher_email, s.publisher_url);
  data.set("institution", s.institution);
  data.set("project", s.project);
  data.set("license", s.license);
  data.set("references", s.references);
  data.set("acknowledgement", s.acknowledgement);
  data.set("naming_authority", s.naming_authority);
  check_identifiers(s, station, uasdc);
  for (auto* table : {&station, &uasdc, &platform, &data, &root}) table->leftover();
  if (problem) return fail(*problem);
  return s;
}

Result<Station> read_station(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  // A folder opens too, and reads nothing.
  if (!stream || stream.peek() == std::ifstream::traits_type::eof())
    return fail(Kind::unreadable, "the station file cannot be read", {path.string(), {}, {}, {}},
                "give an existing file, or leave --station out");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_station(text, path.string());
}

Result<Station> choose_station(const std::string& setting, const std::filesystem::path& log) {
  if (setting != "auto") return read_station(setting);
  const auto beside = log.parent_path() / "station.toml";
  std::error_code error;
  return std::filesystem::exists(beside, error) ? read_station(beside) : Result<Station>(Station{});
}

}  // namespace quadsonde::product

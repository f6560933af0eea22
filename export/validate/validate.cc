#include "export/validate/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "export/cf_netcdf/describe.h"
#include "export/report/text_answer.h"
#include "export/validate/bufr_rules.h"
#include "export/validate/mcap_rules.h"
#include "export/validate/netcdf_file.h"
#include "ingest/mcap/flight_from_mcap.h"
#include "ingest/open/mapped_file.h"

namespace quadsonde::product {
namespace {

using ingest::Bytes;
using ingest::Kind;

bool begins(Bytes bytes, std::string_view mark) {
  return bytes.size() >= mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin(), [](char c, std::uint8_t b) {
           return static_cast<std::uint8_t>(c) == b;
         });
}

/// Bulletins put a few lines before a message.
bool holds_bufr(Bytes bytes) {
  constexpr std::size_t near = 512;
  const auto head = bytes.first(std::min(bytes.size(), near));
  constexpr std::string_view mark = "BUFR";
  return std::search(head.begin(), head.end(), mark.begin(), mark.end(),
                     [](std::uint8_t b, char c) { return b == static_cast<std::uint8_t>(c); }) != head.end();
}

bool is_netcdf(Bytes bytes) { return begins(bytes, "\x89HDF\r\n\x1a\n") || begins(bytes, "CDF"); }

/// What of the file the rules cannot see.
void note_limits(const NetcdfFile& f, Findings& found) {
  if (f.description().groups > 0)
    found.add(rule("netcdf.not-looked-at"), "",
              fmt::format("{} groups below the root are not looked at", f.description().groups));
  for (const auto& v : f.variables()) {
    if (v.data == NcData::unreadable) found.add(rule("netcdf.data"), v.name, "its data cannot be read");
    if (v.data == NcData::too_many)
      found.add(rule("netcdf.not-looked-at"), v.name, "it has more values than this check holds");
  }
}

ingest::Result<void> check_netcdf(Bytes bytes, const std::string& name, Validation& out, Findings& found) {
  auto description = describe_netcdf(bytes);
  out.kind = "netCDF";
  if (!description && description.error().kind == Kind::no_answer) return ingest::fail(description.error());
  if (!description) {
    found.add(rule("netcdf.open"), "", description.error().what);
    return {};
  }
  out.kind = description->format;
  NetcdfFile f(std::move(*description), std::filesystem::path(name).filename().string());
  ask_cf_units(f);
  ask_uasdc_units(f);
  if (auto asked = f.units.answer(); !asked) return asked;
  out.conventions = "CF-1.8";
  note_limits(f, found);
  check_cf_texts(f, found);
  check_cf_units(f, found);
  check_cf_coordinates(f, found);
  check_cf_cells(f, found);
  check_cf_features(f, found);
  if (f.claims_acdd()) {
    out.conventions += ", ACDD-1.3";
    check_acdd(f, found);
  }
  if (f.is_uasdc()) {
    out.conventions += ", WMO UAS-DC";
    check_uasdc(f, found);
  }
  check_wind(f, found);
  return {};
}

std::string_view name_of(Severity severity) {
  constexpr std::string_view names[] = {"error", "warning", "note"};
  return names[static_cast<int>(severity)];
}

std::string counted(std::size_t n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

/// A finding in one line; its rule follows once for all findings of it that stand together.
std::string finding_text(const Finding& finding) {
  const auto where = finding.where.empty() ? "" : finding.where + ": ";
  return wrapped(fmt::format("{}: {}{}", name_of(finding.rule->severity), where, finding.what), 79, 4) + "\n";
}

std::string rule_text(const Rule& rule) {
  auto text = wrapped(fmt::format("    {} [{}]", rule.source, rule.id), 79, 6) + "\n";
  if (rule.severity != Severity::note) text += wrapped(fmt::format("    -> {}", rule.mend), 79, 7) + "\n";
  return text;
}

}  // namespace

std::size_t Validation::count(Severity severity) const {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(), [&](const auto& f) { return f.rule->severity == severity; }));
}

ingest::Result<Validation> validate(Bytes bytes, const std::string& name) {
  Validation out;
  out.file = name;
  Findings found;
  if (is_netcdf(bytes)) {
    if (auto done = check_netcdf(bytes, name, out, found); !done) return ingest::fail(done.error());
  } else if (ingest::looks_like_mcap(bytes)) {
    out.kind = out.conventions = "MCAP";
    check_mcap(bytes, found);
  } else if (holds_bufr(bytes)) {
    out.kind = "BUFR";
    out.conventions = "FM 94 BUFR";
    if (auto done = check_bufr(bytes, found); !done) return ingest::fail(done.error());
  } else {
    return ingest::fail(Kind::unsupported, "it is neither netCDF nor BUFR nor MCAP", {name, {}, {}, {}},
                        "give one of these; `quadsonde info` knows logs of other kinds");
  }
  out.findings = found.list();
  out.left_out = found.left_out();
  std::stable_sort(out.findings.begin(), out.findings.end(),
                   [](const auto& a, const auto& b) {
                     if (a.rule->severity != b.rule->severity) return a.rule->severity < b.rule->severity;
                     return a.rule < b.rule;  // in the order of the rule book
                   });
  return out;
}

ingest::Result<Validation> validate_file(const std::filesystem::path& path) {
  const auto file = ingest::MappedFile::open(path);
  if (!file) return ingest::fail(file.error());
  auto out = validate(file->bytes(), path.string());
  return out;
}

std::string validation_text(const Validation& v) {
  std::string text =
      wrapped(fmt::format("{}: {}{}", std::filesystem::path(v.file).filename().string(), v.kind,
                          v.conventions.empty() || v.conventions == v.kind ? "" : ", held against " + v.conventions)) +
      "\n";
  for (std::size_t i = 0; i < v.findings.size(); ++i) {
    text += finding_text(v.findings[i]);
    if (i + 1 == v.findings.size() || v.findings[i + 1].rule != v.findings[i].rule) text += rule_text(*v.findings[i].rule);
  }
  if (v.left_out) text += fmt::format("{} are not listed\n", counted(v.left_out, "further finding"));
  return text + fmt::format("{}: {}, {}, {}\n", v.conformant() ? "conformant" : "not conformant",
                            counted(v.count(Severity::error), "error"), counted(v.count(Severity::warning), "warning"),
                            counted(v.count(Severity::note), "note"));
}

std::string validation_json(const Validation& v) {
  nlohmann::ordered_json json;
  json["schema"] = "quadsonde.validation/1";
  json["file"] = std::filesystem::path(v.file).filename().string();
  json["kind"] = v.kind;
  json["conventions"] = v.conventions;
  json["conformant"] = v.conformant();
  json["findings"] = nlohmann::ordered_json::array();
  for (const auto& f : v.findings)
    json["findings"].push_back({{"severity", name_of(f.rule->severity)},
                                {"rule", f.rule->id},
                                {"where", f.where},
                                {"what", f.what},
                                {"source", f.rule->source},
                                {"mend", f.rule->mend}});
  json["not_listed"] = v.left_out;
  // Texts out of a foreign file may be no UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace quadsonde::product

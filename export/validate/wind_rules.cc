// What winds must be in any file, and what our own files promise beside.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "export/validate/netcdf_file.h"

namespace quadsonde::product {
namespace {

/// The variable that is this quantity itself: no error, spread or second height of it.
const NcVariable* plain(const NetcdfFile& f, std::string_view standard) {
  for (const auto& v : f.variables()) {
    const auto methods = NetcdfFile::text(v, "cell_methods");
    const bool spread =
        methods.find("standard_deviation") != std::string::npos || methods.find("variance") != std::string::npos;
    if (NetcdfFile::text(v, "standard_name") == standard && !spread && v.data == NcData::all && !is_text(v.type))
      return &v;
  }
  return nullptr;
}

std::string at_index(const NcVariable& v, std::size_t i) { return fmt::format("{}, value {}", v.name, i + 1); }

void check_vectors(const NetcdfFile& f, Findings& found) {
  const auto *east = plain(f, "eastward_wind"), *north = plain(f, "northward_wind"), *speed = plain(f, "wind_speed"),
             *from = plain(f, "wind_from_direction");
  if (!east || !north || east->values.size() != north->values.size()) return;
  const auto u = NetcdfFile::data(*east), v = NetcdfFile::data(*north);
  if (speed && speed->values.size() == u.size()) {
    const auto s = NetcdfFile::data(*speed);
    for (std::size_t i = 0; i < u.size(); ++i)
      if (const double length = std::hypot(u[i], v[i]);
          !std::isnan(length) && !std::isnan(s[i]) && std::abs(length - s[i]) > 0.01 + 1e-3 * length) {
        found.add(rule("wind.speed"), at_index(*speed, i),
                  fmt::format("it is {:.2f}, the vector is {:.2f} long", s[i], length));
        break;
      }
  }
  if (!from || from->values.size() != u.size()) return;
  const auto d = NetcdfFile::data(*from);
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (std::isnan(d[i]) || std::hypot(u[i], v[i]) < 0.1) continue;
    const double right = std::atan2(-u[i], -v[i]) * 180 / std::numbers::pi;
    // 0.1 degrees, and what single precision leaves of a weak vector.
    if (std::abs(std::remainder(d[i] - right, 360)) > 0.1 + 0.01 / std::hypot(u[i], v[i])) {
      found.add(rule("wind.direction"), at_index(*from, i),
                fmt::format("it is {:.1f}, the vector comes from {:.1f}", d[i], right <= 0 ? right + 360 : right));
      break;
    }
  }
}

void check_directions(const NetcdfFile& f, Findings& found) {
  for (const auto& v : f.variables()) {
    const bool direction =
        NetcdfFile::text(v, "standard_name") == "wind_from_direction" || (f.is_uasdc() && v.name == "wind_direction");
    if (!direction || v.data != NcData::all ||
        NetcdfFile::text(v, "cell_methods").find("deviation") != std::string::npos)
      continue;
    const auto values = NetcdfFile::data(v);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] < 0 || values[i] > 360) {
        found.add(rule("wind.direction-range"), at_index(v, i), fmt::format("it is {}", values[i]));
        break;
      }
  }
}

/// n_obs = 0, no wind and wind_qc = 9 say the same thing three times.
void check_missing(const NetcdfFile& f, Findings& found) {
  const auto *east = plain(f, "eastward_wind"), *count = f.find("n_obs"), *quality = f.find("wind_qc"),
             *reasons = f.find("wind_qc_reasons");
  if (!f.is_ours() || !east || !quality || quality->values.size() != east->values.size()) return;
  const auto u = NetcdfFile::data(*east);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const bool none = std::isnan(u[i]), flagged = quality->values[i] == 9;
    const bool counted = !count || count->values.size() != u.size() || (count->values[i] == 0) == none;
    if (none == flagged && counted) continue;
    found.add(rule("wind.missing"), at_index(*quality, i),
              fmt::format("wind_qc {}{}, and the wind is {}", quality->values[i],
                          count && count->values.size() == u.size() ? fmt::format(", n_obs {}", count->values[i]) : "",
                          none ? "missing" : "there"));
    break;
  }
  if (!reasons || reasons->values.size() != u.size()) return;
  for (std::size_t i = 0; i < u.size(); ++i)
    if (std::isnan(u[i]) && reasons->values[i] == 0) {
      found.add(rule("wind.reason"), at_index(*reasons, i), "no reason is given");
      break;
    }
}

void check_ranges(const NetcdfFile& f, Findings& found) {
  struct Range {
    std::string_view name;
    double low, high;
  };
  // Wider than the records of the WMO archive of extremes.
  constexpr Range ranges[] = {{"wind_speed", 0, 150},
                              {"eastward_wind", -150, 150},
                              {"northward_wind", -150, 150},
                              {"upward_air_velocity", -50, 50}};
  for (const auto& v : f.variables())
    for (const auto& range : ranges) {
      const auto standard = NetcdfFile::text(v, "standard_name");
      if ((standard != range.name && v.name != range.name) || v.data != NcData::all) continue;
      const auto values = NetcdfFile::data(v);
      const auto wrong =
          std::find_if(values.begin(), values.end(), [&](double x) { return x < range.low || x > range.high; });
      if (wrong != values.end()) found.add(rule("data.range"), v.name, fmt::format("{} m/s is no wind", *wrong));
    }
}

}  // namespace

void check_wind(const NetcdfFile& f, Findings& found) {
  check_vectors(f, found);
  check_directions(f, found);
  check_missing(f, found);
  check_ranges(f, found);
  if (f.is_ours() && f.global_text("quadsonde_input_sha256").size() != 64 && f.global_text("quadsonde_inputs").empty())
    found.add(rule("wind.provenance"), "", "it does not tell the log that it was made of");
}

}  // namespace quadsonde::product

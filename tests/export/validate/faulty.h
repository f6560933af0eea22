#pragma once
// Conformant files of ours, and what the checker says of bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "export/bufr/bufr.h"
#include "export/cf_netcdf/cf_netcdf.h"
#include "export/mcap/products_to_mcap.h"
#include "export/uasdc/uasdc.h"
#include "export/validate/validate.h"
#include "tests/export/made_up.h"

namespace quadsonde::support {

inline product::NetcdfMetadata known_site() {
  product::NetcdfMetadata metadata;
  metadata.takeoff = ingest::GeoPoint{43.5657, 1.4815};
  metadata.takeoff_msl = ingest::MslHeight{150.4};
  metadata.station.wigos_id = "0-454-2-AWSNAMITAMBO";
  metadata.station.operator_id = "007", metadata.station.airframe_id = "QS001";
  return metadata;
}
inline product::ProductSource known_source() {
  auto source = made_up_source();
  source.sha256 = std::string(64, 'a');
  return source;
}

/// What the call gave; a failure is told instead of ending the program.
template <class Text>
std::string given(const ingest::Result<Text>& result) {
  EXPECT_TRUE(result) << (result ? "" : ingest::to_string(result.error()));
  return result ? std::string(*result) : std::string();
}
inline std::string profile_file() {
  auto profile = made_up_profile();
  const ingest::UtcTime start{1'750'000'000'000'000'000};
  for (std::size_t i = 0; i < profile.legs.size(); ++i) {
    profile.legs[i].utc_from = start + ingest::seconds(120.0 * static_cast<double>(i));
    profile.legs[i].utc_to = *profile.legs[i].utc_from + ingest::seconds(100);
  }
  return given(product::profile_netcdf(profile, known_source(), known_site()));
}

/// The rules that a file breaks, notes left out.
inline std::set<std::string> broken_rules(const std::string& bytes, const std::string& name) {
  const auto said = product::validate({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name);
  EXPECT_TRUE(said) << (said ? "" : ingest::to_string(said.error()));
  std::set<std::string> rules;
  if (said)
    for (const auto& finding : said->findings)
      if (finding.rule->severity != product::Severity::note) rules.insert(std::string(finding.rule->id));
  return rules;
}

/// A rule as part of a test's name.
inline std::string test_name(std::string rule) {
  for (auto& c : rule)
    if (c == '.' || c == '-') c = '_';
  return rule;
}

inline std::set<std::string> only(const std::string& rule) { return {rule}; }

}  // namespace quadsonde::support

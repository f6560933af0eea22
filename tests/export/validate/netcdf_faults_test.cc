// One fault in a conformant netCDF file, and the one rule that finds it.
#include <netcdf.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "export/atomic_file.h"
#include "export/cf_netcdf/describe.h"
#include "faulty.h"
#include "tests/support/data.h"

namespace quadsonde {
namespace {

using support::broken_rules;

/// The file open for changes; each call asserts that it was done.
class Editor {
 public:
  explicit Editor(const std::filesystem::path& path) {
    check(nc_open(path.c_str(), NC_WRITE, &id_));
    check(nc_redef(id_));
  }
  ~Editor() { check(nc_close(id_)); }
  void text(const char* variable, const char* name, const std::string& value) {
    const int v = variable_id(variable);
    nc_del_att(id_, v, name);  // a string of ours may be of another type; absent is fine
    check(nc_put_att_text(id_, v, name, value.size(), value.c_str()));
  }
  void number(const char* variable, const char* name, double value, nc_type type = NC_DOUBLE) {
    nc_del_att(id_, variable_id(variable), name);
    check(nc_put_att_double(id_, variable_id(variable), name, type, 1, &value));
  }
  void numbers(const char* variable, const char* name, std::vector<double> values, nc_type type) {
    nc_del_att(id_, variable_id(variable), name);
    check(nc_put_att_double(id_, variable_id(variable), name, type, values.size(), values.data()));
  }
  void remove(const char* variable, const char* name) { check(nc_del_att(id_, variable_id(variable), name)); }
  void rename(const char* from, const char* to) { check(nc_rename_var(id_, variable_id(from), to)); }
  void value(const char* variable, std::vector<std::size_t> at, double value) {
    nc_enddef(id_);
    check(nc_put_var1_double(id_, variable_id(variable), at.data(), &value));
    nc_redef(id_);
  }
  void add(const char* name, nc_type type, std::vector<const char*> dimensions) {
    std::vector<int> ids;
    for (const char* d : dimensions) {
      ids.push_back(-1);
      check(nc_inq_dimid(id_, d, &ids.back()));
    }
    int v = -1;
    check(nc_def_var(id_, name, type, static_cast<int>(ids.size()), ids.data(), &v));
  }

 private:
  static void check(int status) { EXPECT_EQ(status, NC_NOERR) << nc_strerror(status); }
  int variable_id(const char* name) {
    int v = NC_GLOBAL;
    if (*name) check(nc_inq_varid(id_, name, &v));
    return v;
  }
  int id_ = -1;
};

struct Fault {
  const char* rule;
  void (*inject)(Editor&);
};
/// Of the same name for GoogleTest.
std::ostream& operator<<(std::ostream& out, const Fault& fault) { return out << fault.rule; }

std::string changed(const std::string& bytes, const std::string& name, const Fault& fault) {
  const support::TemporaryFolder folder;
  const auto path = folder / name;
  EXPECT_TRUE(product::write_file(path, bytes));
  {
    Editor editor(path);
    fault.inject(editor);
  }
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

const std::string& profile_bytes() {
  static const auto bytes = support::profile_file();
  return bytes;
}

/// The made-up series as a climb and a descent, as the campaign has it.
product::Observations observed() {
  auto series = support::made_up_series();
  for (std::size_t i = 0; i < series.points.size(); ++i) series.points[i].v_up = i < 200 ? 11.5 : -11.5;
  auto all = product::profile_observations(support::made_up_profile(), series, {}, support::known_site(), false,
                                           "UASDC netCDF");
  EXPECT_TRUE(all) << (all ? "" : ingest::to_string(all.error()));
  return all.value_or(product::Observations{});
}
const std::string& uasdc_bytes() {
  static const auto bytes =
      support::given(product::uasdc_netcdf(observed(), support::known_source(), support::known_site()));
  return bytes;
}
std::string uasdc_name() {
  return support::given(product::uasdc_file_name(support::known_site().station, observed().all.front().utc));
}

class CfFault : public testing::TestWithParam<Fault> {};
class UasdcFault : public testing::TestWithParam<Fault> {};

TEST(ValidateNetcdf, FindsNothingWrongWithOurOwnFiles) {
  EXPECT_EQ(broken_rules(profile_bytes(), "profile.nc"), std::set<std::string>{});
  const auto wind = product::wind_netcdf(support::made_up_series(), support::known_source(), support::known_site());
  ASSERT_TRUE(wind);
  EXPECT_EQ(broken_rules(*wind, "wind.nc"), std::set<std::string>{});
  EXPECT_EQ(broken_rules(uasdc_bytes(), uasdc_name()), std::set<std::string>{});
}

TEST(ValidateNetcdf, FindsNothingWrongWithAProfileWhoseTakeOffHeightNobodyKnows) {
  // Its `height` was there, all missing, beside winds: 18 errors of section 9.6 in archived real flights.
  auto profile = support::made_up_profile();
  profile.datum = profiles::Datum::msl;
  for (auto& leg : profile.legs)
    for (auto& bin : leg.bins) bin.height_agl.reset();
  profile.legs = {profile.legs.back()};
  auto site = support::known_site();
  site.takeoff_msl.reset();
  EXPECT_EQ(broken_rules(support::given(product::profile_netcdf(profile, support::known_source(), site)), "p.nc"),
            std::set<std::string>{});
}

TEST_P(CfFault, IsFoundByItsRuleAlone) {
  EXPECT_EQ(broken_rules(changed(profile_bytes(), "profile.nc", GetParam()), "profile.nc"),
            support::only(GetParam().rule));
}
TEST_P(UasdcFault, IsFoundByItsRuleAlone) {
  const auto name = uasdc_name();
  EXPECT_EQ(broken_rules(changed(uasdc_bytes(), name, GetParam()), name), support::only(GetParam().rule));
}

constexpr Fault cf_faults[] = {
    {"cf.conventions", [](Editor& e) { e.text("", "Conventions", "COARDS, ACDD-1.3"); }},
    {"cf.attribute-type", [](Editor& e) { e.number("", "source", 7); }},
    {"cf.fill-type", [](Editor& e) { e.number("eastward_wind", "missing_value", NAN, NC_DOUBLE); }},
    {"cf.coordinate-fill", [](Editor& e) { e.number("altitude", "missing_value", -999, NC_DOUBLE); }},
    {"cf.units-missing", [](Editor& e) { e.remove("northward_wind", "units"); }},
    {"cf.units-absent", [](Editor& e) { e.remove("effective_n_obs", "units"); }},
    {"cf.units-parse", [](Editor& e) { e.text("wind_error_covariance", "units", "gusts per flight"); }},
    {"cf.units-convert", [](Editor& e) { e.text("wind_speed_se", "units", "kg"); }},
    {"cf.standard-name-spelling",
     [](Editor& e) { e.text("wind_speed_se", "standard_name", "wind_sped standard_error"); }},
    {"cf.standard-name-modifier",
     [](Editor& e) { e.text("wind_speed_se", "standard_name", "wind_speed standard_eror"); }},
    {"cf.standard-name", [](Editor& e) { e.text("wind_sd_trim", "standard_name", "wobbliness_of_airframe"); }},
    {"cf.ancillary-variables", [](Editor& e) { e.text("wind_speed", "ancillary_variables", "wind_speed_se nowhere"); }},
    {"cf.flag-meanings", [](Editor& e) { e.text("wind_qc", "flag_meanings", "good not_evaluated suspect fail"); }},
    {"cf.flag-type",
     [](Editor& e) {
       e.numbers("wind_qc", "flag_values", {1, 2, 3, 4, 9}, NC_INT);
     }},
    {"cf.flag-values",
     [](Editor& e) {
       e.numbers("leg", "flag_values", {0, 1, 1}, NC_BYTE);
     }},
    {"cf.axis", [](Editor& e) { e.text("lat", "axis", "N"); }},
    {"cf.latitude",
     [](Editor& e) {
       e.text("lat", "units", "degree_north_of_equator_is_no_unit");
       e.text("lat", "units", "degree");
     }},
    {"cf.longitude", [](Editor& e) { e.text("lon", "units", "degree"); }},
    {"cf.positive", [](Editor& e) { e.text("wind_speed", "positive", "up"); }},
    {"cf.positive-missing", [](Editor& e) { e.remove("altitude", "positive"); }},
    {"cf.calendar", [](Editor& e) { e.text("time", "calendar", "mayan"); }},
    {"cf.coordinates", [](Editor& e) { e.text("leg", "coordinates", "lat lon station_id profile_id elsewhere"); }},
    {"cf.coordinates-dimensions",
     [](Editor& e) { e.text("leg", "coordinates", "lat lon height station_id profile_id"); }},
    {"cf.grid-mapping", [](Editor& e) { e.text("wind_speed", "grid_mapping", "mercator"); }},
    {"cf.crs-names", [](Editor& e) { e.remove("crs", "prime_meridian_name"); }},
    {"cf.bounds", [](Editor& e) { e.text("lat", "bounds", "lat_edges"); }},
    {"cf.bounds-shape", [](Editor& e) { e.text("lat", "bounds", "altitude_bnds"); }},
    {"cf.bounds-enclose",
     [](Editor& e) {
       e.value("altitude_bnds", {0, 0}, 0);
       e.value("altitude_bnds", {0, 1}, 1);
       e.value("altitude_bnds", {1, 0}, 1);
     }},
    {"cf.bounds-contiguous",
     [](Editor& e) {
       e.value("altitude_bnds", {0, 1}, 500);
     }},
    {"cf.bounds-attributes", [](Editor& e) { e.text("altitude_bnds", "units", "km"); }},
    {"cf.cell-methods", [](Editor& e) { e.text("wind_speed", "cell_methods", "mean over all"); }},
    {"cf.cell-methods-name", [](Editor& e) { e.text("wind_speed", "cell_methods", "nowhere: time: mean"); }},
    {"cf.cell-method", [](Editor& e) { e.text("wind_speed", "cell_methods", "altitude: time: average"); }},
    {"cf.packing",
     [](Editor& e) {
       e.number("effective_n_obs", "scale_factor", 1, NC_FLOAT);
       e.number("effective_n_obs", "add_offset", 0, NC_DOUBLE);
     }},
    {"cf.valid-range", [](Editor& e) { e.number("wind_speed", "valid_min", 4, NC_FLOAT); }},
    {"cf.feature-type", [](Editor& e) { e.text("", "featureType", "vertical_profile"); }},
    {"cf.cf-role", [](Editor& e) { e.text("surface_altitude", "cf_role", "height_id"); }},
    {"cf.cf-role-missing", [](Editor& e) { e.remove("profile_id", "cf_role"); }},
    {"cf.described",
     [](Editor& e) {
       e.add("extra", NC_FLOAT, {});
       e.text("extra", "units", "m");
       e.text("extra", "coverage_content_type", "auxiliaryInformation");
       e.text("extra", "long_name", " ");
       e.remove("extra", "long_name");
     }},
    {"cf.dimension-twice",
     [](Editor& e) {
       e.add("square", NC_CHAR, {"id_strlen", "id_strlen"});
     }},
    {"cf.type",
     [](Editor& e) {
       e.add("long_count", NC_INT64, {});
       e.text("long_count", "units", "1");
       e.text("long_count", "long_name", "a count");
       e.text("long_count", "coverage_content_type", "auxiliaryInformation");
     }},
    {"cf.name",
     [](Editor& e) {
       e.rename("wind_sd_trim", "wind-sd-trim");
       for (const char* v : {"eastward_wind", "northward_wind", "wind_speed", "wind_from_direction"})
         e.text(v, "ancillary_variables", "wind_qc");
     }},
    {"cf.feature-missing",
     [](Editor& e) {
       e.value("height", {0, 3}, NAN);
     }},
    {"acdd.highly-recommended", [](Editor& e) { e.remove("", "summary"); }},
    {"acdd.content-type", [](Editor& e) { e.text("wind_speed", "coverage_content_type", "wind"); }},
    {"acdd.content-type-missing", [](Editor& e) { e.remove("wind_speed", "coverage_content_type"); }},
    {"acdd.long-name", [](Editor& e) { e.remove("wind_speed", "long_name"); }},
    {"acdd.date", [](Editor& e) { e.text("", "date_created", "yesterday"); }},
    {"acdd.duration", [](Editor& e) { e.text("", "time_coverage_duration", "2 minutes"); }},
    {"acdd.extent", [](Editor& e) { e.number("", "geospatial_vertical_max", 9000); }},
    {"acdd.time-coverage", [](Editor& e) { e.text("", "time_coverage_start", "1999-01-01T00:00:00Z"); }},
    {"acdd.vertical-positive", [](Editor& e) { e.text("", "geospatial_vertical_positive", "upward"); }},
    {"acdd.bounds", [](Editor& e) { e.text("", "geospatial_bounds", "43.6 N, 1.5 E"); }},
    {"wind.speed",
     [](Editor& e) {
       e.value("wind_speed", {0, 2}, 25);
     }},
    {"wind.direction",
     [](Editor& e) {
       e.value("wind_from_direction", {0, 2}, 80);
     }},
    {"wind.missing",
     [](Editor& e) {
       e.value("wind_qc", {0, 2}, 9);
     }},
    {"wind.provenance", [](Editor& e) { e.remove("", "quadsonde_input_sha256"); }},
};
INSTANTIATE_TEST_SUITE_P(Cf, CfFault, testing::ValuesIn(cf_faults),
                         [](const auto& fault) { return support::test_name(fault.param.rule); });

constexpr Fault uasdc_faults[] = {
    {"uasdc.units", [](Editor& e) { e.text("altitude", "units", "km"); }},
    {"uasdc.time-units", [](Editor& e) { e.text("time", "units", "seconds since 1970-01-01 00:00:00"); }},
    {"uasdc.attributes", [](Editor& e) { e.text("wind_speed", "processing_level", ""); }},
    {"uasdc.conventions", [](Editor& e) { e.text("", "Conventions", "CF-1.8"); }},
    {"uasdc.profile", [](Editor& e) { e.text("", "wmo__cf_profile", "GS_wxhive_admin"); }},
    {"uasdc.feature-type", [](Editor& e) { e.remove("", "featureType"); }},
    {"uasdc.flight-id", [](Editor& e) { e.text("", "flight_id", ""); }},
    {"uasdc.terrain", [](Editor& e) { e.text("", "site_terrain_elevation_height", "high"); }},
    {"uasdc.processing-level", [](Editor& e) { e.text("", "processing_level", "raw"); }},
    {"uasdc.file-airframe", [](Editor& e) { e.text("", "platform_name", "QS002"); }},
    {"wind.direction-range", [](Editor& e) { e.value("wind_direction", {1}, 400); }},
};
INSTANTIATE_TEST_SUITE_P(Uasdc, UasdcFault, testing::ValuesIn(uasdc_faults),
                         [](const auto& fault) { return support::test_name(fault.param.rule); });

TEST(ValidateNetcdf, MissesARequiredVariable) {
  // A classic file: netCDF-C 4.9.0 damages a netCDF-4 file of ours when it renames this variable in place.
  std::ifstream in(QUADSONDE_SOURCE "/tests/fuzz/validate/corpus/uasdc.nc", std::ios::binary);
  const std::string classic{std::istreambuf_iterator<char>(in), {}};
  const auto* name = "UASDC_007_QS001_20260601053007Z.nc";
  EXPECT_EQ(broken_rules(classic, name), std::set<std::string>{});
  const Fault fault{"uasdc.required", [](Editor& e) { e.rename("air_temperature", "temperature"); }};
  EXPECT_EQ(broken_rules(changed(classic, name, fault), name), support::only("uasdc.required"));
}

TEST(ValidateNetcdf, HoldsTheCampaignsFilesToTheirNames) {
  EXPECT_EQ(broken_rules(uasdc_bytes(), "flight7.nc"), support::only("uasdc.file-name"));
  EXPECT_EQ(broken_rules(uasdc_bytes(), "UASDC_007_QS001_19990101000000Z.nc"), support::only("uasdc.file-time"));
  EXPECT_EQ(broken_rules(uasdc_bytes(), "UASDC_operatorID_airframeID_20230327025804Z.nc"),
            (std::set<std::string>{"uasdc.file-name", "uasdc.placeholder"}));
}

TEST(ValidateNetcdf, NamesTheFaultsOfTheCampaignsPublishedExamples) {
  const auto rules_of = [](const char* file) {
    std::ifstream in(support::data_file(file), std::ios::binary);
    return broken_rules({std::istreambuf_iterator<char>(in), {}}, std::filesystem::path(file).filename().string());
  };
  QUADSONDE_NEEDS_DATA("uasdc/nc2bufr_UASDC_operatorID_airframeID_20230327025804Z.nc");
  const auto first = rules_of("uasdc/nc2bufr_UASDC_operatorID_airframeID_20230327025804Z.nc");
  for (const auto* rule :
       {"uasdc.required", "uasdc.feature-type", "uasdc.profile", "uasdc.terrain", "uasdc.dimension",
        "uasdc.processing-level", "uasdc.placeholder", "cf.coordinate-fill", "cf.units-absent", "cf.described"})
    EXPECT_TRUE(first.contains(rule)) << rule;
  EXPECT_FALSE(first.contains("cf.units-missing")) << "obs counts: it has no units to miss";
  QUADSONDE_NEEDS_DATA("uasdc/raw_uas_to_netCDF_UASDC_operatorID_airframeID_20230327025804Z.nc");
  const auto second = rules_of("uasdc/raw_uas_to_netCDF_UASDC_operatorID_airframeID_20230327025804Z.nc");
  for (const auto* rule : {"uasdc.file-name", "cf.units-parse", "uasdc.units", "uasdc.dimension",
                           "uasdc.processing-level", "cf.coordinate-fill"})
    EXPECT_TRUE(second.contains(rule)) << rule;
  EXPECT_FALSE(second.contains("uasdc.required")) << "air_pressure is there";
  EXPECT_FALSE(second.contains("uasdc.terrain"));
}

TEST(ValidateNetcdf, SaysOfADamagedFileThatItCannotBeOpened) {
  const auto& whole = profile_bytes();
  for (const auto length : {whole.size() - 1, whole.size() / 2, std::size_t{100}}) {
    const auto rules = broken_rules(whole.substr(0, length), "cut.nc");
    EXPECT_TRUE(rules.contains("netcdf.open") || rules.contains("netcdf.data")) << length;
  }
  auto garbage = whole;
  for (std::size_t i = 600; i < garbage.size(); i += 7) garbage[i] = static_cast<char>(i * 31);
  const auto rules = broken_rules(garbage, "garbage.nc");
  EXPECT_TRUE(rules.contains("netcdf.open") || rules.contains("netcdf.data"));
}

TEST(ValidateNetcdf, SaysOfGarbageBehindAMarkThatItCannotBeOpened) {
  for (const auto* mark : {"\x89HDF\r\n\x1a\n", "CDF\x01", "CDF\x02", "CDF\x05"})
    for (const std::size_t more : {0, 8, 4000})
      EXPECT_EQ(broken_rules(mark + std::string(more, '\xFF'), "garbage.nc"), support::only("netcdf.open")) << more;
}

TEST(ValidateNetcdf, LooksAtMoreValuesThanMemoryHoldsOnlyByTheirAttributes) {
  const support::TemporaryFolder folder;
  const auto path = folder / "huge.nc";
  int id = -1, dimensions[2] = {}, v = -1;
  ASSERT_EQ(nc_create(path.c_str(), NC_NETCDF4, &id), NC_NOERR);
  nc_put_att_text(id, NC_GLOBAL, "Conventions", 6, "CF-1.8");
  nc_def_dim(id, "a", 1'000'000, &dimensions[0]);
  nc_def_dim(id, "b", 1'000'000, &dimensions[1]);
  nc_def_var(id, "huge", NC_DOUBLE, 2, dimensions, &v);
  constexpr std::size_t chunk[] = {1000, 1000};
  nc_def_var_chunking(id, v, NC_CHUNKED, chunk);
  nc_put_att_text(id, v, "units", 5, "gusts");
  nc_put_att_text(id, v, "long_name", 4, "huge");
  ASSERT_EQ(nc_close(id), NC_NOERR);
  const auto said = product::validate_file(path);
  ASSERT_TRUE(said);
  std::set<std::string> rules;
  for (const auto& finding : said->findings) rules.insert(std::string(finding.rule->id));
  EXPECT_TRUE(rules.contains("netcdf.not-looked-at")) << "8 TB";
  EXPECT_TRUE(rules.contains("cf.units-parse"));
}

TEST(DescribeNetcdf, KeepsANaNAsTheFillValueThatItIs) {
  const auto& bytes = profile_bytes();
  const auto said = product::describe_netcdf({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  ASSERT_TRUE(said);
  const auto back = product::unpack_description(product::pack(*said));
  ASSERT_TRUE(back);
  std::size_t fills = 0;
  for (const auto& v : back->variables)
    for (const auto& a : v.attributes)
      if (v.name == "eastward_wind" && a.name == "_FillValue") {
        ++fills;
        ASSERT_EQ(a.numbers.size(), 1u);
        EXPECT_TRUE(std::isnan(a.numbers[0]));
        EXPECT_EQ(a.type, v.type);
      }
  EXPECT_EQ(fills, 1u);
}

}  // namespace
}  // namespace quadsonde

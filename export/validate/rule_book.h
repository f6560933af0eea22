#pragma once
// Every rule that validate knows: how grave a breach is, where the standard says so, and what mends it.
#include <span>
#include <string_view>

namespace quadsonde::product {

enum class Severity {
  error,    ///< the standard demands otherwise: the file is not conformant
  warning,  ///< allowed, and likely wrong or unwise
  note      ///< worth knowing
};

struct Rule {
  std::string_view id;
  Severity severity;
  std::string_view source;  ///< standard and section
  std::string_view mend;    ///< what to do about it
};

namespace rule_book {

using enum Severity;
inline constexpr std::string_view names_table = "CF-1.8 section 3.3, CF Standard Name Table v83";
inline constexpr std::string_view uasdc_table = "WMO UAS-DC netCDF, table of variables (README of raw_uas_to_netCDF)";
inline constexpr std::string_view uasdc_globals = "WMO UAS-DC netCDF, global attributes (README of raw_uas_to_netCDF)";
inline constexpr std::string_view uasdc_name = "WMO UAS-DC netCDF, file name (README of raw_uas_to_netCDF)";

inline constexpr Rule rules[] = {
    {"netcdf.open", error, "netCDF-4 / netCDF classic format specification", "take the file again from its source"},
    {"netcdf.data", error, "netCDF-4 / netCDF classic format specification",
     "take the file again from its source, or write it again"},
    {"netcdf.not-looked-at", note, "limits of this check", "nothing to do"},

    {"cf.conventions", error, "CF-1.8 section 2.6.1", "write Conventions = \"CF-1.8\" (with what else it follows)"},
    {"cf.version", note, "CF-1.8 section 2.6.1", "the rules here are those of CF-1.8"},
    {"cf.description", note, "CF-1.8 section 2.6.2", "write them as global text attributes"},
    {"cf.type", error, "CF-1.8 section 2.2", "store it as byte, char, short, int, float, double or string"},
    {"cf.name", warning, "CF-1.8 section 2.3", "begin with a letter and use letters, digits and _ only"},
    {"cf.name-case", warning, "CF-1.8 section 2.3", "names should differ by more than their case"},
    {"cf.dimension-twice", error, "CF-1.8 section 2.4", "give the variable dimensions of different names"},
    {"cf.attribute-type", error, "CF-1.8 appendix A", "write the attribute as text"},
    {"cf.fill-type", error, "CF-1.8 section 2.5.1", "give the attribute the type of its variable"},
    {"cf.coordinate-fill", error, "CF-1.8 section 2.5.1 and appendix A",
     "take _FillValue and missing_value off: a coordinate has no missing values"},
    {"cf.coordinate-finite", error, "CF-1.8 section 2.5.1", "leave out what has no coordinate"},
    {"cf.monotonic", error, "CF-1.8 section 1.2 (coordinate variable)",
     "sort it, without repeats, or use an auxiliary coordinate"},
    {"cf.valid-range", warning, "CF-1.8 section 2.5.1", "widen the range, or mark the value as missing"},
    {"cf.units-missing", error, "CF-1.8 section 3.1", "write the attribute units"},
    {"cf.units-absent", warning, "CF-1.8 section 3.1", "write units, \"1\" for what has no dimension"},
    {"cf.units-parse", error, "CF-1.8 section 3.1", "write units as UDUNITS knows them"},
    {"cf.units-convert", error, names_table, "write units that convert to the canonical ones"},
    {"cf.described", warning, "CF-1.8 section 3.2", "write a long_name or a standard_name"},
    {"cf.standard-name", warning, names_table, "look it up in the table; it may be newer than this check"},
    {"cf.standard-name-spelling", error, names_table, "write the name of the table"},
    {"cf.standard-name-modifier", error, "CF-1.8 appendix C",
     "use detection_minimum, number_of_observations, standard_error or status_flag"},
    {"cf.ancillary-variables", error, "CF-1.8 section 3.4", "name variables of this file"},
    {"cf.flag-meanings", error, "CF-1.8 section 3.5", "give each flag one meaning, separated by blanks"},
    {"cf.flag-type", error, "CF-1.8 section 3.5", "store the flags in the type of the variable"},
    {"cf.flag-values", error, "CF-1.8 section 3.5", "give every flag another value; masks may not be zero"},
    {"cf.flag-data", warning, "CF-1.8 section 3.5", "write values that flag_values or flag_masks explain"},
    {"cf.axis", error, "CF-1.8 section 4", "axis is X, Y, Z or T"},
    {"cf.latitude", error, "CF-1.8 section 4.1", "write degrees_north, -90 to 90"},
    {"cf.longitude", error, "CF-1.8 section 4.2", "write degrees_east, -180 to 360"},
    {"cf.positive", error, "CF-1.8 section 4.3", "positive is up or down, and stands on vertical coordinates only"},
    {"cf.positive-missing", error, "CF-1.8 section 4.3", "write positive = \"up\" or \"down\""},
    {"cf.time-units", error, "CF-1.8 section 4.4", "write \"seconds since 1970-01-01T00:00:00Z\" or the like"},
    {"cf.calendar", error, "CF-1.8 section 4.4.1", "write calendar = \"standard\""},
    {"cf.coordinates", error, "CF-1.8 section 5", "name variables of this file"},
    {"cf.coordinates-dimensions", error, "CF-1.8 section 5",
     "a coordinate may have no dimension that its variable lacks"},
    {"cf.grid-mapping", error, "CF-1.8 section 5.6", "name a grid mapping variable of this file"},
    {"cf.grid-mapping-name", error, "CF-1.8 section 5.6 and appendix F", "write grid_mapping_name"},
    {"cf.crs-names", error, "CF-1.8 appendix F",
     "reference_ellipsoid_name, prime_meridian_name, horizontal_datum_name and geographic_crs_name go together"},
    {"cf.bounds", error, "CF-1.8 section 7.1", "name a variable of this file in bounds"},
    {"cf.bounds-shape", error, "CF-1.8 section 7.1", "give bounds the dimensions of the coordinate and one of 2"},
    {"cf.bounds-enclose", error, "CF-1.8 section 7.1", "make each cell hold its coordinate"},
    {"cf.bounds-contiguous", warning, "CF-1.8 section 7.1", "let each cell begin where the one before it ends"},
    {"cf.bounds-attributes", error, "CF-1.8 section 7.1", "bounds take their attributes from the coordinate"},
    {"cf.cell-methods", error, "CF-1.8 section 7.3", "write \"name: name: method (free text)\""},
    {"cf.cell-methods-name", error, "CF-1.8 section 7.3",
     "name dimensions, scalar coordinates, standard names or \"area\""},
    {"cf.cell-method", error, "CF-1.8 section 7.3 and appendix E", "use a method of appendix E"},
    {"cf.packing", error, "CF-1.8 section 8.1", "scale_factor and add_offset have one type, that of unpacked data"},
    {"cf.feature-type", error, "CF-1.8 section 9.4",
     "featureType is point, timeSeries, trajectory, profile, timeSeriesProfile or trajectoryProfile"},
    {"cf.feature-coordinates", error, "CF-1.8 section 9.2",
     "name time, latitude, longitude and the height in coordinates"},
    {"cf.cf-role", error, "CF-1.8 section 9.5", "cf_role is timeseries_id, profile_id or trajectory_id, each once"},
    {"cf.cf-role-feature", error, "CF-1.8 section 9.5", "give the identifiers that the featureType has"},
    {"cf.cf-role-missing", warning, "CF-1.8 section 9.5", "add a variable with that cf_role"},
    {"cf.feature-missing", error, "CF-1.8 section 9.6", "where a coordinate is missing all data must be"},

    {"acdd.highly-recommended", error, "ACDD-1.3, highly recommended", "write it as a global text attribute"},
    {"acdd.recommended", note, "ACDD-1.3, recommended", "tell them in a station file, where they are known"},
    {"acdd.content-type", error, "ACDD-1.3, variable attributes (ISO 19115-1 MD_CoverageContentTypeCode)",
     "use physicalMeasurement, qualityInformation, auxiliaryInformation, coordinate or the like"},
    {"acdd.content-type-missing", warning, "ACDD-1.3, variable attributes, recommended", "write coverage_content_type"},
    {"acdd.long-name", warning, "ACDD-1.3, variable attributes, highly recommended", "write a long_name"},
    {"acdd.date", error, "ACDD-1.3, recommended (ISO 8601)", "write dates as 2026-05-04T10:30:00Z"},
    {"acdd.duration", error, "ACDD-1.3, recommended (ISO 8601)", "write durations as PT2M30S"},
    {"acdd.extent", error, "ACDD-1.3, geospatial_*_min and _max",
     "write the smallest and the largest value of the coordinate"},
    {"acdd.time-coverage", error, "ACDD-1.3, time_coverage_start and _end",
     "write the first and the last instant of the data"},
    {"acdd.vertical-positive", error, "ACDD-1.3, geospatial_vertical_positive", "write up or down"},
    {"acdd.bounds", error, "ACDD-1.3, geospatial_bounds", "write well-known text: POINT, LINESTRING or POLYGON"},

    {"wind.speed", error, "CF Standard Name Table v83, wind_speed", "the speed is the length of the vector"},
    {"wind.direction", error, "CF Standard Name Table v83, wind_from_direction",
     "the direction is where the wind comes from, clockwise from north"},
    {"wind.direction-range", error, "CF Standard Name Table v83, wind_from_direction", "directions lie in 0 to 360"},
    {"wind.missing", error, "quadsonde's layout: wind_qc, n_obs", "no wind, n_obs 0 and wind_qc 9 go together"},
    {"wind.reason", warning, "quadsonde's layout: wind_qc_reasons", "say why there is no wind"},
    {"wind.provenance", warning, "quadsonde's layout: quadsonde_input_sha256", "take the file as quadsonde wrote it"},
    {"data.range", warning, "plausibility", "look at the units and at the sensor"},

    {"uasdc.file-name", error, uasdc_name, "name it UASDC_OOO_AAAAA_YYYYMMDDHHMMSSZ.nc"},
    {"uasdc.placeholder", error, uasdc_name, "put the operator id of the campaign and the airframe id of the operator"},
    {"uasdc.file-time", error, uasdc_name, "name it after its first observation"},
    {"uasdc.file-airframe", warning, uasdc_name, "let the name and platform_name agree"},
    {"uasdc.required", error, uasdc_table, "write it, all NaN where it was not measured"},
    {"uasdc.dimension", error, uasdc_table, "put every variable on the one dimension obs"},
    {"uasdc.type", error, uasdc_table, "store it as double"},
    {"uasdc.units", error, uasdc_table, "write the units of the table: converters do not convert"},
    {"uasdc.time-units", error, uasdc_table,
     "write exactly \"seconds since YYYY-MM-DDTHH:MM:SS\": the campaign's converter cuts it by columns"},
    {"uasdc.fill", error, uasdc_table, "write _FillValue = NaN"},
    {"uasdc.attributes", warning, uasdc_table, "write units, long_name and processing_level, each with a text"},
    {"uasdc.unknown-variable", note, uasdc_table, "converters leave it out"},
    {"uasdc.edr-units", note, uasdc_table, "UDUNITS cannot read them; the campaign writes them so"},
    {"uasdc.conventions", error, uasdc_globals, "write Conventions = \"CF-1.8, WMO-CF-1.0\""},
    {"uasdc.profile", error, uasdc_globals, "write wmo__cf_profile = \"FM 303-2024\""},
    {"uasdc.feature-type", error, uasdc_globals, "write featureType = \"trajectory\""},
    {"uasdc.platform-name", error, uasdc_globals, "write the airframe id: 1 to 5 letters and digits"},
    {"uasdc.flight-id", error, uasdc_globals, "write flight_id"},
    {"uasdc.terrain", error, uasdc_globals, "write site_terrain_elevation_height as \"480m\""},
    {"uasdc.processing-level", error, uasdc_globals, "write a1, b1 or c1"},
    {"uasdc.cf-role", note, "CF-1.8 section 9.5", "the campaign's layout has none"},

    {"bufr.start", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 0", "begin each message with BUFR"},
    {"bufr.between", note, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 0",
     "let messages follow each other, or wrap them in bulletins"},
    {"bufr.length", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 0, octets 5-7",
     "take the file again from its source: it is cut, or its length is wrong"},
    {"bufr.edition", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 0, octet 8", "write edition 4"},
    {"bufr.edition-old", warning, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 0, octet 8",
     "write edition 4: edition 3 has not been exchanged since 2012"},
    {"bufr.section-length", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, sections 1 to 4, octets 1-3",
     "the lengths of the sections make the length of the message"},
    {"bufr.end", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 5", "end each message with 7777"},
    {"bufr.master-table", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 1, octet 4", "write master table 0"},
    {"bufr.table-version", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 1, octet 14",
     "write a version that has the descriptors, 31 where libwreport must read it"},
    {"bufr.local-descriptor", warning, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 1, octet 15",
     "leave out local descriptors: nobody else can read them"},
    {"bufr.date", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 1, octets 16-22",
     "write the date and time of the observations"},
    {"bufr.subsets", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 3, octets 5-6", "a message has one or more"},
    {"bufr.descriptors", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 3", "give whole descriptors of F XX YYY"},
    {"bufr.decode", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, Tables B, C and D; section 4",
     "ask the writer: ecCodes cannot read it either"},
    {"bufr.station", warning, "WMO-No. 306 Vol. I.2, Table D 3 01 150; Table B 0 01 001, 0 01 008",
     "name the station: its WIGOS identifier, or the aircraft and its operator"},
    {"bufr.place", error, "WMO-No. 306 Vol. I.2, Table B 0 05 001, 0 06 001", "write latitude and longitude"},
    {"bufr.time", error, "WMO-No. 306 Vol. I.2, Table B 0 04 001 to 0 04 006", "write the time of the observation"},
    {"bufr.time-typical", warning, "WMO-No. 306 Vol. I.2, FM 94 BUFR, section 1, octets 16-22",
     "let section 1 tell the time of the observations"},
    {"bufr.direction", error, "WMO-No. 306 Vol. I.2, Table B 0 11 001", "directions are 0 to 360 degrees true"},
    {"bufr.calm", error, "WMO-No. 306 Vol. I.2, Table B 0 11 001 (north is 360, 0 is calm)",
     "write north as 360; calm is speed 0 and direction 0"},
    {"bufr.half-a-wind", warning, "WMO-No. 306 Vol. I.2, Table B 0 11 001, 0 11 002",
     "speed and direction are both there or both missing"},
    {"bufr.not-missing", error, "WMO-No. 306 Vol. I.2, FM 94 BUFR, regulation 94.1.5 (missing is all ones)",
     "write what is not known as missing; some encoders make a NaN the smallest value"},
    {"bufr.uncertainty", error, "WMO-No. 306 Vol. I.2, Table B 0 11 110 to 0 11 112", "an uncertainty is not negative"},
    {"bufr.heights", warning, "WMO-No. 306 Vol. I.2, Table D 3 09 021", "sort the levels, without repeats"},
    {"bufr.levels", warning, "WMO-No. 306 Vol. I.2, Table B 0 31 001", "write the levels, at most 254 in a message"},

    {"mcap.start", error, "MCAP specification, magic", "take the file again from its source"},
    {"mcap.end", error, "MCAP specification, magic", "`quadsonde convert --recover` writes what is whole"},
    {"mcap.record", error, "MCAP specification, records", "`quadsonde convert --recover` writes what is whole"},
    {"mcap.header", error, "MCAP specification, header (op=0x01)", "begin with one header"},
    {"mcap.schema", error, "MCAP specification, schema (op=0x03) and the registry of encodings",
     "write the schema as its encoding asks"},
    {"mcap.redefined", error, "MCAP specification, schema (op=0x03) and channel (op=0x04)",
     "give each id one meaning in the file"},
    {"mcap.channel-schema", error, "MCAP specification, channel (op=0x04)",
     "write the schema before the channel, or schema 0 for none"},
    {"mcap.encoding", note, "MCAP registry of message encodings", "viewers show it as bytes"},
    {"mcap.message-channel", error, "MCAP specification, message (op=0x05)", "write the channel before its messages"},
    {"mcap.message", error, "MCAP specification, message (op=0x05)", "write messages as their schema says"},
    {"mcap.order", note, "MCAP specification, message (op=0x05)", "readers sort by log time"},
    {"mcap.chunk", error, "MCAP specification, chunk (op=0x06)", "`quadsonde convert --recover` writes what is whole"},
    {"mcap.chunk-crc", error, "MCAP specification, chunk (op=0x06), uncompressed_crc",
     "`quadsonde convert --recover` writes what is whole"},
    {"mcap.chunk-index", error, "MCAP specification, chunk index (op=0x08)", "write the summary again"},
    {"mcap.attachment", error, "MCAP specification, attachment (op=0x09), crc", "attach the file again"},
    {"mcap.statistics", error, "MCAP specification, statistics (op=0x0B)", "write the summary again"},
    {"mcap.data-end", error, "MCAP specification, data end (op=0x0F)", "`quadsonde convert` writes it again"},
    {"mcap.footer", error, "MCAP specification, footer (op=0x02)", "`quadsonde convert` writes it again"},
    {"mcap.summary-crc", error, "MCAP specification, footer (op=0x02), summary_crc",
     "`quadsonde convert` writes it again"},
    {"mcap.no-summary", warning, "MCAP specification, summary section", "`quadsonde convert` writes one"},
};

}  // namespace rule_book

/// The rule of that name; a name that there is not does not compile.
consteval const Rule* rule(std::string_view id) {
  for (const auto& r : rule_book::rules)
    if (r.id == id) return &r;
  throw "no such rule";
}

inline std::span<const Rule> all_rules() { return rule_book::rules; }

}  // namespace quadsonde::product

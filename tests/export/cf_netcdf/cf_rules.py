"""Rules of CF-1.8 and ACDD-1.3 (formats notes, section 1.6) on a netCDF file of ours.

    cf_rules.py FILE...          one line per broken rule; exit code 1 when there is one
    cf_rules.py --bites FILE     breaks copies of FILE in many ways and wants each to be found
"""

import re
import shutil
import sys
import tempfile
from datetime import datetime, timezone

import netCDF4
import numpy

SECONDS = "seconds since 1970-01-01T00:00:00Z"
UNITS = {  # of every standard name that we write
    "time": SECONDS, "latitude": "degrees_north", "longitude": "degrees_east", "altitude": "m", "height": "m",
    "surface_altitude": "m", "geoid_height_above_reference_ellipsoid": "m", "eastward_wind": "m s-1",
    "northward_wind": "m s-1", "wind_speed": "m s-1", "wind_from_direction": "degree", "number_of_observations": "1",
    "aggregate_quality_flag": None, "status_flag": None, "air_pressure": "Pa", "air_temperature": "K", "relative_humidity": "percent",
    "barometric_altitude": "m",
}
OTHER_UNITS = {"m s-1", "m2 s-2", "1", "m", "s", "degrees_north", "degrees_east", SECONDS}
ROLES = {"profile": {"profile_id"}, "timeSeriesProfile": {"timeseries_id", "profile_id"}, "trajectory": {"trajectory_id"}}
METHOD = r"(mean|point|standard_deviation)"
CONTENT = {"physicalMeasurement", "qualityInformation", "auxiliaryInformation", "coordinate"}
NEEDED = ["title", "summary", "keywords", "id", "history", "source", "date_created", "processing_level", "standard_name_vocabulary",
          "geospatial_bounds", "time_coverage_start", "time_coverage_end", "quadsonde_input_sha256", "quadsonde_settings",
          "quadsonde_vehicle", "quadsonde_version"]


def plain(values):
    return numpy.ma.filled(values, numpy.nan) if numpy.ma.isMaskedArray(values) else numpy.asarray(values)


def attributes(variable):
    return {name: variable.getncattr(name) for name in variable.ncattrs()}


def rule_1_conventions(f):
    if [part.strip() for part in f.Conventions.split(",")] != ["CF-1.8", "ACDD-1.3"]:
        yield "Conventions"
    for name in NEEDED:
        if name not in f.ncattrs() or not f.getncattr(name):
            yield f"{name} is missing"


def rule_2_3_units_and_names(f):
    for name, v in f.variables.items():
        a = attributes(v)
        if v.dtype.kind == "S" or name in ("crs", "leg") or name.endswith("_bnds"):
            continue
        if "long_name" not in a or a.get("coverage_content_type") not in CONTENT:
            yield f"{name}: long_name or coverage_content_type"
        standard, _, modifier = a.get("standard_name", "").partition(" ")
        if not standard:
            if a.get("units") not in OTHER_UNITS:
                yield f"{name}: units {a.get('units')}"
        elif standard not in UNITS or modifier not in ("", "standard_error"):
            yield f"{name}: standard_name {a['standard_name']}"
        elif a.get("units") != UNITS[standard]:
            yield f"{name}: units {a.get('units')} of {standard}"


def rule_4_5_fill_and_axes(f):
    for name, v in f.variables.items():
        a = attributes(v)
        coordinate = v.dimensions == (name,) or "axis" in a
        if coordinate and ("_FillValue" in a or "missing_value" in a):
            yield f"{name}: a coordinate with _FillValue"
        if "_FillValue" in a and numpy.asarray(a["_FillValue"]).dtype != v.dtype:
            yield f"{name}: type of _FillValue"
        if v.dtype.kind == "f" and not coordinate and v.dimensions and not name.endswith("_bnds") and "_FillValue" not in a:
            yield f"{name}: no _FillValue"
        if coordinate and not numpy.isfinite(plain(v[...])).all():
            yield f"{name}: a coordinate that is not finite"
        if v.dimensions == (name,) and not (numpy.diff(plain(v[:])) > 0).all():
            yield f"{name}: not strictly monotonic"


def rule_6_bounds(f):
    for name, v in f.variables.items():
        bounds = f.variables.get(attributes(v).get("bounds", ""))
        if bounds is None:
            continue
        if bounds.shape != v.shape + (2,):
            yield f"{name}: shape of its bounds"
            continue
        values, edges = plain(v[:]), plain(bounds[:])
        if not ((edges[:, 0] <= values) & (values <= edges[:, 1])).all():
            yield f"{name}: outside its bounds"
        if name == "altitude" and not numpy.allclose(edges[1:, 0], edges[:-1, 1], atol=1e-6):
            yield f"{name}: its bins do not follow each other"
    if "altitude" in f.dimensions and not {"time_bnds", "altitude_bnds"} <= set(f.variables):
        yield "bounds are missing"


def rule_7_links(f):
    for name, v in f.variables.items():
        for attribute in ("coordinates", "ancillary_variables", "grid_mapping", "bounds"):
            for target in attributes(v).get(attribute, "").split():
                if target not in f.variables:
                    yield f"{name}: {attribute} names {target}"
        if v.dtype.kind == "f" and "grid_mapping" not in attributes(v) and attributes(v).get("coverage_content_type") in (
                "physicalMeasurement", "qualityInformation"):
            yield f"{name}: no grid_mapping"


def rule_8_flags(f):
    for name, v in f.variables.items():
        a = attributes(v)
        for kind in ("flag_values", "flag_masks"):
            if kind not in a:
                continue
            flags = numpy.asarray(a[kind])
            if flags.size != len(a.get("flag_meanings", "").split()) or flags.dtype != v.dtype:
                yield f"{name}: {kind}"
            if kind == "flag_values" and not numpy.isin(plain(v[...]), flags).all():
                yield f"{name}: a value that is no flag"
            if kind == "flag_masks" and (plain(v[...]) & ~numpy.bitwise_or.reduce(flags)).any():
                yield f"{name}: a bit that is no flag"


def rule_9_feature(f):
    roles = {attributes(v)["cf_role"] for v in f.variables.values() if "cf_role" in v.ncattrs()}
    if ROLES.get(f.featureType) != roles:
        yield f"featureType {f.featureType} with {sorted(roles)}"


def rule_10_11_methods(f):
    names = set(f.dimensions) | set(f.variables) | set(UNITS)
    for name, v in f.variables.items():
        a = attributes(v)
        methods = a.get("cell_methods")
        if methods is not None:
            found = re.fullmatch(rf"((?:\w+: )+){METHOD}( \([^():]+\))?", methods)
            if not found or not set(found.group(1).replace(":", "").split()) <= names:
                yield f"{name}: cell_methods {methods}"
        if "positive" in a and a.get("standard_name") not in ("altitude", "height"):
            yield f"{name}: positive"


def rule_12_wind(f):
    u, v, speed, direction = (plain(f[n][...]).astype(float) for n in
                              ("eastward_wind", "northward_wind", "wind_speed", "wind_from_direction"))
    known = numpy.isfinite(speed)
    if not (numpy.isfinite(u) == known).all() or not (numpy.isfinite(v) == known).all():
        yield "speed where there are no components, or the other way round"
    if not numpy.allclose(numpy.hypot(u, v)[known], speed[known], atol=1e-4):
        yield "speed is not that of the components"
    told = numpy.isfinite(direction)
    if not ((direction[told] > 0) & (direction[told] <= 360)).all():
        yield "direction outside 0 < d <= 360"
    turned = (numpy.degrees(numpy.arctan2(-u[told], -v[told])) - direction[told] + 180) % 360 - 180
    if (abs(turned) > 0.1).any():
        yield "direction is not that of the components"


def seconds(text):
    return datetime.fromisoformat(text.replace("Z", "+00:00")).astimezone(timezone.utc).timestamp()


def rule_13_extent(f):
    for short, name in (("lat", "lat"), ("lon", "lon"), ("vertical", "altitude")):
        values = plain(f[name][...])
        for end, of in (("min", numpy.min), ("max", numpy.max)):
            if abs(f.getncattr(f"geospatial_{short}_{end}") - of(values)) > 1e-9:
                yield f"geospatial_{short}_{end}"
    times = plain(f["time_bnds" if "time_bnds" in f.variables else "time"][...])
    if abs(seconds(f.time_coverage_start) - times.min()) > 2e-3 or abs(seconds(f.time_coverage_end) - times.max()) > 2e-3:
        yield "time_coverage"


def rule_14_missing(f):
    missing = ~numpy.isfinite(plain(f["eastward_wind"][...]))
    if ((plain(f["wind_qc"][...]) == 9) != missing).any():
        yield "wind_qc 9 and missing wind disagree"
    if "n_obs" in f.variables and ((plain(f["n_obs"][...]) == 0) != missing).any():
        yield "n_obs 0 and missing wind disagree"
    if (missing & (plain(f["wind_qc_reasons"][...]) == 0)).any():
        yield "a missing wind without a reason"


def rule_15_names(f):
    for name in [*f.variables, *f.dimensions, *f.ncattrs()]:
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
            yield f"name {name}"


RULES = [rule for name, rule in sorted(globals().items()) if name.startswith("rule_")]


def check(path):
    with netCDF4.Dataset(path) as f:
        f.set_auto_mask(False)
        return [f"{rule.__name__}: {complaint}" for rule in RULES for complaint in rule(f)]


def set_global(name, value):
    return lambda f: f.setncattr(name, value)


def set_attribute(variable, name, value):
    return lambda f: f[variable].setncattr(name, value)


def remove(variable, name):
    return lambda f: f[variable].delncattr(name)


def set_value(variable, index, value):
    def change(f):
        f.set_auto_mask(False)
        f[variable][index] = value
    return change


FAULTS = [  # of a profile
    ("rule_1", set_global("Conventions", "CF-1.8")), ("rule_1", set_global("quadsonde_input_sha256", "")),
    ("rule_2", set_attribute("wind_speed", "units", "knots")), ("rule_2", set_attribute("altitude", "units", "ft")),
    ("rule_2", set_attribute("wind_speed", "standard_name", "wind_spead")), ("rule_2", remove("wind_speed", "long_name")),
    ("rule_2", remove("wind_speed_se", "coverage_content_type")),
    ("rule_4", set_attribute("time", "missing_value", -1.0)), ("rule_4", set_value("altitude", 3, float("nan"))),
    ("rule_4", set_value("altitude", 3, 0.0)), ("rule_6", set_value("altitude_bnds", (2, 1), 9000.0)),
    ("rule_6", set_value("time", 0, 12.0)), ("rule_7", set_attribute("wind_speed", "ancillary_variables", "elsewhere")),
    ("rule_7", set_attribute("wind_speed", "coordinates", "lat lon heigth")), ("rule_7", remove("wind_speed", "grid_mapping")),
    ("rule_8", set_attribute("wind_qc", "flag_meanings", "good")), ("rule_8", set_value("wind_qc", (0, 0), 7)),
    ("rule_8", set_attribute("leg", "flag_values", numpy.array([0, 1, 2], "i4"))), ("rule_8", set_value("wind_qc_reasons", (0, 0), 1 << 30)),
    ("rule_9", set_global("featureType", "profile")), ("rule_9", remove("profile_id", "cf_role")),
    ("rule_10", set_attribute("wind_speed", "cell_methods", "altitude mean")),
    ("rule_10", set_attribute("wind_speed", "cell_methods", "somewhere: mean")),
    ("rule_10", set_attribute("lat", "positive", "up")), ("rule_12", set_value("wind_speed", (0, 0), 99.0)),
    ("rule_12", set_value("wind_from_direction", (0, 0), 0.0)), ("rule_12", set_value("eastward_wind", (0, 0), float("nan"))),
    ("rule_12", set_value("wind_from_direction", (0, 0), 77.0)), ("rule_13", set_global("geospatial_vertical_max", 1e4)),
    ("rule_13", set_global("time_coverage_end", "2001-01-01T00:00:00Z")), ("rule_14", set_value("n_obs", (0, 0), 0)),
    ("rule_14", set_value("wind_qc", (0, 0), 9)), ("rule_15", set_global("a-b", "x")),
]


def bites(path):
    missed = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (rule, change) in enumerate(FAULTS):
            copy = shutil.copy(path, f"{folder}/{number}.nc")
            with netCDF4.Dataset(copy, "a") as f:
                change(f)
            if not any(complaint.startswith(rule) for complaint in check(copy)):
                missed.append(f"fault {number} of {rule} was not found")
    return missed + ([] if not check(path) else ["the file itself breaks a rule"])


def main():
    if sys.argv[1] == "--bites":
        complaints = bites(sys.argv[2])
        print(f"{len(FAULTS)} faults, {len(complaints)} complaints")
    else:
        complaints = [f"{path}: {complaint}" for path in sys.argv[1:] for complaint in check(path)]
    print("\n".join(complaints))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())

"""Rules of the WMO UAS demonstration campaign (formats notes, section 2) on a netCDF file of ours.

    uasdc_rules.py FILE     one line per broken rule; exit code 1 when there is one
"""

import re
import sys

import netCDF4
import numpy

UNITS = {"time": "seconds since 1970-01-01T00:00:00", "lat": "degrees_north", "lon": "degrees_east", "altitude": "m",
         "air_temperature": "K", "humidity_mixing_ratio": "kg kg-1", "air_pressure": "Pa", "wind_speed": "m s-1",
         "wind_direction": "degree", "dew_point_temperature": "K", "relative_humidity": "%"}
OPTIONAL = {"dew_point_temperature", "relative_humidity"}


def complaints(path):
    if not re.search(r"(^|/)UASDC_\d{3}_[a-zA-Z0-9]{1,5}_\d{8}\d{6}Z\.nc$", path):
        yield "the name of the file"
    with netCDF4.Dataset(path) as f:
        f.set_auto_mask(False)
        for name, value in (("Conventions", "CF-1.8, WMO-CF-1.0"), ("wmo__cf_profile", "FM 303-2024"),
                            ("featureType", "trajectory"), ("platform_name", "QS001")):
            if getattr(f, name, None) != value:
                yield f"{name} is {getattr(f, name, None)}"
        for name in ("flight_id", "site_terrain_elevation_height", "processing_level"):
            if not getattr(f, name, ""):
                yield f"{name} is missing"
        if list(f.dimensions) != ["obs"] or not f.dimensions["obs"].isunlimited():
            yield f"dimensions {list(f.dimensions)}"
        if missing := set(UNITS) - OPTIONAL - set(f.variables):
            yield f"missing {sorted(missing)}"
        for name, v in f.variables.items():
            if v.dtype != numpy.float64 or v.dimensions != ("obs",) or not numpy.isnan(v.getncattr("_FillValue")):
                yield f"{name}: type, dimension or fill"
            if v.units != UNITS.get(name):
                yield f"{name}: units {v.units}"
            if not v.long_name or not v.processing_level:
                yield f"{name}: long_name or processing_level"
        time = f["time"][:]
        if not (numpy.diff(time) >= 0).all():
            yield "time does not grow"
        for name, low, high in (("time", 0, 4e9), ("lat", -90, 90), ("lon", -180, 180), ("altitude", -500, 20000)):
            if not ((f[name][:] >= low) & (f[name][:] <= high)).all():
                yield f"{name}: out of range, or missing"
        for name, low, high in (("wind_direction", 0, 360), ("wind_speed", 0, 150), ("air_temperature", 180, 330),
                                ("humidity_mixing_ratio", 0, 0.1), ("air_pressure", 10000, 110000)):
            values = f[name][:]
            if not (numpy.isnan(values) | ((values >= low) & (values <= high))).all():
                yield f"{name}: out of range"
        if ((f["wind_direction"][:] == 0) & (f["wind_speed"][:] > 0)).any():
            yield "north is not 360"


if __name__ == "__main__":
    found = list(complaints(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)

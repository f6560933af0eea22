"""Opens what quadsonde wrote with the programs that its users have, and compares it with the CSV of the same answer.

    read_back.py profile FILE.nc FILE.csv     xarray, netCDF4, NCO, CDO
    read_back.py wind FILE.nc FILE.csv        xarray, netCDF4, NCO (CDO refuses trajectories)
"""

import csv
import os
import subprocess
import sys
import tempfile

import netCDF4
import numpy
import xarray

# variable: (column, half of the last digit that the CSV prints)
WIND = {
    "eastward_wind": ("wind_east_m_s", 5e-5), "northward_wind": ("wind_north_m_s", 5e-5), "wind_speed": ("wind_speed_m_s", 5e-5),
    "wind_from_direction": ("wind_from_deg", 5e-3), "eastward_wind_se": ("sd_wind_east_m_s", 5e-5),
    "northward_wind_se": ("sd_wind_north_m_s", 5e-5), "wind_error_covariance": ("cov_wind_east_north_m2_s2", 5e-7),
}
BINS = {
    **WIND, "wind_speed_se": ("sd_wind_speed_m_s", 5e-5), "wind_from_direction_se": ("sd_wind_from_deg", 5e-3),
    "eastward_wind_sigma": ("sigma_east_m_s", 5e-5), "northward_wind_sigma": ("sigma_north_m_s", 5e-5),
    "effective_n_obs": ("effective_samples", 5e-3), "wind_sd_sampling": ("sd_sampling_m_s", 5e-5),
    "wind_sd_calibration": ("sd_calibration_m_s", 5e-5), "wind_sd_trim": ("sd_trim_m_s", 5e-5),
    "wind_sd_noise": ("sd_noise_m_s", 5e-5), "wind_sd_climb_law": ("sd_climb_law_m_s", 5e-5),
    "wind_from_direction_spread": ("spread_from_deg", 5e-3), "sample_lat": ("lat_deg", 5e-8), "sample_lon": ("lon_deg", 5e-8),
}
SOME = {  # where the flight or the method has them
    "vertical_resolution": ("resolution_m", 5e-3), "degrees_of_freedom": ("freedom", 5e-4), "air_pressure": ("air_pressure_pa", 0.5),
    "air_temperature": ("air_temperature_k", 5e-3), "relative_humidity": ("relative_humidity_pct", 5e-2),
    "barometric_altitude": ("barometric_altitude_m", 5e-3),
}
STEPS = {**WIND, "lat": ("lat_deg", 5e-8), "lon": ("lon_deg", 5e-8), "altitude": ("height_msl_m", 5e-3), "height": ("height_agl_m", 5e-3),
         "log_time": ("time_s", 1e-6)}
FLAGS = {1: "good", 3: "doubtful", 4: "bad", 9: "none"}
LEGS = ["up", "down", "all"]


def same(ours, printed, tolerance, what):
    if printed == "":
        assert numpy.isnan(ours), (what, ours)
    else:
        assert abs(float(ours) - float(printed)) <= tolerance + 1e-6 * abs(float(printed)), (what, ours, printed)


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def profile(path, rows):
    data = xarray.open_dataset(path)  # decodes times and fill values
    assert data.featureType == "timeSeriesProfile"
    some = {name: told for name, told in SOME.items() if name in data}
    assert set(some) == {name for name, (column, _) in SOME.items() if any(row[column] for row in rows)}
    seen, values = 0, {name: data[name].values for name in [*BINS, *some, "wind_qc", "n_obs", "height"]}
    for record in range(data.sizes["time"]):
        leg = LEGS[int(data.leg[record])]
        of_leg = [row for row in rows if row["leg"] == leg]
        assert len(of_leg) == data.sizes["altitude"], leg
        assert str(data.profile_id[record].values.astype(str)).endswith("-" + leg)
        low, mid, high = (float(t) for t in (data.time_bnds[record, 0].astype("int64"), data.time[record].astype("int64"),
                                             data.time_bnds[record, 1].astype("int64")))
        assert low <= mid <= high and abs(low + high - 2 * mid) < 1e4, (low, mid, high)
        for level, row in enumerate(of_leg):
            for name, (column, tolerance) in {**BINS, **some}.items():
                same(values[name][record, level], row[column], tolerance, (leg, level, name))
            assert FLAGS[int(values["wind_qc"][record, level])] == row["quality"]
            assert int(values["n_obs"][record, level]) == int(row["samples"])
            middle = (float(row["bin_bottom_m"]) + float(row["bin_top_m"])) / 2
            assert abs(values["height"][record, level] - middle) < 0.01
            assert abs(float(data.altitude[level]) - float(data.surface_altitude) - middle) < 0.01
            seen += 1
    assert seen and data.sizes["time"] in (1, 2)
    return data


def wind(path, rows):
    data = xarray.open_dataset(path)
    assert data.featureType == "trajectory" and data.sizes["obs"] == len(rows)
    values = {name: data[name].values for name in [*STEPS, "wind_qc", "time"]}
    for index, row in enumerate(rows):
        for name, (column, tolerance) in STEPS.items():
            same(values[name][index], row[column], tolerance, (index, name))
        assert FLAGS[int(values["wind_qc"][index])] == row["quality"]
        assert abs(values["time"][index] - numpy.datetime64(row["utc"].rstrip("Z"))) < numpy.timedelta64(1, "ms")
    return data


def nco(path, kind, data):
    """ncks cuts, ncra averages over the record dimension; both keep what a later reader needs."""
    with tempfile.TemporaryDirectory() as folder:
        cut, mean = os.path.join(folder, "cut.nc"), os.path.join(folder, "mean.nc")
        record = "time" if kind == "profile" else "obs"
        run("ncks", "-d", f"{record},0", path, cut)
        with xarray.open_dataset(cut) as first:
            numpy.testing.assert_array_equal(first.eastward_wind.values, data.eastward_wind.isel({record: [0]}).values)
        run("ncra", "-v", "eastward_wind", path, mean)
        with xarray.open_dataset(mean) as average:
            # NCO averages a missing value that is NaN like a number (its manual, "Missing values"): NaN, never a wrong mean.
            expected = data.eastward_wind.mean(record, skipna=False).values
            numpy.testing.assert_allclose(average.eastward_wind.values[0], expected, atol=1e-5)


def cdo(path, data):
    levels = [float(text) for text in run("cdo", "-s", "showlevel", "-selname,eastward_wind", path).split()]
    numpy.testing.assert_allclose(levels, data.altitude.values, rtol=1e-5)
    assert int(run("cdo", "-s", "ntime", path).split()[0]) == data.sizes["time"]
    stamps = run("cdo", "-s", "showtimestamp", path).split()
    for text, ours in zip(stamps, data.time.values):
        assert abs(numpy.datetime64(text) - ours) <= numpy.timedelta64(1, "s"), (text, ours)
    values = [float(text) for text in run("cdo", "-s", "output", "-selname,eastward_wind", path).split()]
    expected = data.eastward_wind.values.ravel()
    assert len(values) == expected.size
    for ours, theirs in zip(expected, values):
        assert abs(ours - theirs) < 1e-4 or numpy.isnan(ours), (ours, theirs)


def main():
    kind, path, table = sys.argv[1:]
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    data = {"profile": profile, "wind": wind}[kind](path, rows)
    with netCDF4.Dataset(path) as raw:
        assert raw.data_model == "NETCDF4" and raw["eastward_wind"].filters()["zlib"] and raw["eastward_wind"].filters()["shuffle"]
        assert raw.dimensions["time" if kind == "profile" else "obs"].isunlimited()
    nco(path, kind, data)
    if kind == "profile":
        cdo(path, data)


if __name__ == "__main__":
    main()

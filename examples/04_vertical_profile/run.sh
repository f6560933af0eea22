#!/bin/bash
# The published vertical profile, simulated: up at 1 m/s and down again with the nose turning at a constant rate.
#
#   examples/04_vertical_profile/run.sh
#
#   QUADSONDE_BIN   the built program; default build/dev/cli/quadsonde
#   QUADSONDE_OUT   where the results go; default out/04_vertical_profile
#
# One sees the wind grow and veer with height, ascent and descent apart where the gusts of their minutes were, the truth
# of both between them. The published filter follows late (24 m in the gates' ascent), so that it shows the wind of below
# on the way up and of above on the way down, and it smooths the gusts away that ours follows.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
here=examples/04_vertical_profile
out=${QUADSONDE_OUT:-out/04_vertical_profile}
source examples/paper_flight.sh

mkdir -p "$out"
fly examples/scenarios/vertical_profile.toml
tables_and_pictures
# The whole job as well: the profile, its picture and netCDF, the report.
quadsonde run "$log" --vehicle "$vehicle" --reference "$out/truth.csv" -o "$out" --force

echo
echo "Error against the true wind, m/s                        found  expected"
claim smoothed "$(error smoothed.csv 60 230 rms)"
claim causal "$(error causal.csv 60 230 rms)"
claim classic "$(error classic.csv 60 230 rms)"
echo
finish wind.svg wind_causal.svg state.svg vertical_profile/profile.svg vertical_profile/profile.nc vertical_profile/wind.nc vertical_profile/report.html

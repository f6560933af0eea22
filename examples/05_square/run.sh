#!/bin/bash
# The published square, simulated, the nose turning independently of the track.
#
#   examples/05_square/run.sh
#
#   QUADSONDE_BIN   the built program; default build/dev/cli/quadsonde
#   QUADSONDE_OUT   where the results go; default out/05_square
#
# One sees the airspeed jump at every corner while the wind goes on without a trace of it: what the vehicle does itself
# does not show in it. Ours follows the gusts of ten seconds; the published filter, as calm at the corners, takes a
# minute from its start to the wind and is late for every gust.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
here=examples/05_square
out=${QUADSONDE_OUT:-out/05_square}
source examples/paper_flight.sh

mkdir -p "$out"
fly examples/scenarios/square.toml
tables_and_pictures

echo "Error against the true wind, m/s                        found  expected"
claim smoothed "$(error smoothed.csv 60 300 rms)"
claim causal "$(error causal.csv 60 300 rms)"
claim classic "$(error classic.csv 60 300 rms)"
echo
finish wind.svg wind_causal.svg state.svg smoothed.csv causal.csv classic.csv

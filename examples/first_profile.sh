#!/bin/bash
# From nothing to a first wind profile: installs what is missing, builds, flies a simulated ascent and descent through
# a wind that is known, and lets quadsonde find that wind from the log of the flight.
#
#   examples/first_profile.sh
#
# Two settings, for those who have built already (a test does so):
#   QUADSONDE_BIN   the built program: nothing is installed or built
#   QUADSONDE_OUT   where the results go; default out/first_profile
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bin=${QUADSONDE_BIN:-}
out=${QUADSONDE_OUT:-out/first_profile}
scenario=examples/scenarios/ascent.toml

if [ -z "$bin" ]; then
  bash setup.sh build
  if ! said=$(cmake --preset dev 2>&1); then
    echo "$said" >&2
    exit 1
  fi
  cmake --build --preset dev --target quadsonde -- -j"$(nproc)"
  bin=build/dev/cli/quadsonde
fi

# The flight: its log, and apart from it the wind that was really there. Flown once per program and scenario.
mkdir -p "$out"
log=$out/ascent.mcap
if [ ! "$log" -nt "$bin" ] || [ ! "$log" -nt "$scenario" ] || [ ! -s "$out/ascent_truth.csv" ]; then
  "$bin" simulate "$scenario" -o "$log" --truth "$out/ascent_truth.csv" --force
fi

# The whole job on the log alone; the truth is what the answer is compared with, as a sounding would be.
status=0
"$bin" run "$log" --vehicle examples/vehicles/published.toml --reference "$out/ascent_truth.csv" -o "$out" --force || status=$?
# 3: there is an answer, and part of the input was missing or doubtful, which has been said.
if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then exit "$status"; fi

for file in profile.csv profile.svg wind.csv; do
  if [ ! -s "$out/ascent/$file" ]; then
    echo "first_profile.sh: $out/ascent/$file is not there" >&2
    exit 1
  fi
done
echo
echo "The profile:       $out/ascent/profile.csv"
echo "Its picture:       $out/ascent/profile.svg"
echo "Wind of the way:   $out/ascent/wind.csv"
if [ -s "$out/ascent/compare.json" ]; then echo "Against the truth: $out/ascent/compare.json, the figures are above"; fi

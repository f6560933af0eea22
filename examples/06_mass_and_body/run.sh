#!/usr/bin/env bash
# What mass, air, propellers and body do to the drag: the table of expected.txt and its picture.
#   QUADSONDE_STUDY  the program      QUADSONDE_OUT  where to write
# `bash run.sh 10` flies it too, ten seeds: a minute.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
out=${QUADSONDE_OUT:-mass_and_body}
mkdir -p "$out"
"${QUADSONDE_STUDY:-example_mass_and_body}" "$out/drag_against_mass.svg" "$@" | tee "$out/table.txt"
[ $# -gt 0 ] || diff -u "$here/expected.txt" "$out/table.txt"
grep -q '</svg>' "$out/drag_against_mass.svg"

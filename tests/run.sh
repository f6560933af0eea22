#!/bin/bash
# Installs what is needed, builds and runs every test but the benchmarks.
# Real logs come from QUADSONDE_DATA (default: ../shared/data); a test that misses one is skipped and named at the end.
# Arguments go to ctest: tests/run.sh -R ulog
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ -z "${QUADSONDE_DATA:-}" ] && [ -d ../shared/data ]; then
  QUADSONDE_DATA=$(cd ../shared/data && pwd)
fi
if [ -n "${QUADSONDE_DATA:-}" ]; then export QUADSONDE_DATA; fi

bash setup.sh build test
# Configured every time, which takes a second: a new folder must not go untested.
if ! said=$(cmake --preset dev 2>&1); then
  echo "$said" >&2
  exit 1
fi
cmake --build --preset dev -- -j"$(nproc)"

results=build/dev/tests.xml
rm -f "$results"
status=0
ctest --preset dev --label-exclude bench --output-junit "$PWD/$results" "$@" || status=$?
if [ ! -f "$results" ]; then
  echo "tests/run.sh: ctest wrote no results" >&2
  exit 1
fi
/usr/bin/python3 tests/summary.py "$results" || status=$?
exit "$status"

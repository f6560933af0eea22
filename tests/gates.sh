#!/bin/bash
# The accuracy gates with all their seeds, each value beside its limit and beside the classic filter's.
# The reduced form runs with the other tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bash setup.sh build test
cmake --preset dev > /dev/null
cmake --build --preset dev --target gates calibration_gates profile_study -- -j"$(nproc)" > /dev/null
status=0
build/dev/tests/gates/gates "$@" || status=1
build/dev/tests/gates/calibration_gates "$@" || status=1
build/dev/tests/gates/profile_study || status=1
exit $status

#!/bin/bash
# Installs what is missing of the Debian packages that quadsonde needs:
#   ./setup.sh          to build      packages/build.txt
#   ./setup.sh test     and to test   packages/test.txt
#   ./setup.sh jobs     and for fuzzing, lint and the browser   packages/jobs.txt
# Does nothing, at once, when nothing is missing. Without root it prints the one line to run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

lists=(build)
for list in "$@"; do
  if [ ! -f "packages/$list.txt" ]; then
    echo "setup.sh: there is no packages/$list.txt; the lists are build, test and jobs" >&2
    exit 2
  fi
  if [ "$list" != build ]; then lists+=("$list"); fi
done

wanted=()
for list in "${lists[@]}"; do
  while read -r name _; do
    if [[ -n "$name" && "$name" != \#* ]]; then wanted+=("$name"); fi
  done < "packages/$list.txt"
done

if ! command -v dpkg-query > /dev/null; then
  echo "setup.sh: this is not a Debian machine; install what corresponds to: ${wanted[*]}" >&2
  exit 1
fi
# dpkg-query fails when it knows one of them not at all; what it prints is all the same the state of the others.
installed=$(dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' "${wanted[@]}" 2> /dev/null || true)
missing=()
for name in "${wanted[@]}"; do
  if [[ $'\n'"$installed"$'\n' != *$'\n'"installed $name"$'\n'* ]]; then missing+=("$name"); fi
done
if [ "${#missing[@]}" -eq 0 ]; then exit 0; fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if command -v sudo > /dev/null && sudo -n true 2> /dev/null; then
    as_root=(sudo -n)
  else
    echo "setup.sh: needs root to install packages. Run this, then try again:" >&2
    echo "sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}"
    exit 1
  fi
fi

echo "setup.sh: installing ${missing[*]}" >&2
log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 \
    -o Dpkg::Use-Pty=0 "$@" >> "$log" 2>&1 < /dev/null
}
# A source that does not answer need not be one of ours: the installation decides.
apt update || echo "setup.sh: apt-get update met an error; going on with the lists that are there" >&2
if ! apt install -y --no-install-recommends "${missing[@]}"; then
  cat "$log" >&2
  echo "setup.sh: apt-get could not install the packages (its own words above)" >&2
  exit 1
fi

#!/usr/bin/env bash
# Runs obliqd for as long as it is given, with clients that behave and others that do not, and looks whether memory,
# descriptors and latency stay what they are. Outside tests/run.sh, because it takes long.
#
#   tests/soak.sh HOURS [--out DIR]      HOURS may be a part of one (0.05); DIR: default build/soak
#
# Writes DIR/soak.csv (a line every few seconds), DIR/soak.png (the picture), DIR/verdict.txt and the logs of all
# programs. Fails when memory grows by more than 4 MB and 1 MB an hour after the warm-up, when descriptors or threads are
# left over, when a client that behaves loses a frame it was promised, or when any of them dies.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"
cd "$root"

usage() {
  sed -n '2,9s/^# \{0,1\}//p' tests/soak.sh
}
hours=${1-}
if [ "$hours" = --help ] || [ "$hours" = -h ]; then
  usage
  exit 0
fi
if [[ ! "$hours" =~ ^[0-9]+(\.[0-9]+)?$ ]]; then
  usage >&2
  exit 2
fi
shift
out=build/soak
if [ "${1-}" = --out ] && [ -n "${2-}" ]; then
  out=$2
  shift 2
fi
if [ $# -ne 0 ]; then
  echo "soak.sh: found '$1'; allowed: HOURS [--out DIR]" >&2
  exit 2
fi

step "build"
deploy/install-deps.sh build test
[ -f build/release/CMakeCache.txt ] || cmake --preset release -DOBLIQ_TESTS=ON
cmake --build build/release --parallel "$(parallel_jobs)" --target obliq obliqd soak_fly

step "soak, $hours h"
status=0
python3 tests/soak/soak.py --bin build/release/bin --hours "$hours" --out "$out" || status=$?
step "picture"
if python=$(python_with matplotlib); then "$python" deploy/plots/soak.py "$out/soak.csv" "$out/soak.png"; fi
step_end
cat "$out/verdict.txt"
exit "$status"

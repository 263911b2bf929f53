#!/usr/bin/env bash
# Installs what the tests need, builds, runs every test. The last line is ctest's own summary.
#
#   tests/run.sh            everything (15 to 30 minutes on two cores, by how fast and busy they are)
#   tests/run.sh --quick    without the tests labelled slow (two thirds of that)
#
# OBLIQ_SHARED=DIR points at extra elevation models; tests that need them are skipped without.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"

select_tests=()
case "${1-}" in
  "") ;;
  --quick) select_tests=(--label-exclude slow) ;;
  -h | --help)
    sed -n '2,7s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
  *)
    echo "run.sh: unknown option '$1'; allowed: --quick" >&2
    exit 2
    ;;
esac

cd "$root"
jobs=$(parallel_jobs)

step "packages"
deploy/install-deps.sh build test package
step "configure"
cmake --preset release -DOBLIQ_TESTS=ON
step "build with $jobs jobs"
cmake --build --preset release --parallel "$jobs"
step "test"
log=build/release/tests.log
status=0
ctest --test-dir build/release --parallel "$(($(nproc) + 2))" --timeout 600 --output-on-failure --no-tests=error \
  --output-junit "$root/build/release/tests.xml" --test-output-size-passed 1000000 "${select_tests[@]}" 2>&1 </dev/null | tee "$log" || status=$?
step_end
python3 tests/skipped.py build/release/tests.xml || true
python3 tests/figures/figures.py --age || true # a word, never a failure

# ctest prints timings and the names of skipped tests after its summary; repeat it where it is looked for.
grep -E '^[0-9]+% tests passed' "$log" | tail -n 1 || status=1
exit "$status"

#!/usr/bin/env bash
# Builds and runs the tests under the sanitizers. Outside tests/run.sh, because it takes long.
#
#   tests/sanitize.sh            address + undefined behaviour, then threads
#   tests/sanitize.sh asan       one of them
#   tests/sanitize.sh tsan
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"
cd "$root"

# GDAL, GEOS and PROJ keep caches until exit, which are not our leaks. TBB, inside Embree, is not built for the
# thread sanitizer, so only faults with one of our own frames on both sides count.
export ASAN_OPTIONS=detect_leaks=0:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS="suppressions=$root/tests/tsan.supp:ignore_noninstrumented_modules=1:halt_on_error=1:allocator_may_return_null=1"

[ $# -gt 0 ] || set -- asan tsan
deploy/install-deps.sh build test
for preset in "$@"; do
  case "$preset" in asan | tsan) ;; *)
    echo "sanitize.sh: unknown sanitizer '$preset'; allowed: asan, tsan" >&2
    exit 2
    ;;
  esac
  step "$preset"
  cmake --preset "$preset" -DOBLIQ_TESTS=ON -DOBLIQ_BENCHMARKS=OFF
  cmake --build --preset "$preset" --parallel "$(parallel_jobs)"
  # The checks of the sources have nothing to sanitize.
  ctest --test-dir "build/$preset" --parallel "$(nproc)" --timeout 1200 --output-on-failure --no-tests=error \
    --label-exclude slow --exclude-regex '^checks\.' </dev/null
done
step_end

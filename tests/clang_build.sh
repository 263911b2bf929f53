#!/usr/bin/env bash
# Builds everything with clang, warnings as errors, and runs the quick tests: GCC and clang must both accept it.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"
cd "$root"

deploy/install-deps.sh build test
cmake --preset clang -DOBLIQ_TESTS=ON -DOBLIQ_BENCHMARKS=ON
cmake --build --preset clang --parallel "$(parallel_jobs)"
ctest --test-dir build/clang --parallel "$(nproc)" --timeout 600 --output-on-failure --no-tests=error \
  --label-exclude slow </dev/null

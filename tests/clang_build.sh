#!/usr/bin/env bash
# Compiles everything with clang, warnings as errors: GCC and clang must both accept it. The fuzz targets and all that they link are
# built, the other sources only read, which takes a third of the time. Each fuzz target runs for ten seconds. Where build/release has a
# daemon, the client library is built without the server and meets it.
#
#   tests/clang_build.sh
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"
cd "$root"

tests/fuzz.sh 10s
step "the other sources"
deploy/install-deps.sh build test
cmake --preset clang -DOBLIQ_TESTS=ON -DOBLIQ_BENCHMARKS=ON
# What the sources include and the build makes.
cmake --build --preset clang --target proto/obliq.pb.h server/http/page_bytes.cpp write_version
tests/syntax_only.py build/clang --but-for build/fuzz --jobs "$(parallel_jobs)"
if [ -x build/release/bin/obliqd ]; then
  step "a client library without the server"
  tests/consumer.sh --compiler clang++
fi
step_end

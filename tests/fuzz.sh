#!/usr/bin/env bash
# Fuzzes with clang's libFuzzer, address and undefined behaviour sanitizers. Outside tests/run.sh, because it takes
# as long as it is given.
#
#   tests/fuzz.sh MINUTES [TARGET...]     each target for so long, one after the other; without names: all
#   tests/fuzz.sh SECONDSs [TARGET...]    tests/fuzz.sh 10s
#
# Fails on a crash, a leak, an input that takes more than 10 s or more than 2 GB, and prints the file with the input that
# did it. What is found on the way is kept in build/fuzz/found/TARGET and used by the next run.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"
cd "$root"

# Bytes of an input at most: what a target can make use of, so that none spends its time on length.
declare -A most_bytes=([framing]=8192 [requests]=4096 [configuration]=4096 [recording]=16384 [modbus]=2048
  [websocket]=4096 [transport]=2048 [ownship]=256 [pattern]=4096 [elevation]=32768 [footprints]=32768)
targets=(transport framing requests configuration recording modbus websocket ownship pattern elevation footprints)
if [[ ! "${1-}" =~ ^([1-9][0-9]*)(s?)$ ]]; then
  sed -n '2,10s/^# \{0,1\}//p' "$0"
  [ "${1-}" = --help ] || [ "${1-}" = -h ]
  exit
fi
seconds=${BASH_REMATCH[1]}
# Runs of seconds are the same ones each time, as far as they come; those of minutes look elsewhere each time.
seed=(-seed=27)
[ -n "${BASH_REMATCH[2]}" ] || { seconds=$((60 * seconds)) && seed=(); }
shift
for name in "$@"; do
  [[ " ${targets[*]} " == *" $name "* ]] || {
    echo "fuzz.sh: unknown target '$name'; allowed: ${targets[*]}" >&2
    exit 2
  }
done
[ $# -eq 0 ] || targets=("$@")

step "build"
deploy/install-deps.sh build fuzz
cmake --preset fuzz
cmake --build --preset fuzz --parallel "$(parallel_jobs)" --target "${targets[@]/#/fuzz_}"

export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1:strict_string_checks=1
export LSAN_OPTIONS=suppressions=$root/tests/fuzz/lsan.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
summary=()
failed=0
for name in "${targets[@]}"; do
  step "$name, $seconds s"
  found=build/fuzz/found/$name
  artefacts=build/fuzz/artefacts/$name
  log=build/fuzz/$name.log
  mkdir -p "$found" "$artefacts"
  status=0
  build/fuzz/bin/"fuzz_$name" -max_total_time="$seconds" "${seed[@]}" -timeout=10 -rss_limit_mb=2048 -max_len="${most_bytes[$name]}" \
    -artifact_prefix="$artefacts/" -print_final_stats=1 "$found" "tests/fuzz/corpus/$name" >"$log" 2>&1 </dev/null ||
    status=$?
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -n 1)
  cover=$(grep -oE 'cov: [0-9]+ ft: [0-9]+' "$log" | tail -n 1 || true)
  line="$name: ${runs:-?} runs, ${cover:-no coverage}"
  if [ "$status" -ne 0 ]; then
    failed=1
    artefact=$(grep -oE "$artefacts/[a-z]+-[0-9a-f]+" "$log" | tail -n 1 || true)
    line+=", FAILED: ${artefact:-no input was written} (log: $log)"
    grep -E 'ERROR|SUMMARY|runtime error|broken:' "$log" | head -n 5 || true
  fi
  echo "$line"
  summary+=("$line")
done
step_end
printf '\n'
printf '%s\n' "${summary[@]}"
exit "$failed"

#!/usr/bin/env bash
# Every shell script parses and can be executed or sourced; every Python file compiles.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tests/checks/source_files.sh

status=0
mapfile -t shell < <(source_files sh)
for script in .ci/run "${shell[@]}"; do
  bash -n "$script" || status=1
  if head -n 1 "$script" | grep -q '^#!' && [ ! -x "$script" ]; then
    echo "$script: has a #! line but is not executable"
    status=1
  fi
done
mapfile -t python < <(source_files py)
for script in "${python[@]}"; do
  python3 -c 'import sys; compile(open(sys.argv[1], encoding="utf-8").read(), sys.argv[1], "exec")' "$script" ||
    status=1
done
exit "$status"

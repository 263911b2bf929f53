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
python3 - "${python[@]}" <<'END' || status=1
import sys

faults = []
for script in sys.argv[1:]:
    try:
        compile(open(script, encoding="utf-8").read(), script, "exec")
    except SyntaxError as fault:
        faults.append(f"{script}:{fault.lineno}: {fault.msg}")
sys.exit("\n".join(faults) or None)
END
exit "$status"

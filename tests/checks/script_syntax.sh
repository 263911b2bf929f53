#!/usr/bin/env bash
# Every shell script parses and can be executed or sourced; every Python file compiles. A Python file with a #! line can be
# executed, and takes Debian's Python if it needs packages: that is where deploy/install-deps.sh puts them. Examples for users
# take the users' own.
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
source_files py | python3 -c '
import ast, os, sys

PACKAGES = {"google", "matplotlib", "numpy", "obliq", "obliq_pb2", "support"}
faults = 0

def fault(text):
    global faults
    faults += 1
    print(text)

for name in sys.stdin.read().split("\n")[:-1]:
    with open(name, encoding="utf-8") as file:
        text = file.read()
    try:
        tree = ast.parse(text, name)
    except SyntaxError as error:
        fault(f"{name}: {error}")
        continue
    if not text.startswith("#!"):
        continue
    if not os.access(name, os.X_OK):
        fault(f"{name}: has a #! line but is not executable")
    used = {alias.name.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    used |= {node.module.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module and not node.level}
    allowed = "#!/usr/bin/python3" if used & PACKAGES and not name.startswith("./client/examples/") else "#!/usr/bin/env python3"
    found = text.split("\n", 1)[0]
    if found != allowed:
        fault(f"{name}: found \"{found}\"; allowed: \"{allowed}\"")
sys.exit(faults > 0)
' || status=1
exit "$status"

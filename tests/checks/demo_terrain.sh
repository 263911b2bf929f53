#!/usr/bin/env bash
# deploy/fetch-demo-terrain.sh without any network: a registry that has nothing, a registry that hands out
# something else under the right name, a cache that is good and one that is damaged.
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! python3 -m pip --version >/dev/null 2>&1 && ! /usr/bin/python3 -m pip --version >/dev/null 2>&1; then
  echo "skipped: no pip here"
  exit 77
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/registry"
export OBLIQ_CACHE="$scratch/cache" PIP_NO_INDEX=1 PIP_FIND_LINKS="$scratch/registry" PIP_CONFIG_FILE=/dev/null

failures=0
expect() { # expect EXIT_CODE WORDS WHAT
  local status=0
  deploy/fetch-demo-terrain.sh >"$scratch/out" 2>"$scratch/err" || status=$?
  if [ "$status" -ne "$1" ] || ! grep -qF -- "$2" "$scratch/out" "$scratch/err"; then
    echo "FAILED: $3: expected exit code $1 and \"$2\", found $status and:"
    cat "$scratch/out" "$scratch/err"
    failures=$((failures + 1))
  fi
  if compgen -G "$OBLIQ_CACHE/.fetch.*" >/dev/null; then
    echo "FAILED: $3: scratch files were left in the cache"
    failures=$((failures + 1))
  fi
}

expect 3 "no package registry" "an empty registry"

python3 - "$scratch/registry/tinerator-0.9.1-py2.py3-none-any.whl" <<'PYTHON'
import sys, zipfile
with zipfile.ZipFile(sys.argv[1], "w") as wheel:
    info = "tinerator-0.9.1.dist-info/"
    wheel.writestr(info + "METADATA", "Metadata-Version: 2.1\nName: tinerator\nVersion: 0.9.1\n")
    wheel.writestr(info + "WHEEL", "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py2-none-any\nTag: py3-none-any\n")
    wheel.writestr(info + "RECORD", "")
PYTHON
expect 1 "not the expected file" "another file under the right name"

status=0
deploy/fetch-demo-terrain.sh hills >"$scratch/out" 2>"$scratch/err" || status=$?
[ "$status" -eq 2 ] && grep -q "\[--link\] mountains" "$scratch/err" || {
  echo "FAILED: an unknown model: exit code $status"
  failures=$((failures + 1))
}

rm "$scratch"/registry/*
echo "heights" >"$OBLIQ_CACHE/new_mexico_ned13.tif"
(cd "$OBLIQ_CACHE" && sha256sum new_mexico_ned13.tif >new_mexico_ned13.tif.sha256)
expect 0 "$OBLIQ_CACHE/new_mexico_ned13.tif" "a good cache"

echo "damage" >>"$OBLIQ_CACHE/new_mexico_ned13.tif"
expect 3 "no package registry" "a damaged cache"

touch "$scratch/file"
OBLIQ_CACHE="$scratch/file/cache" expect 1 "cannot write" "a cache that cannot be made"
[ "$failures" -eq 0 ]

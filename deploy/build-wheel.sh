#!/usr/bin/env bash
# Builds the Python package: out/wheel/obliq-VERSION-py3-none-any.whl, the same bytes for the same sources.
#
#   deploy/build-wheel.sh [--out DIR]
#
# Needs Python 3.10 or later with pip; the build tool (hatchling) comes from the package registry unless it is installed.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

out=out/wheel
case "${1:-}" in
  --out) out=${2:?--out needs a folder} ;;
  "") ;;
  *) usage "$1" ;;
esac
python=${PYTHON:-python3}
isolation=()
"$python" -c 'import hatchling' 2>/dev/null && isolation=(--no-build-isolation)
mkdir -p "$out"
set_source_date # of files in the wheel, for hatchling
PIP_DISABLE_PIP_VERSION_CHECK=1 "$python" -m pip wheel --quiet --no-deps "${isolation[@]}" --wheel-dir "$out" client/python
ls "$out"/obliq-*-py3-none-any.whl

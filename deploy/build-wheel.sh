#!/usr/bin/env bash
# Builds the Python package: out/wheel/obliq-VERSION-py3-none-any.whl, the same bytes for the same sources.
#
#   deploy/build-wheel.sh [--out DIR]
#
# Needs Python 3.10 or later with pip; the build tool (hatchling) comes from the package registry unless it is installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=out/wheel
case "${1:-}" in
  --out) out=${2:?--out needs a folder} ;;
  "") ;;
  *)
    sed -n '2,6s/^# \{0,1\}//p' deploy/build-wheel.sh
    [ "$1" = --help ] || [ "$1" = -h ] || exit 2
    exit 0
    ;;
esac
python=${PYTHON:-python3}
isolation=()
"$python" -c 'import hatchling' 2>/dev/null && isolation=(--no-build-isolation)
mkdir -p "$out"
# hatchling takes files' times from here, so that two builds are equal.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || echo 1577836800)}
export SOURCE_DATE_EPOCH
PIP_DISABLE_PIP_VERSION_CHECK=1 "$python" -m pip wheel --quiet --no-deps "${isolation[@]}" --wheel-dir "$out" client/python
ls "$out"/obliq-*-py3-none-any.whl

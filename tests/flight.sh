#!/usr/bin/env bash
# Flies an antenna over real terrain, out of what is loaded again and again, and reports memory, lateness of
# frames, windows and coverage. An hour at 83 m/s by default; a faster flight gets through its windows faster
# and so asks more of the daemon:
#   tests/flight.sh [SPEED_M_S [DISTANCE_KM [FRAMES_HZ]]]        tests/flight.sh 667 300 5: seven and a half minutes
# Needs build/release (or BUILD=...) and the elevation model of deploy/scenes/losangeles.toml (or DEM=...).
set -euo pipefail
cd "$(dirname "$0")/.."
speed_m_s=${1:-83} distance_km=${2:-300} frames_hz=${3:-5}
build=${BUILD:-build/release}
dem=${DEM:-${OBLIQ_SHARED:-../shared}/data/la_nasadem_30m/NASADEM_HGT_n34w119.tif}
[ -e "$dem" ] || { echo "no elevation model at $dem: give DEM=..." >&2; exit 1; }
folder=$(mktemp -d)
cat > "$folder/flight.toml" <<TOML
[terrain]
dem = ["$(realpath "$dem")"]
[antenna]
latitude_deg = 34.392
longitude_deg = -118.5
height_m = 4000
[radar]
sector_deg = 120
r_min_m = 4100
r_max_m = 20000
[frustum]
kind = "sweep"
pixels = 512
[bins]
azimuth = 512
range = 512
TOML
"$build/bin/obliqd" --config "$folder/flight.toml" --port 0 --set http.enabled=false 2> "$folder/log" &
daemon=$!
trap 'kill $daemon 2> /dev/null || true; wait $daemon 2> /dev/null || true; rm -rf "$folder"' EXIT
for _ in $(seq 600); do
  address=$(sed -n 's/.*ready: .* on //p' "$folder/log")
  [ -n "$address" ] && break
  kill -0 $daemon 2> /dev/null || { cat "$folder/log" >&2; exit 1; }
  sleep 0.1
done
# A racetrack of 115 km round the middle of the tile, 12 km north and south of it; it begins over the antenna.
"$build/bin/flight_bench" "$address" $daemon 34.5 -118.5 20 12 "$distance_km" "$speed_m_s" "$frames_hz"
grep -i "warning\|error" "$folder/log" || true

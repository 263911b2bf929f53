#!/usr/bin/env bash
# From a fresh clone to a radar ground map: installs what is missing, builds, gets the demo's ground, starts the
# daemon, fetches a frame over TCP, writes the pictures to out/quickstart/, stops the daemon.
#
#   deploy/quickstart.sh
#
# Works as root or with sudo; safe to run twice (the second run takes seconds).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
case "${1-}" in
  "") ;;
  -h | --help)
    sed -n '2,7s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
  *)
    echo "quickstart.sh takes no options (found '$1')" >&2
    exit 2
    ;;
esac
cd "$root"
out=out/quickstart
programs=build/release/bin
ready_limit_s=300

daemon=""
stop_daemon() {
  [ -n "$daemon" ] || return 0
  local pid=$daemon
  daemon=""
  kill -TERM "$pid" 2>/dev/null || true
  for _ in $(seq 100); do
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.1
  done
  if kill -KILL "$pid" 2>/dev/null; then
    echo "quickstart: obliqd did not stop within 10 s and was killed" >&2
  fi
  local status=0
  wait "$pid" 2>/dev/null || status=$?
  [ "$status" -eq 0 ] || echo "quickstart: obliqd ended with exit code $status" >&2
  return "$status"
}
trap 'stop_daemon || true' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

step "1/6 packages"
deploy/install-deps.sh build demo

step "2/6 build with $(parallel_jobs) jobs (minutes the first time, seconds after)"
# A tree that was set up for tests stays so; a fresh one is spared their packages and their build.
fresh=()
[ -f build/release/CMakeCache.txt ] || fresh=(-DOBLIQ_TESTS=OFF)
mkdir -p build
if ! cmake --preset release "${fresh[@]}" >build/configure.log 2>&1; then
  cat build/configure.log >&2
  exit 1
fi
cmake --build --preset release --parallel "$(parallel_jobs)" --target obliqd obliq

step "3/6 ground"
scene=deploy/scenes/demo.toml
if tile=$(deploy/fetch-demo-terrain.sh --link); then
  echo "real ground: $tile"
else
  scene=deploy/scenes/demo_hills.toml
  echo "going on with fractal hills instead of real ground"
fi

step "4/6 daemon"
mkdir -p "$out"
: >"$out/obliqd.log"
"$programs/obliqd" --config "$scene" --port 0 --set http.port=0 >>"$out/obliqd.log" 2>&1 </dev/null &
daemon=$!
tail -n +1 -f --pid="$daemon" -s 0.1 "$out/obliqd.log" &
server=""
for _ in $(seq $((ready_limit_s * 5))); do
  server=$(sed -n 's/.*ready: .* on \(127\.0\.0\.1:[0-9]*\)$/\1/p' "$out/obliqd.log" | head -n 1)
  [ -z "$server" ] || break
  kill -0 "$daemon" 2>/dev/null || break
  sleep 0.2
done
sleep 0.3 # so that its last lines stand above the next step
if [ -z "$server" ]; then
  echo "quickstart: obliqd did not become ready; its log is above and in $out/obliqd.log" >&2
  exit 1
fi

# As deploy/scenes/x_band_sector.toml has it: beam, pulse, noise.
radar=()
for setting in radar.frequency_ghz=9.4 radar.power_w=50e3 radar.gain_db=33 radar.range_normalisation=false \
  radar.speckle=independent antenna.tilt_deg=-1.5 beam.pattern=gaussian beam.width_deg=3 beam.elevation=cosecant \
  beam.cosecant_to_deg=35 pulse.kind=rectangular pulse.length_us=0.25 receiver.noise=true; do
  radar+=(--set "$setting")
done

step "5/6 four frames over TCP: rendering time, gaps (lit bins without a sample) and their share"
"$programs/obliq" get --server "$server" --radar oblique --out "$out/oblique"
"$programs/obliq" get --server "$server" --radar main --out "$out"
"$programs/obliq" get --server "$server" --radar main "${radar[@]}" --out "$out/radar"
"$programs/obliq" get --server "$server" --radar oblique --set frustum.kind=symmetric --out "$out/symmetric"

step "6/6 stop the daemon"
stop_daemon
step_end

cat <<TEXT

Done in $SECONDS s. The radar ground map:
  $out/ground_map.png             ideal: every bin as sharp as its edges (by the sweep, planes through the ground)
  $out/radar/ground_map.png       the same view by a radar: a beam of 3 degrees, a pulse of 0.25 us, noise
  $out/oblique/ground_map.png     the same view by the oblique frustum, rays cast with Embree
  $out/ground_map.tif             the same, georeferenced (any GIS opens it)
  $out/bins.npy                   complex I&Q, azimuth x range; frame.json beside it says what is what
  $out/symmetric/ground_map.png   the same view through an ordinary camera: look at the far half

Try next:
  # a daemon of your own, its live picture and controls in a browser, and a client that looks elsewhere
  $programs/obliqd --config $scene &
  $programs/obliq get --wait 60 --set antenna.bearing_deg=20 --out out/mine
  # the same without a daemon; every parameter; the range steps of the frusta
  $programs/obliq render $scene --out out/render
  $programs/obliq parameters
  $programs/obliq frustum $scene

Its radar, live, once $programs/obliqd --config $scene runs:
  http://127.0.0.1:7480/
TEXT

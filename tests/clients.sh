#!/usr/bin/env bash
# Runs the Python package with programs that others wrote: each checks that what obliq makes means to them what it should.
#
#   tests/clients.sh [NAME...]     default: wheel oldest notebook sigmf gdal octave opendis dask ray kubernetes cat240
#
# Installs into build/clients/. The last line says "N passed, M failed, K skipped"; exit code 77 where nothing failed and a
# registry or an archive did not answer, which is no failure. Needs obliqd in build/release/bin.
set -uo pipefail
cd "$(dirname "$0")/.."
root=$PWD
bin=${OBLIQ_BIN:-$root/build/release/bin}
work=$root/build/clients
export OBLIQD=$bin/obliqd OBLIQ_BIN=$bin OBLIQ_CACHE_DIR= PIP_DISABLE_PIP_VERSION_CHECK=1
passed=0 failed=0 skipped=0
log=

say() { printf '%-12s %s\n' "$1" "$2"; }
# check NAME: a function of that name; 0 passed, 77 skipped with the last line of its log.
check() {
  log=$work/$1.log
  if ("check_$1") >"$log" 2>&1; then
    passed=$((passed + 1))
    say "$1" "passed: $(tail -1 "$log")"
  elif [ $? -eq 77 ]; then
    skipped=$((skipped + 1))
    say "$1" "skipped: $(tail -1 "$log")"
  else
    failed=$((failed + 1))
    say "$1" "FAILED, $log:"
    tail -25 "$log" | sed 's/^/    /'
  fi
}

# environment NAME PACKAGE...: python of a virtual environment with these, made once; 77 where they cannot be installed.
environment() {
  local folder=$work/env-$1 wanted="${*:2}"
  if [ "$(cat "$folder/installed" 2>/dev/null)" != "$wanted" ]; then
    rm -rf "$folder"
    python3 -m venv "$folder" && "$folder/bin/pip" install -q "${@:2}" || {
      echo "cannot be installed: $wanted"
      return 77
    }
    echo "$wanted" >"$folder/installed"
  fi
}
# with_wheel NAME PACKAGE...: the same with the wheel built now.
with_wheel() {
  environment "$@" || return
  "$work/env-$1/bin/pip" install -q --no-deps --force-reinstall "$work"/wheel/obliq-*.whl &&
    touch "$work/env-$1/installed"
}

# A daemon over the hills of the tests, and poses for it.
served() {
  mkdir -p "$work/scene"
  (cd tests/python && "$work/env-all/bin/python" -c 'import support; print(support.SCENE)') >"$work/scene/hills.toml"
  "$work/env-all/bin/python" - "$work/scene" <<'PY'
import json, pathlib, sys
with open(pathlib.Path(sys.argv[1]) / "poses.jsonl", "w") as file:
    for k in range(160):
        print(json.dumps({"id": f"p{k}", "latitude_deg": 33.0, "longitude_deg": -99.5, "height_m": 1200.0 + k, "bearing_deg": k}), file=file)
PY
}
# on_daemon COMMAND...: runs it with the address in $address.
on_daemon() {
  daemon=
  : >"$work/obliqd.log"
  "$OBLIQD" --config "$work/scene/hills.toml" --set server.port=0 --set http.enabled=false >"$work/obliqd.log" 2>&1 &
  daemon=$!
  trap 'kill "${daemon:-}" 2>/dev/null' EXIT
  until address=$(sed -n 's/.*ready: .* on \([0-9.:]*\).*/\1/p' "$work/obliqd.log") && [ -n "$address" ]; do
    kill -0 "$daemon" || return 1
    sleep 0.1
  done
  export address
  "$@"
}
# The sums of a data set, in the order of its poses.
sums() { "$work/env-all/bin/python" -c 'import obliq, sys; print(obliq.Dataset(sys.argv[1]).verify())' "$1"; }

# ---- Checks ----

# The tests of the package against the wheel and the newest of everything.
check_wheel() {
  PYTHON=python3 deploy/build-wheel.sh --out "$work/wheel" || { echo "the build tool cannot be installed"; return 77; }
  with_wheel all numpy protobuf google-crc32c zstandard xarray netCDF4 matplotlib rasterio nbclient ipykernel || return
  for name in wire frames files aio; do
    OBLIQ_INSTALLED=1 OBLIQ_PYTHON=$work/env-all/bin/python bash -c \
      'cd "$0" && "$OBLIQ_PYTHON" tests/python/run.py "$1"' "$root" "${name}_test" || return 1
  done
  "$work/env-all/bin/python" -c 'import google.protobuf as p, numpy; print("protobuf", p.__version__, "numpy", numpy.__version__)'
}

# The oldest protobuf that generated code of 3.21 is meant for.
check_oldest() {
  with_wheel oldest 'numpy<2' 'protobuf==4.25.*' google-crc32c || return
  for name in wire frames; do
    OBLIQ_INSTALLED=1 "$work/env-oldest/bin/python" tests/python/run.py "${name}_test" || return 1
  done
  "$work/env-oldest/bin/python" -c 'import google.protobuf as p, numpy; print("protobuf", p.__version__, "numpy", numpy.__version__)'
}

check_notebook() {
  "$work/env-all/bin/python" - <<'PY'
import nbclient, nbformat
for name, least in (("tutorial", 11), ("labels", 4)):
    notebook = nbformat.read(f"client/python/{name}.ipynb", 4)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    outputs = sum(len(cell.get("outputs", ())) for cell in notebook.cells)
    assert outputs >= least, outputs
    print(name, len(notebook.cells), "cells run")
PY
}

# One frame for those that read files.
frame_files() {
  rm -rf "$work/frame" && mkdir "$work/frame"
  on_daemon "$work/env-all/bin/python" - "$work/frame" <<'PY'
import os, pathlib, sys, obliq
folder = pathlib.Path(sys.argv[1])
with obliq.connect(os.environ["address"]) as server:
    frame = server.radar("main").frame()
for name in ("f.npz", "f.nc", "f.tif"):
    frame.save(folder / name)
PY
}

check_sigmf() {
  with_wheel sigmf numpy protobuf google-crc32c sigmf || return
  (frame_files) && (cd "$work/frame" &&
    "$work/env-sigmf/bin/python" "$root/client/python/recipes/sigmf_frame.py" f.npz f &&
    "$work/env-sigmf/bin/sigmf_validate" f.sigmf-meta &&
    "$work/env-sigmf/bin/python" - <<'PY'
import numpy as np, obliq, sigmf
frame, file = obliq.load("f.npz"), sigmf.sigmffile.fromfile("f")
np.testing.assert_array_equal(file.read_samples().view("u8"), frame.iq.ravel().view("u8"))
print("identical bits of", frame.iq.size, "samples")
PY
  )
}

check_gdal() {
  command -v gdalinfo >/dev/null || { echo "gdal-bin is not installed"; return 77; }
  (frame_files) || return 1
  gdalinfo -stats "$work/frame/f.tif" | tee "$work/frame/gdalinfo" | grep -q 'Azimuthal Equidistant' || return 1
  grep -c 'Description = \(magnitude\|state\)' "$work/frame/gdalinfo" | grep -qx 2 && echo "two bands in an azimuthal equidistant plane"
}

check_octave() {
  if ! command -v octave-cli >/dev/null || ! octave-cli --eval 'pkg load netcdf' 2>/dev/null; then
    [ "$(id -u)" -eq 0 ] && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends octave octave-netcdf >/dev/null
  fi
  octave-cli --eval 'pkg load netcdf' 2>/dev/null || { echo "octave with octave-netcdf is not installed"; return 77; }
  (frame_files) || return 1
  octave-cli "$root/client/python/recipes/frame.m" "$work/frame/f.nc" >"$work/frame/octave.out" || return 1
  "$work/env-all/bin/python" - "$work/frame" <<'PY'
import pathlib, re, sys
import numpy as np, obliq
folder = pathlib.Path(sys.argv[1])
frame, said = obliq.load(folder / "f.npz"), (folder / "octave.out").read_text()
rows, columns = map(int, re.search(r"bins (\d+) (\d+)", said).groups())
assert (rows, columns) == frame.shape
assert float(re.search(r"bearing (\S+)", said).group(1)) == frame.pose.bearing_deg
i, k = np.unravel_index(np.abs(frame.iq.astype("c16")).argmax(), frame.shape)
real, imaginary, r, azimuth, latitude = map(float, re.search(
    r"strongest (\S+) (\S+) at range (\S+) azimuth (\S+) latitude (\S+)", said).groups())
assert (np.float32(real), np.float32(imaginary)) == (frame.iq[i, k].real, frame.iq[i, k].imag)
assert (r, azimuth) == (frame.range_m[k], frame.azimuth_deg[i] % 360) and abs(latitude - frame.places()[0][i, k]) < 1e-12
print("the strongest bin has the same value and place")
PY
}

# An engine makes the data set while one of its workers is killed. engine NAME EXAMPLE: the same set of sums as one process's.
engine() {
  local name=$1 example=$2 out=$work/set-$1 python=$work/env-$1/bin/python
  rm -rf "$out" "$work/set-one"
  "$work/env-all/bin/python" -m obliq.batch "$work/scene/poses.jsonl" --out "$work/set-one" --server "$address" --shard-size 16 || return 1
  "$python" "$example" "$work/scene/poses.jsonl" "$out" "$address" ${3:-} &
  local run=$! victim=
  # A worker, once there is a part: it is making another one.
  for _ in $(seq 1200); do
    if compgen -G "$out/part-*" >/dev/null; then
      victim=$(compgen -G "$out/.part-*" | head -1 | sed 's/.*\.\([0-9]*\)\.[0-9a-f]*$/\1/')
      [ -z "$victim" ] || break
    fi
    kill -0 "$run" 2>/dev/null || break
    sleep 0.05
  done
  if [ -n "$victim" ] && kill -KILL "$victim" 2>/dev/null; then echo "worker $victim was killed"; else echo "no worker to kill"; fi
  if ! wait "$run"; then
    echo "once more"
    "$python" "$example" "$work/scene/poses.jsonl" "$out" "$address" ${3:-} || return 1
  fi
  grep -q "was killed" "$log" || return 1
  [ "$(sums "$out")" = "$(sums "$work/set-one")" ] && echo "the same sums as one process, a worker killed"
}

check_dask() {
  with_wheel dask numpy protobuf google-crc32c distributed || return
  on_daemon engine dask client/python/examples/dask_batch.py
}

check_ray() {
  with_wheel ray numpy protobuf google-crc32c ray || return
  on_daemon engine ray client/python/examples/ray_batch.py 2
}

check_kubernetes() {
  environment kubernetes kubernetes-validate || return
  "$work/env-kubernetes/bin/kubernetes-validate" --strict deploy/kubernetes/batch.yaml deploy/kubernetes/open/obliqd.yaml \
    deploy/kubernetes/protected/networkpolicy.yaml || return 1
  # It does look: a key that is misspelt is refused.
  sed 's/completions:/completionz:/' deploy/kubernetes/batch.yaml >"$work/wrong.yaml"
  ! "$work/env-kubernetes/bin/kubernetes-validate" --strict "$work/wrong.yaml" && echo "manifests are valid, a wrong one is not"
}

# An entity that opendis encodes, with its own conversion of angles, is where the radar goes.
check_opendis() {
  with_wheel opendis numpy protobuf google-crc32c opendis || return
  on_daemon "$work/env-opendis/bin/python" - <<'PY'
import io, math, os, re, signal, socket, struct, subprocess, time
from opendis import dis7
from opendis.DataOutputStream import DataOutputStream
from opendis.RangeCoordinates import GPS
from opendis.dis7 import EntityStatePdu
import obliq

ride = subprocess.Popen([os.environ["OBLIQ_BIN"] + "/obliq", "fly", "--server", os.environ["address"], "--radar", "main", "--dis",
                         "17:23:42", "--udp", "0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
port = int(re.search(r"127.0.0.1:(\d+)", ride.stdout.readline()).group(1))
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
with obliq.connect(os.environ["address"]) as server:
    for heading in (0.0, 30.0, 100.0, 200.0, 300.0):
        pdu = EntityStatePdu()
        pdu.pduType, pdu.protocolFamily, pdu.exerciseID = 1, 1, 1
        pdu.pduStatus = pdu.entityAppearance = pdu.capabilities = 0  # opendis 1.0 has no numbers there
        pdu.entityID.siteID, pdu.entityID.applicationID, pdu.entityID.entityID = 17, 23, 42
        x, y, z, psi, theta, phi = GPS().llarpy2ecef(*map(math.radians, (33.02, -99.48)), 1800.0, 0.0, 0.0, math.radians(heading))
        pdu.entityLocation.x, pdu.entityLocation.y, pdu.entityLocation.z = x, y, z
        pdu.entityOrientation.psi, pdu.entityOrientation.theta, pdu.entityOrientation.phi = psi, theta, phi
        stream = io.BytesIO()
        pdu.serialize(DataOutputStream(stream))
        data = bytearray(stream.getvalue())
        data[8:10] = len(data).to_bytes(2, "big")
        sender.sendto(data, ("127.0.0.1", port))
        end = time.monotonic() + 10
        while True:
            pose = server.radar("main").pose
            off = (pose.bearing_deg - heading + 180) % 360 - 180
            if abs(off) < 1e-3 or time.monotonic() > end:
                break
        assert abs(off) < 1e-3, (heading, pose)
        assert abs(pose.latitude_deg - 33.02) < 1e-7 and abs(pose.longitude_deg + 99.48) < 1e-7, pose
        assert abs(pose.height_m - 1800) < 0.05, pose
    # Orders of a simulation's manager, and a frozen entity, as opendis writes them.
    def send(pdu, kind, family, **fields):
        pdu.pduType, pdu.protocolFamily, pdu.exerciseID, pdu.pduStatus = kind, family, 1, 0
        for name, value in fields.items():
            setattr(pdu, name, value)
        stream = io.BytesIO()
        pdu.serialize(DataOutputStream(stream))
        sender.sendto(stream.getvalue(), ("127.0.0.1", port))
    def until(holds):
        end = time.monotonic() + 20
        while not holds() and time.monotonic() < end:
            time.sleep(0.01)
        assert holds()
    radar = server.radar("main")
    for kind, pdu, frozen in ((14, dis7.StopFreezePdu(), True), (13, dis7.StartResumePdu(), False)):
        send(pdu, kind, 5, receivingEntityID=dis7.EntityID(17, 65535, 65535))
        until(lambda: radar.info().frozen == frozen)
    data[84:88] = (1 << 21).to_bytes(4, "big")
    data[36:48] = struct.pack(">3f", 500, 500, 500)
    data[88] = 2
    sender.sendto(data, ("127.0.0.1", port))
    first = radar.pose
    until(lambda: radar.pose.pose_id > first.pose_id + 5)
    assert abs(radar.pose.latitude_deg - 33.02) < 1e-7, radar.pose
    send(dis7.RemoveEntityPdu(), 12, 5, receivingEntityID=dis7.EntityID(17, 23, 42))
ride.send_signal(signal.SIGINT)
said = ride.communicate(timeout=20)[1]
assert ride.returncode == 0 and "was removed" in said, said
print(len(data), "bytes of opendis, five headings, four orders and states")
PY
}

# What displays get: libasterix makes the same bytes, asterix_decoder reads the same cells, tshark finds nothing malformed.
check_cat240() {
  environment libasterix libasterix==0.36.3 || return
  environment asterix_decoder asterix_decoder==0.7.11 || return
  command -v tshark >/dev/null || { echo "tshark is not installed: deploy/install-deps.sh test"; return 77; }
  local captures=$work/cat240 packets=0 n bad
  rm -rf "$captures"
  "$work/env-all/bin/python" tests/cat240/capture.py "$captures" || return 1
  "$work/env-libasterix/bin/python" tests/cat240/with_libasterix.py "$captures" || return 1
  "$work/env-asterix_decoder/bin/python" tests/cat240/with_asterix_decoder.py "$captures" || return 1
  for file in "$captures"/*.pcap; do
    n=$(tshark -r "$file" -d udp.port==8600,asterix -Y asterix -T fields -e asterix.category | grep -c '^240$')
    [ "$n" -eq "$(tshark -r "$file" | wc -l)" ] || { echo "$file: tshark takes $n packets for CAT 240"; return 1; }
    bad=$(tshark -r "$file" -d udp.port==8600,asterix -Y '_ws.malformed || _ws.expert.severity >= 6291456' | head -3)
    [ -z "$bad" ] || { echo "$file: $bad"; return 1; }
    packets=$((packets + n))
  done
  # It does look: a message that is cut is malformed.
  "$work/env-all/bin/python" - "$captures" <<'PY' || return 1
import pathlib, sys
sys.path.insert(0, "tests/cat240")
from capture import pcap_of
from captured import cases
case = next(case for case in cases(sys.argv[1]) if case.name == "frame-512-8")
pathlib.Path(sys.argv[1], "cut").write_bytes(pcap_of([(case.arrived[0], case.datagrams[1][:-100])], 8600))
PY
  tshark -r "$captures/cut" -d udp.port==8600,asterix -Y _ws.malformed | grep -q . || { echo "tshark takes a cut message for whole"; return 1; }
  echo "$packets packets: the bytes of libasterix, the cells of the video plane by asterix_decoder, none malformed to tshark"
}

case "${1:-}" in -h | --help)
  sed -n '2,8s/^# \{0,1\}//p' tests/clients.sh
  exit 0
  ;;
esac
[ -x "$OBLIQD" ] || {
  echo "no $OBLIQD: build it first"
  exit 1
}
mkdir -p "$work"
[ $# -gt 0 ] || set -- wheel oldest notebook sigmf gdal octave opendis dask ray kubernetes cat240
# The others stand on the wheel: it is that of the sources.
stale() { [ ! -x "$work/env-all/bin/python" ] || [ -n "$(find client/python/src -name '*.py' -newer "$work/env-all/installed" | head -1)" ]; }
if [ "$1" != wheel ] && stale; then set -- wheel "$@"; fi
for name in "$@"; do
  declare -F "check_$name" >/dev/null || {
    echo "unknown check '$name'"
    exit 2
  }
  check "$name"
  if [ "$name" = wheel ]; then
    # The others stand on it.
    [ -x "$work/env-all/bin/python" ] && served || break
  fi
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ] || exit 1
[ "$skipped" -eq 0 ] || exit 77

#!/usr/bin/env bash
# Runs the image that deploy/build-image.sh made, as an engine would run it: the image's own user, command,
# healthcheck and stop signal; its root read-only, no capabilities, terrain and secrets as volumes. A client
# outside, of this machine's own build, fetches frames, which are compared with this machine's own `obliq render`:
# on bookworm the same bits, on trixie (Embree 4, newer libraries) the same samples but for edge hits, which are counted.
#
#   deploy/check-image.sh [bookworm|trixie] [--dem FILE]      default: bookworm
#
# --dem: one frame also over this elevation file, mounted at /terrain. Needs root and this machine's build
# (OBLIQ_PROGRAMS; default: build/release/bin).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/image-store.sh"
cd "$root"

suite=bookworm
dem=""
while [ $# -gt 0 ]; do
  case "$1" in
    bookworm | trixie) suite=$1 ;;
    --dem)
      [ $# -ge 2 ] || die "--dem needs a file"
      dem=$(readlink -f "$2")
      [ -f "$dem" ] || die "no file '$2'"
      shift
      ;;
    -h | --help) usage "$1" ;;
    *) die "unknown argument '$1'; allowed: bookworm, trixie, --dem FILE" ;;
  esac
  shift
done
as_root
"$root"/deploy/install-deps.sh image
need buildah unshare setpriv
python=$(python_with numpy)
image=$(image_name "$suite")
has_image "$image" || die "no image $image in $store: run deploy/build-image.sh $suite first"
host=${OBLIQ_PROGRAMS:-build/release/bin}/obliq
[ -x "$host" ] || die "no $host: build the release preset first"
ready_limit_s=300

work=$(mktemp -d "$store/check.XXXXXX")
container=$(buildah_ from --pull-never "$image")
daemon=""
clean_up() {
  [ -z "$daemon" ] || kill -KILL "$daemon" 2>/dev/null || true
  buildah_ umount "$container" >/dev/null 2>&1 || true
  buildah_ rm "$container" >/dev/null 2>&1 || true
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
folder=$(buildah_ mount "$container")

# ---- What the image says of itself ----

buildah_ inspect --type image "$image" >"$work/image.json"
# setting PATH...: a value of the image's configuration, a list as one word a line.
setting() {
  "$python" - "$work/image.json" "$@" <<'PYTHON'
import json, sys
value = json.load(open(sys.argv[1], encoding="utf-8"))["Docker"]["config"]
for key in sys.argv[2:]:
    value = value[key]
print("\n".join(map(str, value)) if isinstance(value, (list, dict)) else value)
PYTHON
}
user=$(setting User)
stop_signal=$(setting StopSignal)
mapfile -t command < <(setting Entrypoint && setting Cmd)
mapfile -t health < <(setting Healthcheck Test)
[[ $user =~ ^[1-9][0-9]*:[1-9][0-9]*$ ]] || die "the image's user is '$user': not a number, or root"
[ "${health[0]}" = CMD ] || die "the image's healthcheck is '${health[*]}'"
echo "image: user $user, stops on $stop_signal, runs '${command[*]}', healthcheck '${health[*]:1}'"
labels=$(setting Labels)
[[ $labels == *org.opencontainers.image.version* ]] || die "the image has no OCI labels"

# ---- Running in it ----

mkdir -p "$work"/state/{authority,server,scrape,client,console} "$work/terrain" "$work/out"
chown -R "$user" "$work/state"
[ -z "$dem" ] || install -m 0644 "$dem" "$work/terrain/dem.tif"
free_ports() {
  "$python" -c 'import socket
taken = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(each.getsockname()[1] for each in taken))'
}
read -r port http_port < <(free_ports)

# The image's own scene, or one over the elevation file, with loopback and free ports in place of every address:
# this machine may serve others.
write_scene() {
  local from=/dev/stdin
  [ "$1" = dem ] || from=$folder/etc/obliq/obliqd.toml
  awk -v port="$port" -v http_port="$http_port" '
    /^\[/ {section = $0}
    /^address = "0\.0\.0\.0"/ {print "address = \"127.0.0.1\"\nport = " (section == "[http]" ? http_port : port); next}
    {print}' "$from" >"$work/obliqd.toml" <<TOML
[terrain]
dem = ["/terrain/dem.tif"]
[[prisms]]
per_km2 = 5.0
[antenna]
height_m = 3000.0
height_reference = "ground"
[radar]
sector_deg = 60.0
r_min_m = 4000.0
r_max_m = 20000.0
[frustum]
pixels = 1024
[bins]
azimuth = 256
range = 512
$(sed -n '/^\[server\]/,$p' "$folder/etc/obliq/obliqd.toml")
TOML
  sed "s,/terrain/dem.tif,$dem," "$work/obliqd.toml" >"$work/host.toml"
}

# inside COMMAND...: as an engine does it with --read-only --cap-drop ALL --security-opt no-new-privileges, in
# mount and process namespaces of its own, on this machine's loopback.
inside() {
  OBLIQ_ROOT=$folder OBLIQ_WORK=$work OBLIQ_USER=$user exec unshare --mount --pid --fork --kill-child bash -c '
    set -euo pipefail
    r=$OBLIQ_ROOT w=$OBLIQ_WORK
    mount --make-rprivate /
    mount --bind "$r" "$r"
    mount -o remount,bind,ro "$r"
    mount -t proc -o nosuid,nodev,noexec proc "$r/proc"
    mount -t sysfs -o ro,nosuid,nodev,noexec sysfs "$r/sys"
    mount --rbind /dev "$r/dev"
    for name in authority server scrape client console; do mount --bind "$w/state/$name" "$r/state/$name"; done
    mount --bind "$w/terrain" "$r/terrain"
    mount -o remount,bind,ro "$r/terrain"
    mount --bind "$w/obliqd.toml" "$r/etc/obliq/obliqd.toml"
    exec chroot "$r" env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin setpriv \
      --reuid "${OBLIQ_USER%:*}" --regid "${OBLIQ_USER#*:}" --clear-groups --no-new-privs --bounding-set=-all \
      --inh-caps=-all -- "$@"' inside "$@"
}

step "first start"
write_scene own
(inside obliq-first-start /state)
again=$(inside obliq-first-start /state)
[[ $again == *already* ]] || die "a second start made files anew: $again"
if (inside sh -c 'touch /probe 2>/dev/null || touch /etc/probe 2>/dev/null || touch /tmp/probe 2>/dev/null'); then
  die "the root is not read-only"
fi

start_daemon() {
  inside "${command[@]}" >"$work/obliqd.log" 2>&1 &
  runner=$!
  for _ in $(seq $((ready_limit_s * 2))); do
    if (inside "${health[@]:1}" --ready) >"$work/health.log" 2>&1; then break; fi
    kill -0 "$runner" 2>/dev/null || break
    sleep 0.5
  done
  cat "$work/obliqd.log"
  daemon=$(pgrep -P "$runner" || true)
  [ -n "$daemon" ] || die "obliqd is not there"
  (inside "${health[@]:1}") || die "the healthcheck failed"
  [ "$(awk '$1 == "Uid:" {print $2}' "/proc/$daemon/status")" = "${user%:*}" ] || die "obliqd runs as another user"
  awk '$1 ~ /^Cap(Eff|Prm|Bnd):$/ && $2 !~ /^0+$/ {exit 1}' "/proc/$daemon/status" || die "obliqd has capabilities"
}

stop_daemon() {
  local status=0
  kill -s "$stop_signal" "$daemon"
  daemon=""
  wait "$runner" || status=$?
  [ "$status" -eq 0 ] || die "obliqd ended with exit code $status on $stop_signal; its log: $(tail -n 5 "$work/obliqd.log")"
  echo "stopped by $stop_signal: exit code 0"
}

as_client=(--tls --ca "$work/state/client/ca.crt" --token-file "$work/state/client/viewer.token")
mode=samples
[ "$suite" != bookworm ] || mode=bits
check_scene() {
  step "scene $1: the image's daemon, a client outside, this machine's own render"
  write_scene "$1"
  start_daemon
  "$host" get --server "127.0.0.1:$port" "${as_client[@]}" --out "$work/out/$1-image"
  stop_daemon
  "$host" render "$work/host.toml" --out "$work/out/$1-host"
  "$python" deploy/compare_frames.py "$mode" "$work/out/$1-host" "$work/out/$1-image"
}
check_scene own
[ -z "$dem" ] || check_scene dem
step_end
echo "check-image: $image is as it should be"

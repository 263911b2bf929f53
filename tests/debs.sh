#!/usr/bin/env bash
# Debian packages of a built tree, in a scratch root: this machine's own under an overlay, so that what they depend on is there,
# and what they leave behind is seen. They are installed, render, serve, are upgraded while they serve, removed, purged.
#
#   tests/debs.sh [--build DIR]          default: build/release
set -euo pipefail
cd "$(dirname "$0")/.."
build=build/release
[ "${1:-}" != --build ] || build=$2
skip() {
  echo "skipped: $1"
  exit 77
}
for tool in dh dh_python3 lintian; do
  command -v "$tool" >/dev/null || skip "no $tool here; deploy/install-deps.sh package installs it"
done
/usr/bin/python3 -c 'import hatchling' 2>/dev/null || skip "no hatchling for /usr/bin/python3; deploy/install-deps.sh package installs it"
[ -e "$build/client/libobliq.so" ] && [ -e "$build/bin/obliqd" ] || skip "no obliqd and libobliq.so in $build"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
deploy/packages.sh --quick --build "$build" --out "$scratch/old" --version 0.0.1
# The newer ones are the same with another version: nothing is packed twice.
mkdir "$scratch/new"
for package in "$scratch"/old/*.deb; do
  dpkg-deb -R "$package" "$scratch/tree"
  sed -i 's/0\.0\.1/0.0.2/' "$scratch/tree/DEBIAN/control"
  dpkg-deb --root-owner-group -Zgzip -z1 -b "$scratch/tree" "$scratch/new" >/dev/null
  rm -r "$scratch/tree"
done

cat >"$scratch/overlay.sh" <<'OVERLAY'
set -eu
mount -t tmpfs tmpfs "$1/over"
mkdir "$1"/over/{changed,work,root}
root=$1/over/root
mount -t overlay overlay -o "lowerdir=/,upperdir=$1/over/changed,workdir=$1/over/work" "$root"
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount -t tmpfs tmpfs "$root/run" # no systemd: this machine's own is left alone
mount -t tmpfs tmpfs "$root/tmp"
mount --bind "$1" "$root/mnt"
[ "${2-}" != try ] || exit 0
chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 bash /mnt/steps.sh
# What purged packages have left: files, but for dpkg's and the linker's own.
cd "$1/over/changed"
find . ! -type d | grep -Ev '^\./(var/lib/(dpkg|systemd)/|var/cache/ldconfig/|var/log/|var/lib/man-db|etc/ld\.so\.cache$|etc/\.pwd\.lock$|etc/g?shadow-?$)' |
  sort >"$1/left"
for file in passwd group; do diff "/etc/$file" "etc/$file" | grep '^[<>]' | cut -d : -f 1 >>"$1/left" || true; done
OVERLAY
mkdir "$scratch/over"
unshare --mount --pid --fork --kill-child bash "$scratch/overlay.sh" "$scratch" try 2>"$scratch/log" ||
  skip "no overlay can be mounted here: $(tail -n 1 "$scratch/log")"

cat >"$scratch/steps.sh" <<'STEPS'
set -eu
rm -f /var/lib/man-db/auto-update # its index takes long
mkdir -p /tmp/out && cd /tmp/out
install_all() { dpkg --force-unsafe-io -i "/mnt/$1"/*.deb >/mnt/log 2>&1 || { cat /mnt/log; exit 1; }; }
all='obliq libobliq0 libobliq-dev python3-obliq'

install_all old
obliqd --version
obliq render /usr/share/obliq/scenes/demo_hills.toml --set bins.azimuth=128 --set bins.range=256 --out frame >log
[ -s frame/ground_map.png ] && [ -s frame/bins.npy ]
/usr/bin/python3 -m obliq.demo demo.png
[ "$(pkg-config --libs obliq)" = -lobliq ] && ldd "/usr/lib/$(uname -m)-linux-gnu/libobliq.so" >log && ! grep 'not found' log
systemd-analyze verify --man=no /lib/systemd/system/obliqd.service 2>&1 | grep -i obliq && exit 1

setpriv --reuid obliq --regid obliq --clear-groups --no-new-privs obliqd --config /etc/obliq/obliqd.toml --port 0 --set http.port=0 >daemon.log 2>&1 &
daemon=$!
for _ in $(seq 600); do
  server=$(sed -n 's/.*ready: .* on \(127\.0\.0\.1:[0-9]*\)$/\1/p' daemon.log)
  [ -z "$server" ] && kill -0 $daemon || break
  sleep 0.1
done
[ -n "$server" ] || { cat daemon.log; exit 1; }
echo '# mine' >>/etc/obliq/obliqd.toml
install_all new
[ "$(dpkg-query -W -f '${Version} ${Status}\n' $all | sort -u)" = '0.0.2 install ok installed' ]
obliq get --server "$server" --out upgraded >log
[ -s upgraded/ground_map.png ]
kill $daemon && wait $daemon
grep -qx '# mine' /etc/obliq/obliqd.toml

dpkg -r $all >log 2>&1
[ ! -e /usr/bin/obliqd ] && [ -e /etc/obliq/obliqd.toml ]
mkdir -p /var/cache/obliq && touch /var/cache/obliq/grid # as the unit's daemon does
dpkg -P $all >log 2>&1
STEPS
unshare --mount --pid --fork --kill-child bash "$scratch/overlay.sh" "$scratch"
# Debian's custom: a package's user stays, with nothing that is its own.
printf '%s\n' ./etc/group ./etc/group- ./etc/passwd ./etc/passwd- '> obliq' '> obliq' >"$scratch/expected"
if ! diff <(grep -v '^\./etc/.*-$' "$scratch/expected") <(grep -v '^\./etc/.*-$' "$scratch/left"); then
  echo "purged packages left what is marked > above"
  exit 1
fi
echo "packages are installed, render, serve through an upgrade, and leave nothing but their user"

# Sourced by tests/debs.sh and check-packages.sh: what packages are put through in a scratch root.

# newer OLD NEW: the packages of one folder with the next version, in another; nothing is made anew.
newer() {
  local package version tree=$2/tree
  mkdir -p "$2"
  for package in "$1"/*.deb; do
    version=$(dpkg-deb -f "$package" Version)
    dpkg-deb -R "$package" "$tree"
    sed -i "s/${version//./\\.}/$version.1/" "$tree/DEBIAN/control"
    dpkg-deb --root-owner-group -Zgzip -z1 -b "$tree" "$2" >/dev/null
    rm -r "$tree"
  done
}

# proof INSTALL: a script for in-overlay.sh. /mnt/old and /mnt/new hold the packages; INSTALL is a command that installs the
# packages that are named after it.
proof() {
  cat <<STEPS
set -eu
fail() { echo "\$*"; exit 1; }
install_all() { $1 "\$@" >/mnt/log 2>&1 || { cat /mnt/log; exit 1; }; }
STEPS
  cat <<'STEPS'
rm -f /var/lib/man-db/auto-update # its index takes long
mkdir -p /tmp/out && cd /tmp/out
all='obliq libobliq0 libobliq-dev python3-obliq'
began=$(date +%s)
install_all /mnt/old/*.deb
obliqd --version
obliq render /usr/share/obliq/scenes/demo_hills.toml --set bins.azimuth=128 --set bins.range=256 --out frame >log 2>&1
[ -s frame/ground_map.png ]
[ -s frame/bins.npy ]
echo "from nothing to a picture: $(($(date +%s) - began)) s"
/usr/bin/python3 -m obliq.demo demo.png
[ ! -e /usr/bin/pkg-config ] || pkg-config --libs obliq | grep -q '^-lobliq '
ldd /usr/lib/*/libobliq.so >log
if grep 'not found' log; then fail "libobliq needs what is not there"; fi
systemd-analyze verify --man=no obliqd.service 2>&1 | grep obliqd.service >log || true # 252 exits with 0, whatever it finds
[ ! -s log ] || fail "$(cat log)"

# Served as the unit would, upgraded meanwhile; its owner's line in the scene stays.
setpriv --reuid obliq --regid obliq --clear-groups --no-new-privs obliqd --config /etc/obliq/obliqd.toml --port 0 --set http.port=0 >daemon.log 2>&1 &
daemon=$!
for _ in $(seq 600); do
  server=$(sed -n 's/.*ready: .* on \(127\.0\.0\.1:[0-9]*\)$/\1/p' daemon.log)
  [ -z "$server" ] && kill -0 $daemon || break
  sleep 0.1
done
[ -n "$server" ] || { cat daemon.log; exit 1; }
echo '# mine' >>/etc/obliq/obliqd.toml
install_all /mnt/new/*.deb
[ "$(dpkg-query -W -f '${Version} ${Status}\n' $all | sort -u)" = "$(dpkg-deb -f /mnt/new/obliq_*.deb Version) install ok installed" ]
obliq get --server "$server" --out upgraded >log 2>&1
[ -s upgraded/ground_map.png ]
kill $daemon
wait $daemon
grep -qx '# mine' /etc/obliq/obliqd.toml

dpkg -r $all >log 2>&1
[ ! -e /usr/bin/obliqd ] || fail "removed, obliqd is there"
[ -e /etc/obliq/obliqd.toml ]
mkdir -p /var/cache/obliq && touch /var/cache/obliq/grid # as the unit's daemon does
dpkg -P $all >log 2>&1
STEPS
}

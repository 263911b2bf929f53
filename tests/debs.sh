#!/usr/bin/env bash
# Debian packages of a built tree, in a scratch root: this machine's own under an overlay, so that what they depend on is there,
# and what they leave behind is seen. They are installed, render, serve, are upgraded while they serve, removed, purged.
#
#   tests/debs.sh [--build DIR]          default: build/release
set -euo pipefail
cd "$(dirname "$0")/.."
. deploy/packages-proof.sh
build=build/release
[ "${1:-}" != --build ] || build=$2
skip() {
  echo "skipped: $1"
  exit 77
}
for tool in dh dh_python3; do
  command -v "$tool" >/dev/null || skip "no $tool here; deploy/install-deps.sh package installs it"
done
/usr/bin/python3 -c 'import hatchling' 2>/dev/null || skip "no hatchling for /usr/bin/python3; deploy/install-deps.sh package installs it"
[ -e "$build/client/libobliq.so" ] && [ -e "$build/bin/obliqd" ] || skip "no obliqd and libobliq.so in $build"
[ "$(id -u)" -eq 0 ] || skip "only root mounts an overlay"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
deploy/packages.sh --quick --build "$build" --out "$scratch/old"
newer "$scratch/old" "$scratch/new"
proof "dpkg --force-unsafe-io -i" >"$scratch/steps.sh"
status=0
deploy/in-overlay.sh / "$scratch" || status=$?
[ "$status" -ne 77 ] || skip "no overlay can be mounted here"
[ "$status" -eq 0 ] || exit 1
# What purged packages have left, but for dpkg's and the linker's own.
{
  grep -Ev '^\./(var/lib/(dpkg|systemd)/|var/cache/ldconfig/|var/log/|var/lib/man-db|etc/(ld\.so\.cache|\.pwd\.lock|g?shadow-?|passwd-|group-)$)' \
    "$scratch/changed"
  for file in passwd group; do diff "/etc/$file" "$scratch/etc/$file" | grep '^[<>]' | cut -d : -f 1 || true; done
} >"$scratch/left"
# Debian's custom: a package's user stays, with nothing that is its own.
if ! printf '%s\n' ./etc/group ./etc/passwd '> obliq' '> obliq' | diff - "$scratch/left"; then
  echo "purged packages left what is marked > above"
  exit 1
fi
echo "packages are installed, render, serve through an upgrade, and leave nothing but their user"

#!/usr/bin/env bash
# Runs SCRATCH/steps.sh as root in the system LOWER under an overlay, so that nothing of LOWER changes. SCRATCH is /mnt there.
# Afterwards SCRATCH/changed lists what files it has made, changed or removed, and SCRATCH/etc holds what passwd and group
# became.
#
#   deploy/in-overlay.sh LOWER SCRATCH
#
# Exit code 77: no overlay can be mounted here.
set -euo pipefail
lower=$1 scratch=$2
if [ "${3-}" != mounts ]; then
  mkdir -p "$scratch/over"
  exec unshare --mount --pid --fork --kill-child bash "$0" "$lower" "$scratch" mounts
fi
over=$scratch/over root=$scratch/over/root
mount -t tmpfs -o size=8g tmpfs "$over"
mkdir "$over"/{changed,work,root}
mount -t overlay overlay -o "lowerdir=$lower,upperdir=$over/changed,workdir=$over/work" "$root" || exit 77
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount -t tmpfs tmpfs "$root/run" # no systemd: this machine's own is left alone
mount -t tmpfs tmpfs "$root/tmp"
mount --bind "$scratch" "$root/mnt"
chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash /mnt/steps.sh
(cd "$over/changed" && find . ! -type d | sort >"$scratch/changed")
mkdir -p "$scratch/etc"
cp "$root/etc/passwd" "$root/etc/group" "$scratch/etc/"

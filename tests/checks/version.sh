#!/usr/bin/env bash
# A version names the commit that it was built from: in a clone, a changed one, an archive that git made and an image, whose
# build is told; and it is written only when it changes. The programs that were built say the same version, also to clients.
#
#   tests/checks/version.sh [FOLDER_WITH_PROGRAMS]
set -euo pipefail
cd "$(dirname "$0")/../.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export GIT_CONFIG_GLOBAL=/dev/null GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b

# expect WHAT VERSION FOLDER [COMMIT]
expect() {
  local found
  cmake -D SOURCE="$3" -D RELEASE=0.1.0 -D COMMIT="${4-}" -D OUT="$scratch/version.cpp" \
    -P "$3/server/apps/version/write_version.cmake"
  found=$(sed -n 's/.*return "\(.*\)".*/\1/p' "$scratch/version.cpp")
  [ "$found" = "$2" ] || {
    echo "$1: found $found; allowed: $2"
    exit 1
  }
}

clone=$scratch/clone
mkdir -p "$clone/server/apps"
cp .gitattributes "$clone"
cp -r server/apps/version "$clone/server/apps"
expect "a copy without history" 0.1.0 "$clone"
git -C "$clone" init -q
git -C "$clone" add .
git -C "$clone" commit -q -m one
hash=$(git -C "$clone" rev-parse HEAD)
expect "a clone" "0.1.0+g${hash:0:7}" "$clone"
written=$(stat -c %y "$scratch/version.cpp")
expect "a clone" "0.1.0+g${hash:0:7}" "$clone"
[ "$written" = "$(stat -c %y "$scratch/version.cpp")" ] || {
  echo "the same version was written again: all that includes it would be compiled"
  exit 1
}
mkdir "$scratch/archive"
git -C "$clone" archive HEAD | tar -x -C "$scratch/archive"
expect "an archive" "0.1.0+g${hash:0:7}" "$scratch/archive"
expect "an image's build" 0.1.0+g1234567-dirty "$scratch/archive" 1234567-dirty
echo >>"$clone/server/apps/version/version.h"
expect "a changed clone" "0.1.0+g${hash:0:7}-dirty" "$clone"
git -C "$clone" commit -q -a -m two
hash=$(git -C "$clone" rev-parse HEAD)
expect "the next commit" "0.1.0+g${hash:0:7}" "$clone"

programs=${1-build/release/bin}
[ -x "$programs/obliqd" ] || exit 0
obliqd=$("$programs/obliqd" --version) obliq=$("$programs/obliq" --version)
[ "${obliqd#obliqd }" = "${obliq#obliq }" ] || {
  echo "the programs are of two versions: $obliqd, $obliq"
  exit 1
}
echo "$obliq"

#!/usr/bin/env bash
# The image is built from all it needs, and gets every package that its programs need: each folder that the build
# enters and each file that the Dockerfile copies is let through by .dockerignore, and each shared library of the
# programs built here belongs to a package that runtime-packages.sh names.
#
#   tests/checks/image_context.sh [FOLDER_WITH_PROGRAMS]
set -euo pipefail
cd "$(dirname "$0")/../.."

status=0
let_through() {
  grep -qxF "!$1" .dockerignore || {
    echo ".dockerignore keeps $1 out of the image's build"
    status=1
  }
}
while read -r folder; do
  [ "$folder" = tests ] || let_through "$folder"
done < <(sed -n '/EXISTS.*deploy/,/endif/d; s/^ *add_subdirectory(\([a-z_]*\))$/\1/p' CMakeLists.txt)
while read -r file; do
  [ -e "$file" ] || {
    echo "deploy/Dockerfile copies $file, which is not there"
    status=1
  }
  let_through "$file"
done < <(awk '$1 == "COPY" && $2 !~ /^--/ && $2 != "." {print $2}' deploy/Dockerfile)
let_through CMakePresets.json
let_through deploy/runtime-packages.sh
let_through deploy/sbom.py

programs=${1-build/release/bin}
if [ ! -x "$programs/obliqd" ] || ! command -v dpkg-query >/dev/null; then
  echo "no programs in $programs, or no dpkg: their packages are not checked"
  [ "$status" -eq 0 ] && status=77
  exit "$status"
fi
packages=$(deploy/runtime-packages.sh "$programs/obliqd" "$programs/obliq")
if grep -E -- '-dev$' <<<"$packages"; then
  echo "a development package among those that the image needs"
  status=1
fi
# Every library that is loaded, however far down, must come with one of the packages or with what they depend on.
mapfile -t names <<<"$packages"
closure=$(apt-cache depends --recurse --installed --no-recommends --no-suggests --no-conflicts --no-breaks \
  --no-replaces --no-enhances "${names[@]}" 2>/dev/null | sed -n 's/^\([a-z0-9][^ :]*\).*/\1/p' | sort -u)
mapfile -t libraries < <(ldd "$programs/obliqd" "$programs/obliq" | awk '$2 == "=>" && $3 ~ /^\// {print $3}' |
  sort -u | xargs readlink -f | sort -u)
# dpkg knows a library by its path with or without /usr, and is silent of those it does not know.
owners=$(dpkg-query -S "${libraries[@]}" "${libraries[@]#/usr}" 2>/dev/null || true)
for library in "${libraries[@]}"; do
  owner=$(awk -v a="$library" -v b="${library#/usr}" '$2 == a || $2 == b {sub(/:.*/, "", $1); print $1; exit}' \
    <<<"$owners")
  if ! grep -qxF "${owner:-nothing}" <<<"$closure"; then
    echo "$library belongs to ${owner:-no package}, which the image would not have"
    status=1
  fi
done
echo "${#names[@]} packages named, $(wc -l <<<"$closure") with what they need"
exit "$status"

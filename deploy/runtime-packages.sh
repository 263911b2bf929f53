#!/usr/bin/env bash
# Prints the Debian packages that programs need to run: the owners of the shared libraries that they name
# (what those need in turn, apt knows), and what they open by name: fonts, and certificates for terrain over
# HTTPS.
#
#   deploy/runtime-packages.sh PROGRAM...
set -euo pipefail

die() {
  echo "runtime-packages: $*" >&2
  exit 1
}
case "${1-}" in
  "" | -h | --help)
    sed -n '2,6s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
esac

opened_by_name=(fonts-dejavu-core ca-certificates)

# A library's file as the linker finds it may be spelled through /lib, a link to /usr/lib; dpkg knows one of the two.
owner_of() {
  local path real found
  path=$1
  real=$(readlink -f "$path")
  for found in "$real" "${real#/usr}" "$path" "/usr$path"; do
    found=$(dpkg-query -S "$found" 2>/dev/null | head -n 1) || continue
    [ -n "$found" ] || continue
    echo "${found%%:*}"
    return 0
  done
  die "no package owns $path"
}

packages=("${opened_by_name[@]}")
for program in "$@"; do
  linked=$(ldd "$program") || die "ldd cannot read $program"
  named=$(objdump -p "$program" | awk '$1 == "NEEDED" {print $2}')
  [ -n "$named" ] || die "$program names no shared library"
  while read -r library; do
    path=$(awk -v name="$library" '$1 == name && $2 == "=>" {print $3} $1 ~ "/" name "$" {print $1}' <<<"$linked")
    [ -n "$path" ] && [ "$path" != not ] || die "$program: $library is not installed"
    owner=$(owner_of "$path")
    packages+=("$owner")
  done <<<"$named"
done
printf '%s\n' "${packages[@]}" | sort -u

#!/usr/bin/env bash
# Makes Debian packages of a built tree, obliq, libobliq0, libobliq-dev and python3-obliq: out/packages/*.deb, for the release of
# Debian that this is run on. Nothing is compiled.
#
#   deploy/packages.sh [--build DIR] [--out DIR] [--version VERSION] [--quick]
#
# Default: build/release, out/packages, and the project's version with the commit's time and name. The tree was configured with
# BUILD_SHARED_LIBS. --quick: hardly compressed and not judged by lintian. deploy/install-deps.sh package installs what this needs; no right of root is needed.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

build=build/release
out=out/packages
version=""
quick=""
while [ $# -gt 0 ]; do
  case "$1" in
    --build | --out | --version)
      [ $# -ge 2 ] || die "$1 needs a value"
      declare "${1#--}=$2"
      shift
      ;;
    --quick) quick=1 ;;
    *) usage "$1" ;;
  esac
  shift
done
for file in bin/obliq bin/obliqd client/libobliq.so; do
  [ -e "$build/$file" ] || die "$build/$file is not built: build the release preset first"
done
multiarch=$(dpkg-architecture -qDEB_HOST_MULTIARCH)
grep -q "^CMAKE_INSTALL_LIBDIR:[A-Z]*=lib/$multiarch\$" "$build/CMakeCache.txt" ||
  die "$build installs libraries elsewhere than Debian; once: cmake -DCMAKE_INSTALL_LIBDIR=lib/$multiarch $build"

if [ -z "$version" ]; then
  version=$(project_version)
  # Of two commits the later has the greater version.
  if commit=$(TZ=UTC git log -1 --format=%cd.g%h --date=format-local:%Y%m%d%H%M%S 2>/dev/null); then version+=+$commit; fi
fi
set_source_date

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/tree"
cp -r deploy/debian "$scratch/tree/"
printf 'obliq (%s) unstable; urgency=medium\n\n  * See CHANGES.md.\n\n -- %s  %s\n' "$version" \
  "$(sed -n 's/^Maintainer: //p' deploy/debian/control)" "$(date -u -R -d "@$SOURCE_DATE_EPOCH")" >"$scratch/tree/debian/changelog"
PYTHON=/usr/bin/python3 deploy/build-wheel.sh --out "$scratch" >/dev/null
OBLIQ_BUILD=$(readlink -f "$build")
OBLIQ_WHEEL=$(echo "$scratch"/obliq-*.whl)
OBLIQ_DEB=${quick:+-Zgzip -z1}
export OBLIQ_BUILD OBLIQ_WHEEL OBLIQ_DEB PATH=/usr/bin:$PATH # Debian's python3, whatever stands first
if ! (cd "$scratch/tree" && debian/rules binary) >"$scratch/log" 2>&1; then
  tail -n 40 "$scratch/log" >&2
  die "the packages could not be made"
fi
mkdir -p "$out"
rm -f "$out"/{obliq,libobliq0,libobliq-dev,python3-obliq}_*.deb
mv "$scratch"/*.deb "$out/"
[ -n "$quick" ] || lintian --fail-on error --tag-display-limit 0 "$out"/*.deb
ls "$out"/*.deb

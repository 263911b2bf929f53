#!/usr/bin/env bash
# Builds the wheel that contains the programs: out/wheel/obliq_server-VERSION-py3-none-manylinux_2_36_x86_64.whl. Machines
# with glibc 2.36 or later (Debian 12) run it without a compiler and without any package of their distribution but Python.
#
#   deploy/server-wheel.sh [--build DIR] [--out DIR]        default: build/release, out/wheel
#
# Runs on Debian 12. obliqd and obliq are those of the built tree; nothing of obliq is compiled. GDAL and PROJ are built from
# Debian's source packages with few drivers (half an hour on two cores, kept in out/server-wheel): Debian's own bring GPL
# libraries along. OBLIQ_JOBS: compilers at a time.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

build=build/release
out=out/wheel
while [ $# -gt 0 ]; do
  case "$1" in
    --build | --out)
      [ $# -ge 2 ] || die "$1 needs a folder"
      [ "$1" = --build ] && build=$2 || out=$2
      shift
      ;;
    *) usage "$1" ;;
  esac
  shift
done
[ "$(. /etc/os-release && echo "${ID-}${VERSION_ID-}")" = debian12 ] || die "runs on Debian 12: what is linked here needs its glibc (2.36)"
[ -x "$build/bin/obliqd" ] && [ -x "$build/bin/obliq" ] || die "no obliqd and obliq in $build/bin: build the release preset first"
deploy/install-deps.sh build wheel

work=$root/out/server-wheel
lean=$work/lean
jobs=${OBLIQ_JOBS:-$(parallel_jobs)}
mkdir -p "$work/src" "$out"

# lean NAME TARGET SOURCE OPTION...: configured, built and installed with a distribution's flags, once.
lean() {
  local name=$1 target=$2 source=$3
  shift 3
  [ ! -e "$lean/$name.done" ] || return 0
  step "$name"
  cmake -S "$source" -B "$work/build-$name" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_INSTALL_PREFIX="$lean" \
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_PREFIX_PATH="$lean" -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_TESTING=OFF "$@"
  cmake --build "$work/build-$name" --parallel "$jobs" --target "$target"
  cmake --install "$work/build-$name" >/dev/null
  touch "$lean/$name.done"
}

if [ ! -e "$lean/gdal.done" ]; then
  {
    step "source packages"
    compgen -G "$work/src/gdal-*/CMakeLists.txt" >/dev/null || debian_sources "$work" tiff proj gdal
    flags=$(DEB_BUILD_MAINT_OPTIONS=hardening=+all DEB_CFLAGS_MAINT_STRIP=-g DEB_CXXFLAGS_MAINT_STRIP=-g \
      DEB_CPPFLAGS_MAINT_APPEND=-DNDEBUG dpkg-buildflags --export=sh)
    eval "$flags"
    export CFLAGS+=" $CPPFLAGS" CXXFLAGS+=" $CPPFLAGS" # CMake reads no CPPFLAGS
    # For PROJ, whose grids are deflated TIFFs. No JBIG: Debian's library of it is GPL-2.
    lean tiff all "$work"/src/tiff-*/ -DBUILD_SHARED_LIBS=ON -Dtiff-tools=OFF -Dtiff-tests=OFF -Dtiff-docs=OFF -Dtiff-contrib=OFF \
      -Dcxx=OFF -Djbig=OFF -Dwebp=OFF -Dlerc=OFF -Djpeg=OFF -Dlzma=OFF -Dzstd=OFF -Dlibdeflate=OFF
    lean proj all "$work"/src/proj-*/ -DBUILD_SHARED_LIBS=ON -DBUILD_APPS=OFF -DENABLE_CURL=OFF -DENABLE_TIFF=ON
    lean gdal GDAL "$work"/src/gdal-*/ -DBUILD_SHARED_LIBS=ON -DBUILD_APPS=OFF -DBUILD_PYTHON_BINDINGS=OFF -DBUILD_JAVA_BINDINGS=OFF \
      -DBUILD_CSHARP_BINDINGS=OFF -DGDAL_USE_EXTERNAL_LIBS=OFF -DGDAL_USE_INTERNAL_LIBS=OFF -DGDAL_USE_TIFF_INTERNAL=ON -DGDAL_USE_GEOTIFF_INTERNAL=ON \
      -DGDAL_USE_LERC_INTERNAL=ON -DGDAL_USE_ZLIB=ON -DGDAL_USE_ZSTD=ON -DGDAL_USE_LIBLZMA=ON -DGDAL_USE_JSONC=ON -DGDAL_USE_PNG=ON \
      -DGDAL_USE_SQLITE3=ON -DGDAL_USE_GEOS=ON -DGDAL_BUILD_OPTIONAL_DRIVERS=OFF -DOGR_BUILD_OPTIONAL_DRIVERS=OFF \
      -DGDAL_USE_JPEG12_INTERNAL=OFF -DGDAL_ENABLE_DRIVER_RAW=ON -DGDAL_ENABLE_DRIVER_USGSDEM=ON \
      -DGDAL_ENABLE_DRIVER_AAIGRID=ON -DGDAL_ENABLE_DRIVER_SRTMHGT=ON -DGDAL_ENABLE_DRIVER_PNG=ON \
      -DOGR_ENABLE_DRIVER_SQLITE=ON -DOGR_ENABLE_DRIVER_GPKG=ON -DOGR_ENABLE_DRIVER_TAB=OFF -DOGR_ENABLE_DRIVER_KML=OFF \
      -DENABLE_GNM=OFF
  } 2>&1 | tee "$work/log"
fi

step "wheel"
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
DESTDIR=$stage cmake --install "$build" --component programs --strip --prefix /usr >"$stage/log"
set_source_date
wheel=$(python3 deploy/server_wheel/make.py --stage "$stage" --lean "$lean" --sources "$work/src" --out "$out" \
  --version "$(project_version)")
python3 deploy/server_wheel/check.py "$wheel"
python3 deploy/server_wheel/formats.py "$wheel"

#!/usr/bin/env bash
# The C++ client library for Windows: built with mingw-w64, installed, and used by a project of its own, whose programs run under wine
# against a daemon of this machine: connect, TLS, frames, a recording, with the same sums as the same project built for Linux.
#
#   tests/windows.sh [--bin DIR]        default: build/release/bin
#
# Runs on Debian. What the library links (protobuf, OpenSSL, zstd, isa-l) is built from Debian's source packages, once, in
# out/windows (ten minutes on two cores). Neither ctest nor the build machine runs this. OBLIQ_JOBS: compilers at a time.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../deploy/common.sh"
cd "$root"

bin=$root/build/release/bin
while [ $# -gt 0 ]; do
  case "$1" in
    --bin)
      [ $# -ge 2 ] || die "--bin needs a folder"
      bin=$(realpath -m "$2")
      shift
      ;;
    *) usage "$1" ;;
  esac
  shift
done
[ -x "$bin/obliqd" ] || die "no obliqd in $bin: build the release preset first, or name a folder with --bin"
deploy/install-deps.sh build windows

work=$root/out/windows
target=x86_64-w64-mingw32
jobs=${OBLIQ_JOBS:-$(parallel_jobs)}
mkdir -p "$work/src" "$work/lib" "$work/run"
made=$work/made # what is built for Windows is installed there
log=$work/log

# What links with winsock says so itself, and programs need no DLL beside those of Windows.
cat >"$work/windows.cmake" <<CMAKE
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER $target-gcc-posix)
set(CMAKE_CXX_COMPILER $target-g++-posix)
set(CMAKE_RC_COMPILER $target-windres)
set(CMAKE_FIND_ROOT_PATH $made /usr/$target)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
CMAKE
export PKG_CONFIG_LIBDIR=$made/lib/pkgconfig

# once NAME COMMAND...: what has been built is kept.
once() {
  local name=$1
  shift
  [ ! -e "$work/$name.done" ] || return 0
  step "$name"
  "$@" >"$log" 2>&1 || {
    tail -40 "$log"
    die "$name could not be built; all of its output is in $log"
  }
  touch "$work/$name.done"
}
# by_cmake SOURCE OPTION...
by_cmake() {
  local source=$1
  shift
  local build=$work/build-$(basename "$source")
  cmake -S "$source" -B "$build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$work/windows.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX="$made" -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF "$@" &&
    cmake --build "$build" --parallel "$jobs" && cmake --install "$build"
}
build_zstd() {
  by_cmake "$(echo "$work"/src/libzstd-*/build/cmake)" -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF -DZSTD_BUILD_TESTS=OFF
}
build_protobuf() {
  by_cmake "$(echo "$work"/src/protobuf-*/)" -Dprotobuf_BUILD_TESTS=OFF -Dprotobuf_BUILD_PROTOC_BINARIES=OFF -Dprotobuf_WITH_ZLIB=OFF
}
build_isal() {
  (cd "$work"/src/libisal-*/ && make -f Makefile.unx clean && make -f Makefile.unx -j "$jobs" arch=mingw host_cpu=x86_64 units=crc \
    CC=$target-gcc-posix AR=$target-ar AS=nasm lib) || return
  install -D -m 644 "$work"/src/libisal-*/include/crc.h "$made/include/isa-l/crc.h"
  install -D -m 644 "$(find "$work"/src/libisal-*/bin -name '*isa-l*.a' | head -1)" "$made/lib/libisal.a"
  mkdir -p "$made/lib/pkgconfig"
  printf '%s\n' "prefix=$made" 'Name: libisal' 'Description: CRC-32C' 'Version: 2.30' 'Cflags: -I${prefix}/include' \
    'Libs: -L${prefix}/lib -lisal' >"$made/lib/pkgconfig/libisal.pc"
}
build_openssl() {
  mkdir -p "$work/build-openssl" && (cd "$work/build-openssl" && perl "$(echo "$work"/src/openssl-*/Configure)" mingw64 \
    --cross-compile-prefix=$target- CC=gcc-posix --prefix="$made" --libdir=lib no-shared no-tests no-legacy no-engine &&
    make -j "$jobs" build_libs && make install_dev)
}
OR_OF_RELEASE=1 once sources debian_sources "$work" protobuf openssl libzstd libisal
once zstd build_zstd
once isa-l build_isal
once openssl build_openssl
once protobuf build_protobuf

step "the client library for Windows"
by_cmake "$root" -DOBLIQ_SERVER=OFF -DOBLIQ_MOLD=OFF -DOBLIQ_HARDENING=OFF -DProtobuf_PROTOC_EXECUTABLE=/usr/bin/protoc >"$log" 2>&1 || {
  tail -60 "$log"
  exit 1
}

# consumer BUILD INSTALLED CMAKE_OPTION...: the same project for both.
consumer() {
  local build=$1 installed=$2
  shift 2
  cmake -S tests/consumer -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$installed" \
    -DOBLIQ_EXAMPLES="$installed/share/obliq/client/examples" "$@" >"$log" 2>&1 &&
    cmake --build "$build" --parallel "$jobs" >>"$log" 2>&1 || {
    tail -60 "$log"
    exit 1
  }
}
step "a project that uses it, for Windows and for Linux"
consumer "$work/consumer" "$made" -DCMAKE_TOOLCHAIN_FILE="$work/windows.cmake"
unset PKG_CONFIG_LIBDIR
cmake --install "$(dirname "$bin")" --prefix "$work/linux" --component client >"$log"
consumer "$work/consumer-linux" "$work/linux"

step "under wine, against a daemon with and without TLS"
# wine makes its folder at the first start, which takes a while.
export WINEPREFIX=$work/wine WINEDEBUG=-all DISPLAY=
wine=$(command -v wine64 || command -v wine || echo /usr/lib/wine/wine64)
deploy/first-start.sh "$work/protected" --name 127.0.0.1 >/dev/null
cat >"$work/run/scene.toml" <<'SCENE'
[terrain]
synthetic = "hills"
cell_m = 60.0
[antenna]
height_m = 1500.0
[radar]
sector_deg = 64.0
r_min_m = 2000.0
r_max_m = 12000.0
[bins]
azimuth = 128
range = 512
SCENE
daemon=
trap 'if [ -n "$daemon" ]; then kill "$daemon"; fi' EXIT
# served OPTION...: a daemon; its address is in $address.
served() {
  OBLIQ_CACHE_DIR= "$bin/obliqd" --config "$work/run/scene.toml" --set server.port=0 --set http.enabled=false "$@" >"$work/run/obliqd.log" 2>&1 &
  daemon=$!
  until address=$(sed -n 's/.*ready: .* on \([0-9.:]*\).*/\1/p' "$work/run/obliqd.log") && [ -n "$address" ]; do
    kill -0 "$daemon" || {
      daemon=
      cat "$work/run/obliqd.log"
      exit 1
    }
    sleep 0.1
  done
}
stopped() {
  kill "$daemon" && wait "$daemon" || true
  daemon=
}
# same NAME [CA_FILE]: a station of each system, and what they print; the recording of Windows is read on Linux, too.
same() {
  local name=$1
  shift
  "$wine" "$work/consumer/station.exe" "$address" 5 "$work/run/$name-windows.obliq" "$@" | tr -d '\r' >"$work/run/$name-windows"
  "$work/consumer-linux/station" "$address" 5 "$work/run/$name-linux.obliq" "$@" >"$work/run/$name-linux"
  diff "$work/run/$name-linux" "$work/run/$name-windows" || die "$name: Windows (right) has other sums than Linux"
  [ "$(wc -l <"$work/run/$name-linux")" = 5 ] || die "$name: not five frames"
  "$bin/obliq" replay "$work/run/$name-windows.obliq" --events >/dev/null
  echo "$name: five frames and their recording, on both systems: $(head -1 "$work/run/$name-windows")"
}
served
same plain
"$wine" "$work/consumer/from_c.exe" || die "the C interface does not run"
"$wine" "$work/consumer/fly.exe" "$address" main 1 | tr -d '\r' | tee "$work/run/fly"
grep -q '^60 poses; [1-9]' "$work/run/fly" || die "fly.exe has flown nothing"
stopped
served --set "server.tls_certificate=$work/protected/server/server.crt" --set "server.tls_key=$work/protected/server/server.key"
same tls "$work/protected/client/ca.crt"
# An authority that has not signed the server's certificate.
deploy/first-start.sh "$work/strange" >/dev/null
if "$wine" "$work/consumer/station.exe" "$address" 1 "$work/run/strange.obliq" "$work/strange/client/ca.crt" >"$work/run/strange" 2>&1; then
  die "a certificate of a strange authority was trusted"
fi
grep -q 'not trusted' "$work/run/strange" || die "a strange authority: $(cat "$work/run/strange")"
stopped
step_end
echo "the client library runs on Windows: plain, by TLS, a recording, the C interface"

#!/usr/bin/env bash
# The installed C++ library as its user meets it: found by a project outside the tree, which runs against a daemon. It is that of a
# build (--tree), so that nothing is compiled twice, or configured without the server, built and installed here.
# Needs obliqd in --bin.
#
#   tests/consumer.sh [--bin DIR] [--compiler g++|clang++] [--tree DIR]      default: build/release/bin, g++, none
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD bin=$root/build/release/bin compiler=g++ tree=
while [ $# -gt 0 ]; do
  case "$1" in
    --bin) bin=$2 ;;
    --compiler) compiler=$2 ;;
    --tree) tree=$2 ;;
    *)
      sed -n '2,7s/^# \{0,1\}//p' "$0"
      exit 2
      ;;
  esac
  shift 2
done
command -v "$compiler" >/dev/null || {
  echo "no $compiler here"
  exit 77
}
work=$(mktemp -d)
daemon=
trap 'if [ -n "$daemon" ]; then kill "$daemon"; fi; rm -rf "$work"' EXIT

if [ -n "$tree" ]; then
  cmake --install "$tree" --prefix "$work/installed" --component client >"$work/log"
else
  # Packages that the client needs not are not even looked for. It is to be compiled and to run, not to be fast.
  hidden=()
  for package in embree GDAL Boost TBB glm tomlplusplus CLI11 spdlog fmt OpenEXR; do
    hidden+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
  done
  cmake -S . -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O0 -DOBLIQ_SERVER=OFF \
    "-DCMAKE_CXX_COMPILER=$compiler" "-DCMAKE_INSTALL_PREFIX=$work/installed" "${hidden[@]}" >"$work/log" 2>&1 &&
    cmake --build "$work/build" --target obliq_client >>"$work/log" 2>&1 && cmake --install "$work/build" >>"$work/log" 2>&1 || {
    tail -40 "$work/log"
    exit 1
  }
fi
cp -r tests/consumer "$work/consumer"
cmake -S "$work/consumer" -B "$work/consumer/build" -G Ninja "-DCMAKE_CXX_COMPILER=$compiler" \
  "-DCMAKE_PREFIX_PATH=$work/installed" "-DOBLIQ_EXAMPLES=$work/installed/share/obliq/client/examples" >"$work/log" 2>&1 &&
  cmake --build "$work/consumer/build" >>"$work/log" 2>&1 || {
  tail -40 "$work/log"
  exit 1
}
for program in consumer fly dwell; do
  if ldd "$work/consumer/build/$program" | grep -iE 'embree|gdal|boost|not found'; then
    echo "$program is linked with what a client does not need"
    exit 1
  fi
done

cat >"$work/scene.toml" <<'SCENE'
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
range = 96
[frustum]
kind = "sweep"
SCENE
OBLIQ_CACHE_DIR= "$bin/obliqd" --config "$work/scene.toml" --set server.port=0 --set http.enabled=false >"$work/obliqd.log" 2>&1 &
daemon=$!
until address=$(sed -n 's/.*ready: .* on \([0-9.:]*\).*/\1/p' "$work/obliqd.log") && [ -n "$address" ]; do
  kill -0 "$daemon" || {
    cat "$work/obliqd.log"
    exit 1
  }
  sleep 0.1
done
"$work/consumer/build/consumer" "$address" | tee "$work/out"
grep -qx '128 x 96 bins of main' "$work/out"
"$work/consumer/build/careless"
"$work/consumer/build/from_c"
"$work/consumer/build/fly" "$address" main 1 | tee "$work/out"
grep -q '^60 poses; [1-9]' "$work/out"
# The same mission twice.
"$work/consumer/build/dwell" "$address" main 40 | tee "$work/first"
"$work/consumer/build/dwell" "$address" main 40 >"$work/second"
grep -q '^40 dwells' "$work/first"
[ "$(grep ^sum "$work/first")" = "$(grep ^sum "$work/second")" ]
# And by Python, where there is one with what the package needs: the same bits.
for python in ${OBLIQ_PYTHON:-} build/clients/venv/bin/python /usr/bin/python3 python3; do
  if PYTHONPATH=client/python/src "$python" -c 'import obliq' 2>/dev/null; then
    PYTHONPATH=client/python/src "$python" client/python/examples/dwell.py "$address" main 40 | tee "$work/third"
    [ "$(grep ^sum "$work/first")" = "$(grep ^sum "$work/third")" ]
    break
  fi
done
echo "the installed library builds and runs with $compiler"

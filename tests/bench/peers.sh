#!/usr/bin/env bash
# Our bare trace against Open3D's and Mitsuba's: the same mesh, the same rays, as many threads, in turn. Both peers are
# installed from the Python registry into build/peers, which takes 2 GB.
#
#   tests/bench/peers.sh [SCENE.toml [--set KEY=VALUE] [--threads N] [--repeats N] [--json FILE]]
#
# Without a scene: the paper's, at cells of 30 m and of 10 m (20 GB of memory). BIN is where obliq and ray_bench are.
set -euo pipefail
cd "$(dirname "$0")/../.."
bin=${BIN:-build/release/bin}
[ -x "$bin/ray_bench" ] || { echo "peers.sh: found no $bin/ray_bench; build that target, or set BIN"; exit 2; }

python=build/peers/bin/python
if ! "$python" -c 'import numpy, mitsuba, libusb_package' 2>/dev/null; then
  python3 -m venv build/peers
  # libusb-package: Open3D loads that library, which not every system has.
  "$python" -m pip install --quiet open3d mitsuba libusb-package
fi
files=$(mktemp -d build/peers/run.XXXXXX)
trap 'rm -rf "$files"' EXIT
compare() {
  local scene=$1
  shift
  "$python" tests/bench/peers.py --bin "$bin" --folder "$files" --scene "$scene" "$@"
}
if [ $# -gt 0 ]; then
  compare "$@"
else
  compare tests/bench/paper_hills.toml
  compare tests/bench/paper_hills.toml --set terrain.cell_m=10
fi

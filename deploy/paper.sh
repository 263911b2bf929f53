#!/usr/bin/env bash
# A figure of the paper, from a clone whose programs are built: PAPER.md, "Figures".
#
#   deploy/paper.sh figure1|figure6 [--bin DIR] [--out DIR]      default: build/release/bin, out/paper
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"
usage() { sed -n '2,4s/^# \{0,1\}//p' deploy/paper.sh; }
figure=${1:-} bin=build/release/bin out=out/paper
[ $# -eq 0 ] || shift
while [ $# -gt 0 ]; do
  case "$1" in
    --bin) bin=${2:?--bin needs a folder} ;;
    --out) out=${2:?--out needs a folder} ;;
    *)
      usage >&2
      exit 2
      ;;
  esac
  shift 2
done
plot() {
  local python
  python=$(python_with matplotlib,numpy)
  mkdir -p "$out"
  "$python" "deploy/plots/$figure.py" "$@" "$out/$figure.png"
}
case "$figure" in
  figure6) "$bin/obliq" frustum --figure6 | plot ;;
  figure1)
    ground=$(deploy/fetch-demo-terrain.sh mountains)
    for kind in symmetric oblique; do
      "$bin/obliq" render deploy/scenes/losangeles.toml --set "terrain.dem=[\"$ground\"]" --set frustum.plates=nearest \
        --set "frustum.kind=$kind" --out "$out/$kind"
    done
    plot "$out/symmetric" "$out/oblique"
    ;;
  --help | -h) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
echo "$out/$figure.png"

#!/usr/bin/env bash
# Whether this tree may be released: its published figures (README.md, SPEED.md, ACCURACY.md) must be of this version and of
# the present pipeline. Names each part that is not, with the command that measures it again. Exit code 0: it may.
#
#   deploy/release-check.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

python3 tests/figures/figures.py --check
python3 tests/figures/figures.py --release

#!/usr/bin/env bash
# 1,000 entities of DIS, 10 PDUs a second each, encoded by opendis, to `obliq fly --dis --targets`: each that the kernel did not
# drop is understood, and the world's targets are where their entities said.
#
#   tests/dis_load.sh [--seconds N] [--bin DIR]     default: 30 s, build/release/bin
#
# Prints what was sent, understood and dropped, and the shares of a core. Exit code 77 where opendis cannot be installed.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$here/../build/clients
opendis=$work/env-dis
export PIP_DISABLE_PIP_VERSION_CHECK=1
if [ ! -e "$opendis/installed" ]; then
  rm -rf "$opendis"
  python3 -m venv "$opendis" && "$opendis/bin/pip" install -q opendis==1.0 || {
    echo "skipped: opendis 1.0 cannot be installed"
    exit 77
  }
  touch "$opendis/installed"
fi
recording=$(mktemp)
trap 'rm -f "$recording"' EXIT
"$opendis/bin/python" "$here/exercise/dis_recording.py" "$recording"
bash "$here/python/run.sh" --program "$here/exercise/dis_load.py" "$recording" "$@"

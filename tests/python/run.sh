#!/usr/bin/env bash
# run.sh NAME_test[.CLASS]: tests of the Python package with the first interpreter that can import what it needs.
# run.sh --program FILE [ARGUMENT...]: a program of it.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
needs='import obliq'
# What writes the package's files cannot ask for the package.
if [ "$(basename "${2:-}")" = generate.py ]; then needs='import numpy, google.protobuf'; fi
for python in ${OBLIQ_PYTHON:-} "$here/../../build/clients/venv/bin/python" /usr/bin/python3 python3; do
  if command -v "$python" >/dev/null && PYTHONPATH=$here/../../client/python/src "$python" -c "$needs" 2>/dev/null; then
    if [ "$1" = --program ]; then exec "$python" "${@:2}"; fi
    exec "$python" -W default::ResourceWarning "$here/run.py" "$@"
  fi
done
echo "skipped: no python3 here with numpy, protobuf and a CRC-32C; deploy/install-deps.sh test installs them"
exit 77

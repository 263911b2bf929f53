#!/usr/bin/env bash
# modbus_pymodbus.sh FOLDER HOST PORT: runs modbus_pymodbus.py against a server, with pymodbus from PyPI, which is
# kept in FOLDER. Ends with 77, and says why, when it cannot be had.
set -euo pipefail
version=3.16.1
folder=$1
here=$(cd "$(dirname "$0")" && pwd)
target=$folder/pymodbus-$version
if [ ! -d "$target" ]; then
  fresh=$(mktemp -d "$folder/pymodbus.XXXXXX")
  if ! python3 -m pip install --quiet --disable-pip-version-check --no-deps --timeout 10 --retries 1 \
    --target "$fresh" "pymodbus==$version" >"$fresh.log" 2>&1; then
    echo "pymodbus $version cannot be installed: $(tail -1 "$fresh.log")" >&2
    rm -rf "$fresh" "$fresh.log"
    exit 77
  fi
  rm "$fresh.log"
  mv -T "$fresh" "$target" 2>/dev/null || rm -rf "$fresh" # another one was faster
fi
PYTHONPATH=$target exec python3 "$here/modbus_pymodbus.py" "$here/../../../server/modbus/REGISTERS.md" "$2" "$3"

#!/usr/bin/env bash
# weather_itur.sh FOLDER PROGRAM: compares what weather_table prints with the program itur from PyPI, which is kept in
# FOLDER. Ends with 77, and says why, when it cannot be had.
set -euo pipefail
version=0.4.0
folder=$1
here=$(cd "$(dirname "$0")" && pwd)
target=$folder/itur-$version
if [ ! -d "$target" ]; then
  fresh=$(mktemp -d "$folder/itur.XXXXXX")
  if ! python3 -m pip install --quiet --disable-pip-version-check --timeout 10 --retries 1 \
    --target "$fresh" "itur==$version" >"$fresh.log" 2>&1; then
    echo "itur $version cannot be installed: $(tail -1 "$fresh.log")" >&2
    rm -rf "$fresh" "$fresh.log"
    exit 77
  fi
  rm "$fresh.log"
  mv -T "$fresh" "$target" 2>/dev/null || rm -rf "$fresh" # another one was faster
fi
"$2" | PYTHONPATH=$target python3 "$here/weather_itur.py"

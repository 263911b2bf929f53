#!/usr/bin/env bash
# run.sh NAME_test[.CLASS]: tests of the page with the first interpreter that has Selenium, numpy and protobuf. Where Chromium or
# one of them is missing the exit code is 77.
# run.sh --program FILE [ARGUMENT...]: a program that needs the same.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
for python in ${OBLIQ_PYTHON:-} "$here/../../build/page/venv/bin/python" /usr/bin/python3 python3; do
  if command -v "$python" >/dev/null && "$python" -c 'import selenium, numpy, google.protobuf' 2>/dev/null; then
    if [ "$1" = --program ]; then exec "$python" "${@:2}"; fi
    exec "$python" "$here/run.py" "$@"
  fi
done
echo "skipped: no python3 here with selenium, numpy and protobuf; deploy/install-deps.sh test installs them"
exit 77

#!/usr/bin/env bash
# Writes every file of the tree that is made from others, and lists those that differ from the last commit.
#
#   cmake --build --preset release --target generated     builds the programs, then runs this with their folder
#
# tests/integration/session/session_bytes.txt is among them: read its differences before they go in. The sums of frames
# (tests/accuracy/radar/frame_sums.txt) are not: a change of bits is a decision of its own.
set -euo pipefail
bin=$1
cd "$(dirname "$0")/.."

write() { # FILE COMMAND...: leaves the file alone where the command fails
  local text
  text=$("${@:2}")
  printf '%s\n' "$text" >"$1"
}

write server/control/PARAMETERS.md "$bin/obliq" parameters --markdown
write server/modbus/REGISTERS.md "$bin/obliq" parameters --modbus
bash tests/python/run.sh --program client/python/generate.py --obliq "$bin/obliq"
python3 tests/guide/commands.py --bin "$bin"
python3 client/guide/make_help.py
bash tests/python/run.sh --program server/http/make_types.py
python3 tests/csharp/integers.py
python3 tests/figures/figures.py >/dev/null
OBLIQ_WRITE_SESSION_BYTES=tests/integration/session/session_bytes.txt "$bin/session_bytes_test" --gtest_brief=1 --gtest_filter=SessionBytes.* >/dev/null
git status --short -- '*.md' '*.html' '*.d.ts' client/python/src client/csharp tests/integration/session/session_bytes.txt

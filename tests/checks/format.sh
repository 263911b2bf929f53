#!/usr/bin/env bash
# Every C++ file is as clang-format 14 (Debian 12) writes it. Other versions lay some lines out differently.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tests/checks/source_files.sh

tool=$(command -v clang-format-14 || command -v clang-format)
if ! "$tool" --version | grep -q 'version 14\.'; then
  echo "skipped: $("$tool" --version), need version 14"
  exit 77
fi
mapfile -t files < <(source_files h cpp)
[ ${#files[@]} -gt 0 ]
"$tool" --dry-run -Werror "${files[@]}"
echo "${#files[@]} files are formatted"

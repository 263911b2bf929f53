#!/usr/bin/env bash
# One idea a file: none is longer than 400 lines, but for the list of messages, which has a line for each field,
# and what a program writes from it. README.md and CHANGES.md are read in one sitting: 200 and 90 lines.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tests/checks/source_files.sh

mapfile -t files < <(source_files h cpp sh py | xargs grep -L '^"""[^"]* Written by [a-z_]*\.py: do not edit\.')
[ ${#files[@]} -gt 0 ]
long=$(wc -l "${files[@]}" | awk '$2 != "total" && $1 > 400 {print $2 ": " $1 " lines; allowed: 400"}')
if [ -n "$long" ]; then
  echo "$long"
  exit 1
fi
long=$(wc -l README.md CHANGES.md | awk '$2 == "README.md" && $1 > 200 || $2 == "CHANGES.md" && $1 > 90 {print $2 ": " $1 " lines; allowed: " ($2 == "README.md" ? 200 : 90)}')
if [ -n "$long" ]; then
  echo "$long"
  exit 1
fi
echo "${#files[@]} files are short enough"

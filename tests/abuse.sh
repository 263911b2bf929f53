#!/usr/bin/env bash
# A minute of hostile peers against obliqd, with a watcher beside them: the largest polar frame, jumps of an antenna,
# places held by connections that say nothing, a flood of TLS handshakes with an RSA-4096 certificate, odd messages.
#
#   tests/abuse.sh [--bin DIR] [--seconds S]     S: of each of the five, default 9; DIR: default build/release/bin
#
# Fails when the watcher gets less than half its frames, when memory exceeds server.max_memory_mb, when a good token does
# not get in, when terrain is loaded without end, or when obliqd ends. Ends with 77 where there is no python3-protobuf.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
for need in protoc openssl; do
  command -v "$need" >/dev/null || { echo "abuse.sh: $need is not installed (deploy/install-deps.sh test)" >&2; exit 77; }
done
# The system's Python has protobuf; another one in the path may not.
for python in python3 /usr/bin/python3; do
  "$python" -c 'import google.protobuf' 2>/dev/null || continue
  exec "$python" -B tests/abuse/abuse.py "$@"
done
echo "abuse.sh: no python3-protobuf here (deploy/install-deps.sh test)" >&2
exit 77

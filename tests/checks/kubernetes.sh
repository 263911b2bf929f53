#!/usr/bin/env bash
# The protected overlay of deploy/kubernetes: obliqd takes its arguments, with what first-start.sh makes in the place of the
# Secrets, and answers its probes, Prometheus and nobody else. With kubectl also: the overlay is built, and nothing of the open
# daemon is left in it.
#
#   tests/checks/kubernetes.sh [FOLDER_WITH_PROGRAMS]
set -euo pipefail
cd "$(dirname "$0")/../.."
programs=${1-build/release/bin}
for tool in "$programs/obliqd" openssl curl; do
  command -v "$tool" >/dev/null || {
    echo "skipped: no $tool"
    exit 77
  }
done
work=$(mktemp -d)
daemon=""
trap '[ -z "$daemon" ] || kill "$daemon"; rm -rf "$work"' EXIT
fail() {
  echo "$*"
  exit 1
}

deploy/first-start.sh "$work" >/dev/null
mapfile -t arguments < <(sed -n 's/^ *- \(--[a-z]*=.*\)/\1/p' deploy/kubernetes/protected/deployment.yaml |
  sed "s,/scene/scene.toml,$work/scene.toml,; s,/secrets/tls/tls,$work/server/server,; s,/secrets/tokens,$work/server,; \
    s,0\.0\.0\.0,127.0.0.1,; s,\$(NAMESPACE),radars,g")
[ ${#arguments[@]} -ge 6 ] || fail "found ${#arguments[@]} arguments in protected/deployment.yaml"
printf '[terrain]\nsynthetic = "flat"\n' >"$work/scene.toml"
"$programs/obliqd" "${arguments[@]}" --port 0 --set http.port=0 >"$work/log" 2>&1 &
daemon=$!
for _ in $(seq 600); do
  port=$(sed -n 's/.*HTTP on 127.0.0.1:\([0-9]*\): .*/\1/p' "$work/log")
  [ -z "$port" ] || break
  kill -0 "$daemon" 2>/dev/null || fail "obliqd ended: $(cat "$work/log")"
  sleep 0.1
done
# expect CODE PATH CURL_OPTION...
expect() {
  local code=$1 path=$2 found
  shift 2
  found=$(curl -s -o "$work/answer" -w '%{http_code}' --cacert "$work/client/ca.crt" "$@" "https://127.0.0.1:$port$path" || true)
  [ "$found" = "$code" ] || fail "$path $*: found $found; allowed: $code; $(cat "$work/answer" "$work/log")"
}
expect 200 /healthz
token="Authorization: Bearer $(cat "$work/scrape/viewer.token")"
for name in obliqd obliqd.radars obliqd.radars.svc obliqd.radars.svc.cluster.local; do
  expect 200 /metrics -H "$token" -H "Host: $name:7480"
done
expect 403 /metrics -H "$token" -H "Host: obliqd.elsewhere.svc:7480"
expect 401 /metrics
echo "obliqd takes the overlay's arguments and answers its probes and Prometheus"

if command -v kubectl >/dev/null; then
  kubectl kustomize deploy/kubernetes/protected >"$work/built.yaml"
  ! grep -n unprotected "$work/built.yaml" || fail "the overlay is open"
  [ "$(grep -c 'scheme: HTTPS$' "$work/built.yaml")" -eq 3 ] || fail "a probe of the overlay speaks HTTP"
  for kind in Service Deployment NetworkPolicy ServiceMonitor; do
    [ "$(grep -c "^kind: $kind\$" "$work/built.yaml")" -eq 1 ] || fail "the overlay has no $kind"
  done
  echo "kubectl builds it"
fi

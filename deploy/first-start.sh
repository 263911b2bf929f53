#!/usr/bin/env bash
# Makes what a protected obliqd needs: a certificate authority of its own, a server certificate, one token for
# each role, a password for the dashboards. What exists stays as it is; safe to run at every start.
#
#   deploy/first-start.sh FOLDER [--owner USER[:GROUP]] [--name HOST_OR_ADDRESS]...
#
# --owner: the user that obliqd runs as (as root only). --name: how clients call this machine; localhost,
# obliqd and this host's name are always in the certificate.
set -euo pipefail
umask 077

die() {
  echo "first-start: $*" >&2
  exit 1
}
usage() {
  sed -n '2,8s/^# \{0,1\}//p' "$0"
}

folder=""
owner=""
names=(localhost 127.0.0.1 ::1 obliqd)
here=$(uname -n)
[ "$here" = localhost ] || names+=("$here")
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help)
      usage
      exit 0
      ;;
    --owner | --name)
      [ $# -ge 2 ] || die "$1 needs a value"
      [ "$1" = --owner ] && owner=$2 || names+=("$2")
      shift
      ;;
    -*) die "unknown option '$1'" ;;
    *)
      [ -z "$folder" ] || die "one folder only (found '$1')"
      folder=$1
      ;;
  esac
  shift
done
[ -n "$folder" ] || die "needs a folder (--help)"
command -v openssl >/dev/null || die "'openssl' is not installed"
for name in "${names[@]}"; do
  [[ $name =~ ^[A-Za-z0-9.:*-]+$ ]] || die "'$name' is no host name or address"
done

days_authority=3650
days_server=825
warn_days=30

authority=$folder/authority # signs; nothing that runs needs it
server=$folder/server       # obliqd's: certificate, key, tokens
scrape=$folder/scrape       # the metrics' collector's: the authority's certificate, a viewer's token
client=$folder/client       # what obliq needs: the same certificate, a viewer's token of its own
console=$folder/console     # the dashboards' password
# A folder made here may be entered by all, so that the service's user gets to its part of it; the parts are closed.
(umask 022 && mkdir -p "$folder")
for part in "$authority" "$server" "$scrape" "$client" "$console"; do
  mkdir -p "$part"
  chmod 0750 "$part"
done

# publish NEW FILE MODE: under its name only once it is whole, so that a run cut short leaves nothing half made.
made=()
publish() {
  chmod "$3" "$1"
  [ -z "$owner" ] || [ "${2%/*}" = "$authority" ] || chown "$owner" "$1"
  mv "$1" "$2"
  made+=("$2")
}
random_text() {
  openssl rand -hex 32
}

if [ ! -e "$authority/ca.crt" ]; then
  openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days "$days_authority" \
    -subj "/CN=obliq authority of $here" -addext basicConstraints=critical,CA:TRUE,pathlen:0 \
    -addext keyUsage=critical,keyCertSign,cRLSign \
    -keyout "$authority/ca.key.new" -out "$authority/ca.crt.new" 2>/dev/null || die "openssl could not make an authority"
  publish "$authority/ca.key.new" "$authority/ca.key" 0600
  publish "$authority/ca.crt.new" "$authority/ca.crt" 0644
fi
for part in "$scrape" "$client"; do
  [ -e "$part/ca.crt" ] && continue
  cp "$authority/ca.crt" "$part/ca.crt.new"
  publish "$part/ca.crt.new" "$part/ca.crt" 0644
done

if [ ! -e "$server/server.crt" ]; then
  alternative=""
  for name in "${names[@]}"; do
    if [[ $name =~ ^[0-9.]+$ || $name == *:* ]]; then kind=IP; else kind=DNS; fi
    alternative+="${alternative:+,}$kind:$name"
  done
  openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj "/CN=obliqd" \
    -keyout "$server/server.key.new" -out "$server/request.new" 2>/dev/null || die "openssl could not make a key"
  printf '%s\n' "subjectAltName=$alternative" basicConstraints=critical,CA:FALSE \
    keyUsage=critical,digitalSignature extendedKeyUsage=serverAuth >"$server/extensions.new"
  openssl x509 -req -in "$server/request.new" -CA "$authority/ca.crt" -CAkey "$authority/ca.key" \
    -set_serial "0x00$(openssl rand -hex 8)" -days "$days_server" -sha256 -extfile "$server/extensions.new" \
    -out "$server/server.crt.new" 2>/dev/null || die "openssl could not sign the server's certificate"
  rm "$server/request.new" "$server/extensions.new"
  publish "$server/server.key.new" "$server/server.key" 0600
  publish "$server/server.crt.new" "$server/server.crt" 0644
fi

if [ ! -e "$server/tokens" ]; then
  collector=$(random_text)
  viewer=$(random_text)
  {
    echo "# ROLE TOKEN NAME. obliqd reads it again on SIGHUP."
    echo "admin $(random_text) first-start"
    echo "controller $(random_text) first-start"
    echo "viewer $collector prometheus"
    echo "viewer $viewer first-start"
  } >"$server/tokens.new"
  echo "$collector" >"$scrape/viewer.token.new"
  echo "$viewer" >"$client/viewer.token.new"
  # The collector is another user and reads by its group; obliq warns of a token that others than its owner may read.
  publish "$scrape/viewer.token.new" "$scrape/viewer.token" 0640
  publish "$client/viewer.token.new" "$client/viewer.token" 0600
  publish "$server/tokens.new" "$server/tokens" 0600
fi
if [ ! -e "$console/password" ]; then
  random_text >"$console/password.new"
  publish "$console/password.new" "$console/password" 0640
fi

if [ -n "$owner" ]; then
  chown "$owner" "$server" "$scrape" "$client" "$console"
fi
for file in "${made[@]}"; do
  echo "first-start: made $file"
done
[ ${#made[@]} -gt 0 ] || echo "first-start: everything is in $folder already"
cat <<TEXT
first-start: tokens for admin, controller and viewer: $server/tokens
first-start: clients check the server by:              $client/ca.crt
first-start: the dashboards' password (user admin):    $console/password
TEXT
# None where the tokens are older than this folder.
[ ! -e "$client/viewer.token" ] || echo "first-start: a viewer's token for clients:              $client/viewer.token"
if ! openssl x509 -in "$server/server.crt" -noout -checkend $((warn_days * 86400)) >/dev/null; then
  echo "first-start: $server/server.crt ends within $warn_days days; remove it and run this again to renew it" >&2
fi

#!/usr/bin/env bash
# Proves packages and wheels in clean roots that debootstrap makes: the packages are installed by apt, render, serve, are upgraded
# while they serve, removed without leftovers; the wheels are installed where there is no compiler and render made-up and
# real ground. Says how long it takes from nothing to a picture.
#
#   deploy/check-packages.sh [bookworm|trixie] [packages] [wheel]      default: bookworm, both
#
# Needs root and this machine's build (build/release). Packages are for the release that they are made on: on another than this
# machine's the sources are built in its root first. The wheels are made here, by deploy/server-wheel.sh and build-wheel.sh.
# The roots stay in $OBLIQ_IMAGES (default: obliq-images in $TMPDIR or /var/tmp); `deploy/build-image.sh clean` removes them.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/image-store.sh"
. "$(dirname "${BASH_SOURCE[0]}")/clean-root.sh"
. "$(dirname "${BASH_SOURCE[0]}")/packages-proof.sh"
cd "$root"

suite=bookworm
parts=""
for word in "$@"; do
  case "$word" in
    bookworm | trixie) suite=$word ;;
    packages | wheel) parts+=" $word" ;;
    *) usage "$word" ;;
  esac
done
as_root
deploy/install-deps.sh image package demo
need debootstrap unshare
clean=$store/clean-$suite
mkdir -p "$store"
if [ ! -e "$clean.done" ]; then
  step "clean root of $suite"
  clean_root "$suite" "$clean"
  touch "$clean.done"
fi
scratch=$(mktemp -d "$store/packages.XXXXXX")
trap 'rm -rf --one-file-system "$scratch"' EXIT

# The packages in $scratch/old: of this machine's build, or built in a root of the other release.
make_packages() {
  if [ "$(. /etc/os-release && echo "${VERSION_CODENAME-}")" = "$suite" ]; then
    deploy/packages.sh --out "$scratch/old"
    return
  fi
  step "build on $suite"
  mkdir "$scratch/source" "$scratch/old"
  git archive HEAD | tar -x -C "$scratch/source"
  cat >"$scratch/steps.sh" <<STEPS
set -eu
cd /mnt/source
apt-get -q update && deploy/install-deps.sh build package
cmake --preset release -DOBLIQ_TESTS=OFF
cmake --build --preset release --parallel ${OBLIQ_JOBS:-$(parallel_jobs)} --target obliqd obliq obliq_shared
deploy/packages.sh --out /mnt/old --version $(project_version)
STEPS
  deploy/in-overlay.sh "$clean" "$scratch" >"$scratch/build.log" 2>&1 || {
    tail -n 40 "$scratch/build.log"
    die "obliq could not be built on $suite"
  }
  rm -rf "$scratch/source"
}

check_packages() {
  make_packages
  step "packages on $suite"
  newer "$scratch/old" "$scratch/new"
  proof "apt-get -q update && apt-get -q install -y --no-install-recommends" >"$scratch/steps.sh"
  deploy/in-overlay.sh "$clean" "$scratch"
  # Debian's custom: a package's user stays. Logs of apt and dpkg name every package.
  if grep obliq "$scratch/changed" | grep -v '^\./var/\(log\|lib/dpkg\|lib/apt\|cache\)/'; then die "purged packages left these"; fi
  [ "$(grep -c obliq "$scratch/etc/passwd")" -eq 1 ] || die "/etc/passwd has not one line of the user obliq"
}

check_wheel() {
  local wheels=(out/wheel/obliq_server-*.whl) tile python
  [ -e "${wheels[0]}" ] || die "no out/wheel/obliq_server-*.whl: run deploy/server-wheel.sh first"
  step "wheels on $suite"
  mkdir "$scratch/wheels"
  PYTHON=/usr/bin/python3 deploy/build-wheel.sh --out "$scratch/wheels" >/dev/null
  cp "${wheels[-1]}" "$scratch/wheels/"
  [ "$suite" = bookworm ] && python=3.11 || python=3.13
  python3 -m pip download -q --only-binary :all: --implementation cp --python-version "$python" --dest "$scratch/wheels" \
    --platform "manylinux_2_28_$(uname -m)" --platform "manylinux_2_27_$(uname -m)" --platform "manylinux2014_$(uname -m)" \
    "$scratch"/wheels/obliq-*.whl
  tile=$(deploy/fetch-demo-terrain.sh)
  cp "$tile" "$scratch/ground.tif"
  cat >"$scratch/scene.toml" <<'TOML'
[terrain]
dem = ["/mnt/ground.tif"]
[antenna]
height_m = 2000.0
height_reference = "ground"
[radar]
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = 12000.0
TOML
  cat >"$scratch/steps.sh" <<'STEPS'
set -eu
fail() { echo "$*"; exit 1; }
began=$(date +%s)
apt-get -q update >/tmp/log
apt-get -q install -y --no-install-recommends python3 python3-venv >/tmp/log 2>&1
if command -v cc gcc c++ g++ clang; then fail "a compiler is here"; fi
python3 -m venv /tmp/venv
/tmp/venv/bin/pip install -q --no-index --find-links /mnt/wheels obliq obliq-server
cd /tmp
/tmp/venv/bin/python3 -m obliq.demo out.png
echo "from nothing to a picture: $(($(date +%s) - began)) s"
cat >three.py <<'PYTHON'
import obliq
with obliq.local("/mnt/scene.toml") as server:
    server.radar().frame().save("real.png")
PYTHON
/tmp/venv/bin/python3 three.py
[ "$(stat -c %s real.png)" -gt 20000 ]
cp out.png real.png /mnt/
/tmp/venv/bin/obliqd --version
/tmp/venv/bin/obliq render /mnt/scene.toml --out frame >log 2>&1
[ -s frame/ground_map.png ]
[ -s frame/ground_map.tif ]
if grep -i 'fontconfig\|proj' log; then fail "a library misses its files"; fi
/tmp/venv/bin/pip uninstall -q -y obliq obliq-server
[ -z "$(find /tmp/venv -iname '*obliq*')" ] || fail "uninstalled, it left $(find /tmp/venv -iname '*obliq*')"
STEPS
  deploy/in-overlay.sh "$clean" "$scratch"
  mkdir -p out/check-packages
  cp "$scratch"/{out,real}.png out/check-packages/
}

for part in ${parts:-packages wheel}; do "check_$part"; done
step_end
echo "check-packages: $suite:${parts:- packages wheel}: all as it should be"

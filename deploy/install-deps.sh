#!/usr/bin/env bash
# Installs the Debian packages that obliq needs, and only those that are missing: a second run touches no
# network and asks for no rights.
#
#   deploy/install-deps.sh [build] [test] [package] [fuzz] [demo] [image] [wheel] [windows]      default: build
set -euo pipefail

build_packages=(
  build-essential g++ cmake ninja-build pkg-config git python3
  ccache mold                                                  # nothing is compiled twice, and links are quick
  libembree-dev libtbb-dev                                     # ray tracing
  libgdal-dev libgeos-dev libgeographiclib-dev gdal-bin        # terrain and buildings
  libglm-dev libopenexr-dev libcairo2-dev libpng-dev fonts-dejavu-core    # matrices and pictures
  libboost-dev libprotobuf-dev protobuf-compiler libisal-dev   # the wire
  libssl-dev libzstd-dev libmodbus-dev                         # TLS, compression, the operator's console
  prometheus-cpp-dev libsystemd-dev                            # metrics, readiness
  libtomlplusplus-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libxxhash-dev
)
test_packages=(
  libgtest-dev libbenchmark-dev
  libcgal-dev libgmp-dev libmpfr-dev                           # the independent ray tracer
  clang clang-format
  python3 python3-numpy python3-matplotlib python3-pip python3-venv python3-protobuf python3-crc32c
  mono-mcs mono-runtime libmono-system-runtime-serialization4.0-cil    # the C# client
  mbpoll openssl curl socat tshark                             # clients from elsewhere
  libfaketime iptables iproute2                                # clocks that jump, networks that swallow packets
  chromium chromium-driver                                     # the page, with Selenium (below)
)
package_packages=(debhelper dh-python fakeroot lintian python3 python3-hatchling python3-pip    # packages.sh
  systemd procps)                                              # what the packages need, for tests/debs.sh
wheel_packages=(dpkg-dev patchelf sqlite3 libjson-c-dev liblzma-dev libsqlite3-dev)             # server-wheel.sh
windows_packages=(g++-mingw-w64-x86-64-posix wine wine64 nasm dpkg-dev perl)                    # tests/windows.sh
fuzz_packages=(clang libclang-rt-dev)                         # libFuzzer and the sanitizers
image_packages=(buildah debootstrap python3 python3-numpy)     # build-image.sh, check-image.sh
demo_packages=(gdal-bin python3 python3-pip ca-certificates)

die() {
  echo "install-deps: $*" >&2
  exit 1
}

wanted=()
[ $# -gt 0 ] || set -- build
groups=$*
for group in "$@"; do
  case "$group" in
    build) wanted+=("${build_packages[@]}") ;;
    test) wanted+=("${test_packages[@]}") ;;
    package) wanted+=("${package_packages[@]}") ;;
    wheel) wanted+=("${wheel_packages[@]}") ;;
    windows) wanted+=("${windows_packages[@]}") ;;
    fuzz) wanted+=("${fuzz_packages[@]}") ;;
    image) wanted+=("${image_packages[@]}") ;;
    demo) wanted+=("${demo_packages[@]}") ;;
    -h | --help)
      sed -n '2,5s/^# \{0,1\}//p' "$0"
      exit 0
      ;;
    *) die "unknown group '$group'; allowed: build, test, package, fuzz, demo, image, wheel, windows" ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  die "this machine has no apt. obliq is built and tested on Debian 12; elsewhere install the equivalents of: ${wanted[*]}"
fi

# Selenium, which Debian 12 has only in an older version, for the tests of the page: into build/page/venv, beside the numpy and
# protobuf of Debian's own python3, which another one in the PATH would not see.
install_selenium() {
  case " $groups " in *" test "*) ;; *) return 0 ;; esac
  local venv
  venv=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/build/page/venv
  if "$venv/bin/python" -c 'import selenium, numpy, google.protobuf' 2>/dev/null; then return 0; fi
  echo "install-deps: selenium into $venv"
  /usr/bin/python3 -m venv --clear --system-site-packages "$venv" && "$venv/bin/pip" install -q 'selenium>=4.40,<5' </dev/null ||
    echo "install-deps: no selenium (does the Python package registry answer?): the page's tests will be skipped" >&2
}

# TypeScript, which checks the types of the page's modules, into build/typescript. Debian's npm would bring some hundred packages. So
# a machine with node and npm gets it; elsewhere those tests are skipped.
install_typescript() {
  case " $groups " in *" test "*) ;; *) return 0 ;; esac
  local version=5.9.3 folder
  folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/build/typescript
  if grep -qs "\"version\": \"$version\"" "$folder/node_modules/typescript/package.json"; then return 0; fi
  echo "install-deps: typescript $version into $folder"
  command -v npm >/dev/null && npm install --silent --no-audit --no-fund --prefix "$folder" "typescript@$version" </dev/null ||
    echo "install-deps: no typescript (is npm there, does its registry answer?): checks of the page's types will be skipped" >&2
}

# dpkg-query fails when any name is unknown to it, yet still prints the others.
installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null |
  awk '$2 == "installed" {print $1}' || true)
mapfile -t missing < <(comm -13 <(sort -u <<<"$installed") <(printf '%s\n' "${wanted[@]}" | sort -u))
if [ ${#missing[@]} -eq 0 ]; then
  echo "install-deps: nothing to install ($*)"
  install_selenium
  install_typescript
  exit 0
fi
echo "install-deps: missing: ${missing[*]}"

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null ||
    die "not root and no sudo here. As root, run: apt-get install ${missing[*]}"
  as_root=(sudo)
  [ -t 0 ] || as_root=(sudo -n) # no terminal for a password
  "${as_root[@]}" true ||
    die "sudo was refused. As root, run: apt-get install ${missing[*]}"
fi

apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 "$@" </dev/null
}
install_missing() {
  apt install -y -q --no-install-recommends "${missing[@]}"
}

if ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then
  apt update -q || die "apt-get update failed: is a Debian mirror within reach?"
fi
if ! install_missing; then
  echo "install-deps: the package lists may be old; fetching them and trying once more" >&2
  apt update -q || die "apt-get update failed: is a Debian mirror within reach?"
  install_missing || die "apt-get could not install: ${missing[*]}"
fi
install_selenium
install_typescript

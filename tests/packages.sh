#!/usr/bin/env bash
# `cmake --install` of a built tree into a scratch root, and a program of a user's that is built against what lies there: by
# pkg-config and by find_package. Nothing of obliq is compiled.
#
#   tests/packages.sh [--build DIR]          default: build/release; it was configured with BUILD_SHARED_LIBS
set -euo pipefail
. "$(dirname "$0")/../deploy/common.sh"
cd "$root"
build=build/release
[ "${1:-}" != --build ] || build=$2
for file in bin/obliq bin/obliqd client/libobliq.so; do
  [ -e "$build/$file" ] || {
    echo "skipped: $build/$file is not built"
    exit 77
  }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
DESTDIR=$scratch/stage cmake --install "$build" --prefix /opt/obliq >"$scratch/log"
there=$scratch/stage/opt/obliq
# Every kind of file is there.
for file in bin/obliqd bin/obliq bin/obliq-first-start lib/systemd/system/obliqd.service lib/systemd/system/obliq-cat240@.service \
  lib/sysusers.d/obliq.conf share/man/man1/obliqd.1 share/man/man1/obliq-watch.1 share/bash-completion/completions/obliq \
  share/zsh/vendor-completions/_obliq share/obliq/scenes/demo_hills.toml share/obliq/presets/marine_x.toml share/doc/obliq/LICENSE share/doc/obliq/PAPER.md \
  share/doc/obliq/THIRD_PARTY.md share/doc/obliq/obliq.spdx.json include/obliq/client/client.h include/obliq/proto/obliq.pb.h; do
  [ -e "$there/$file" ] || {
    echo "not installed: $file"
    exit 1
  }
done
# Nothing lies elsewhere, nothing names the build tree, and units name the programs where they are.
[ "$(ls "$scratch/stage")" = opt ]
if grep -rIl "$PWD" "$there"; then
  echo "these files name the build tree"
  exit 1
fi
grep -qx 'ExecStart=/opt/obliq/bin/obliqd --config /etc/obliq/obliqd.toml' "$there/lib/systemd/system/obliqd.service"
library=$(dirname "$(find "$there" -name libobliq.so)")
if readelf -d "$there/bin/obliqd" "$library/libobliq.so" | grep -E 'RPATH|RUNPATH'; then exit 1; fi
"$there/bin/obliq" --version
# The SBOM is of this version, of libraries that the programs load and those that these need, with the licences of THIRD_PARTY.md.
/usr/bin/python3 - "$there/share/doc/obliq/obliq.spdx.json" "$("$there/bin/obliq" --version)" <<'PYTHON'
import json, re, sys
told = json.load(open(sys.argv[1], encoding="utf-8"))
packages = {package["SPDXID"]: package for package in told["packages"]}
assert told["spdxVersion"] == "SPDX-2.3" and len(packages) == len(told["packages"]) > 20
assert "obliq " + packages["SPDXRef-obliq"]["versionInfo"] == sys.argv[2], (packages["SPDXRef-obliq"], sys.argv[2])
assert all(re.fullmatch("SPDXRef-[A-Za-z0-9.-]+", each) for each in packages)
edges = [(edge["spdxElementId"], edge["relatedSpdxElement"]) for edge in told["relationships"]]
assert all(end in packages or end == "SPDXRef-DOCUMENT" for edge in edges for end in edge)
reached = {"SPDXRef-DOCUMENT"}
while more := {b for a, b in edges if a in reached} - reached:
    reached |= more
assert reached >= packages.keys(), packages.keys() - reached
direct = [packages[b] for a, b in edges if a == "SPDXRef-obliq"]
assert all(package["licenseDeclared"] != "NOASSERTION" for package in direct), direct
assert any(package["name"].startswith("libgdal") and package["licenseDeclared"] == "MIT" for package in direct)
PYTHON
# A page for each command, and completion that knows its options.
for command in $("$there/bin/obliq" --help | sed -n '/^Subcommands/,$s/^  \([a-z0-9]*\) .*/\1/p'); do
  grep -q "^\.SH NAME" "$there/share/man/man1/obliq-$command.1"
done
completed=$(bash -c ". '$there/share/bash-completion/completions/obliq'; COMP_WORDS=(obliq watch --loss); COMP_CWORD=2; _obliq; echo \"\${COMPREPLY[*]}\"")
[ "$completed" = --lossless ]

readelf -d "$library/libobliq.so" | grep -q 'soname: \[libobliq.so.0\]'
export PKG_CONFIG_PATH=$library/pkgconfig
cat >"$scratch/main.cpp" <<'CPP'
#include <obliq/client/client.h>
#include <obliq/proto/obliq.pb.h>

#include <cstdio>

int main() {
  obliq::client::Client server;
  const obliq::client::Status status = server.connect(*obliq::client::parse_endpoint("127.0.0.1:1"));
  std::printf("%s\n", status.ok() ? "connected" : "refused");
  return status.ok() ? 1 : 0;
}
CPP
[ "$(pkg-config --modversion obliq)" = "$(project_version)" ]
# shellcheck disable=SC2046
g++ -std=c++20 "$scratch/main.cpp" -o "$scratch/by_pkg_config" $(pkg-config --define-variable=prefix="$there" --cflags --libs obliq)
mkdir "$scratch/project"
cat >"$scratch/project/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.20)
project(user LANGUAGES CXX)
find_package(obliq 0.1 REQUIRED)
add_executable(user ../main.cpp)
target_link_libraries(user PRIVATE obliq::client)
CMAKE
cmake -S "$scratch/project" -B "$scratch/project/build" "-DCMAKE_PREFIX_PATH=$there" >>"$scratch/log" &&
  cmake --build "$scratch/project/build" >>"$scratch/log" || {
  tail -30 "$scratch/log"
  exit 1
}
[ "$(LD_LIBRARY_PATH=$library "$scratch/by_pkg_config")" = refused ]
[ "$(LD_LIBRARY_PATH=$library "$scratch/project/build/user")" = refused ]
echo "installed, and a user's program is built and runs by pkg-config and by find_package"

#!/usr/bin/env python3
"""check.py WHEEL: whether the wheel of the programs is what it says it is. Every library in it has a row below, none is under
the GPL; what they need is in the wheel or part of every machine with glibc 2.36; it has at most 80 MB. Needs readelf."""
from __future__ import annotations

import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

MOST_BYTES = 80_000_000
GLIBC, GLIBCXX = (2, 36), (3, 4, 30)  # Debian 12's
# What a manylinux wheel may take from the machine (PEP 600), of what the programs use.
OF_THE_SYSTEM = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libstdc++.so.6", "libgcc_s.so.1",
                 "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
# SPDX, by the start of a library's name; where there is a choice, what we choose.
LICENCES = {
    "libGeographicLib": "MIT", "libIex": "BSD-3-Clause", "libIlmThread": "BSD-3-Clause", "libImath": "BSD-3-Clause",
    "libOpenEXR": "BSD-3-Clause", "libX11": "MIT", "libXau": "MIT", "libXdmcp": "MIT", "libXext": "MIT", "libXrender": "MIT",
    "libbrotli": "MIT", "libbsd": "BSD-3-Clause", "libcairo": "MPL-1.1", "libcap": "BSD-3-Clause", "libcrypto": "Apache-2.0",
    "libembree": "Apache-2.0", "libexpat": "MIT", "libfmt": "MIT", "libfontconfig": "MIT", "libfreetype": "FTL",
    "libgcrypt": "LGPL-2.1-or-later", "libgdal": "MIT", "libgeos": "LGPL-2.1-or-later", "libgpg-error": "LGPL-2.1-or-later",
    "libisal": "BSD-3-Clause", "libjson-c": "MIT", "liblz4": "BSD-2-Clause", "liblzma": "0BSD", "libmd": "BSD-3-Clause",
    "libmodbus": "LGPL-2.1-or-later", "libpixman": "MIT", "libpng": "libpng-2.0", "libproj": "MIT",
    "libprometheus-cpp": "MIT", "libprotobuf": "BSD-3-Clause", "libspdlog": "MIT", "libsqlite3": "blessing", "libssl": "Apache-2.0",
    "libsystemd": "LGPL-2.1-or-later", "libtbb": "Apache-2.0", "libtiff": "libtiff", "libtomlplusplus": "MIT", "libxcb": "MIT",
    "libxxhash": "BSD-2-Clause", "libz": "Zlib", "libzstd": "BSD-3-Clause",
}


def licence(name: str) -> str | None:
    """By the longest row that the name starts with, up to a digit, a dot or a dash: libz is not libzstd."""
    fitting = [row for row in LICENCES if re.match(re.escape(row) + r"([-.\d]|common|dec|_c|$)", name)]
    return LICENCES[max(fitting, key=len)] if fitting else None


def faults_of(path: pathlib.Path, inside: set[str]) -> list[str]:
    """Of a program or library."""
    text = subprocess.run(["readelf", "--wide", "-d", "-V", path], check=True, capture_output=True, text=True).stdout
    found = [f"{path.name} needs {name}, which is neither in the wheel nor on every machine"
             for name in re.findall(r"\(NEEDED\).*\[(.*)\]", text) if name not in inside | OF_THE_SYSTEM]
    found += [f"{path.name} looks for libraries in {entry}; allowed: beside itself"
              for entries in re.findall(r"\(R(?:UN)?PATH\).*\[(.*)\]", text) for entry in entries.split(":")
              if not entry.startswith("$ORIGIN")]
    for name, most in (("GLIBC", GLIBC), ("GLIBCXX", GLIBCXX)):
        for version in set(re.findall(rf"Name: {name}_([\d.]+)", text)):
            if tuple(map(int, version.split("."))) > most:
                found.append(f"{path.name} needs {name}_{version}; allowed: up to {'.'.join(map(str, most))}")
    return found


def faults(wheel: pathlib.Path) -> list[str]:
    found = []
    if wheel.stat().st_size > MOST_BYTES:
        found.append(f"{wheel.stat().st_size} bytes; allowed: {MOST_BYTES}")
    with tempfile.TemporaryDirectory() as scratch, zipfile.ZipFile(wheel) as archive:
        archive.extractall(scratch)
        root = pathlib.Path(scratch, "obliq_server")
        libraries = sorted((root / "lib").iterdir())
        inside = {path.name for path in libraries}
        for path in libraries:
            spdx = licence(path.name)
            if spdx is None:
                found.append(f"{path.name}: its licence is not in {pathlib.Path(__file__).name}")
            elif spdx.startswith(("GPL", "AGPL")):
                found.append(f"{path.name}: {spdx}")
        for must in ("libembree", "libtbb", "libgdal", "libproj", "libgeos"):
            if not any(name.startswith(must) for name in inside):
                found.append(f"{must} is not in it")
        for must in ("bin/obliqd", "bin/obliq", "share/proj/proj.db"):
            if not (root / must).is_file():
                found.append(f"{must} is not in it")
        for path in [*libraries, *(root / "bin").iterdir()]:
            found += faults_of(path, inside)
    return found


def main() -> int:
    wheel = pathlib.Path(sys.argv[1])
    found = faults(wheel)
    print("\n".join(f"{wheel.name}: {fault}" for fault in found) or
          f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, no GPL library, needs nothing but glibc 2.36 and libstdc++")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

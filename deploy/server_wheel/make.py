#!/usr/bin/env python3
"""Puts programs, the libraries that they need, and what those read into a wheel; deploy/server-wheel.sh calls it.

    make.py --stage DIR --lean DIR --sources DIR --version V --out DIR

--stage: where the programs were installed (prefix usr). --lean: libraries that go before Debian's. --sources: the source
packages that those were built from, for their licences. Needs patchelf, readelf, dpkg.
"""
from __future__ import annotations

import argparse
import base64
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile

import check

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(os.fspath(HERE.parent))
import sbom  # noqa: E402

FONTS = pathlib.Path("/usr/share/fonts/truetype/dejavu")
FONTS_CONF = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">
<fontconfig><dir prefix="relative">.</dir><cachedir prefix="xdg">fontconfig</cachedir></fontconfig>
"""
METADATA = """Metadata-Version: 2.1
Name: obliq-server
Version: {version}
Summary: obliqd and obliq, the radar ground-map simulator, as programs with all libraries that they need
License: Apache-2.0; the libraries' own licences are in dist-info/licenses
Requires-Python: >=3.10
Description-Content-Type: text/markdown

`obliqd` and `obliq` for machines with glibc 2.36 or later; `obliq.local()` of the package obliq finds them. The libraries are
shared ones in `obliq_server/lib`: any of them may be replaced by another build of the same name.
"""
ENTRY_POINTS = "[console_scripts]\nobliqd = obliq_server:obliqd\nobliq = obliq_server:obliq\n"


def run(*words: str | os.PathLike[str], **more: str) -> str:
    return subprocess.run(words, check=True, capture_output=True, text=True, env={**os.environ, **more}).stdout


def closure(programs: list[pathlib.Path], lean: pathlib.Path) -> dict[str, pathlib.Path]:
    """Libraries by the names that programs and libraries call them by, but for those of every glibc machine."""
    found: dict[str, pathlib.Path] = {}
    for program in programs:
        listed = run("ldd", program, LD_LIBRARY_PATH=os.fspath(lean / "lib"))
        if "not found" in listed:
            raise SystemExit(f"{program}: {listed}")
        found |= {name: pathlib.Path(path) for name, path in re.findall(r"(\S+) => (/\S+)", listed)}
    return {name: path for name, path in found.items() if name not in check.OF_THE_SYSTEM}


def fill(package: pathlib.Path, licences: pathlib.Path, asked: argparse.Namespace) -> None:
    usr = asked.stage / "usr"
    shutil.copytree(HERE / "obliq_server", package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "bin").mkdir()
    (package / "lib").mkdir()
    licences.mkdir(parents=True)
    shutil.copy(usr / "share/doc/obliq/LICENSE", licences / "obliq")
    programs = [usr / "bin/obliqd", usr / "bin/obliq"]
    for program in programs:
        to = shutil.copy(program, package / "bin")
        run("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/../lib", to)
    for name, path in sorted(closure(programs, asked.lean).items()):
        to = shutil.copy(path, package / "lib" / name)
        os.chmod(to, 0o755)
        run("strip", "--strip-unneeded", to)
        run("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN", to)
        if not path.resolve().is_relative_to(asked.lean.resolve()):
            package_of = sbom.packages_of([path])[path][0]
            shutil.copy(f"/usr/share/doc/{package_of}/copyright", licences / package_of)
    for source in asked.sources.glob("*/debian/copyright"):
        shutil.copy(source, licences / source.parts[-3].partition("-")[0])
    share = package / "share"
    shutil.copytree(usr / "share/obliq/scenes", share / "scenes")
    shutil.copytree(asked.lean / "share/gdal", share / "gdal")
    (share / "proj").mkdir()
    shutil.copy(asked.lean / "share/proj/proj.db", share / "proj")
    (share / "fonts").mkdir()
    for font in ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf"):
        shutil.copy(FONTS / font, share / "fonts")
    shutil.copy("/usr/share/doc/fonts-dejavu-core/copyright", licences / "fonts-dejavu-core")
    (share / "fonts/fonts.conf").write_text(FONTS_CONF)


def pack(folder: pathlib.Path, record: pathlib.Path, wheel: pathlib.Path) -> None:
    """The same bytes for the same files: in their order, with the commit's time. RECORD as in PEP 427."""
    when = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", "1577836800")))[:6]
    lines = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        def add(path: pathlib.Path, data: bytes) -> None:
            entry = zipfile.ZipInfo(os.fspath(path.relative_to(folder)), when)
            entry.external_attr = (0o100755 if path.exists() and os.access(path, os.X_OK) else 0o100644) << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)

        for path in sorted(filter(pathlib.Path.is_file, folder.rglob("*"))):
            data = path.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            lines.append(f"{path.relative_to(folder)},sha256={digest},{len(data)}\n")
            add(path, data)
        add(record, "".join([*lines, f"{record.relative_to(folder)},,\n"]).encode())


def main() -> None:
    parser = argparse.ArgumentParser()
    for name in ("stage", "lean", "sources", "out"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--version", required=True)
    asked = parser.parse_args()
    tag = f"py3-none-manylinux_2_36_{platform.machine()}"
    wheel = asked.out / f"obliq_server-{asked.version}-{tag}.whl"
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        info = folder / f"obliq_server-{asked.version}.dist-info"
        fill(folder / "obliq_server", info / "licenses", asked)
        (info / "METADATA").write_text(METADATA.format(version=asked.version))
        (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: obliq\nRoot-Is-Purelib: false\nTag: {tag}\n")
        (info / "entry_points.txt").write_text(ENTRY_POINTS)
        pack(folder, info / "RECORD", wheel)
    print(wheel)


if __name__ == "__main__":
    main()

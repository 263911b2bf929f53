"""obliqd and obliq with the libraries that they need. obliq.local() finds them here; `obliqd` and `obliq` of the command line
are these, too."""
from __future__ import annotations

import os
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent


def program(name: str) -> pathlib.Path:
    """The path of "obliqd" or "obliq". To be run with environment()."""
    return HERE / "bin" / name


def environment() -> dict[str, str]:
    """This process's, and where the libraries find coordinate systems, and a font; what is set already stays."""
    ours = {"PROJ_DATA": HERE / "share" / "proj", "GDAL_DATA": HERE / "share" / "gdal",
            "FONTCONFIG_FILE": HERE / "share" / "fonts" / "fonts.conf"}
    return {**{name: os.fspath(path) for name, path in ours.items()}, **os.environ}


def _become(name: str) -> None:
    os.execve(program(name), [name, *sys.argv[1:]], environment())


def obliqd() -> None:
    _become("obliqd")


def obliq() -> None:
    _become("obliq")

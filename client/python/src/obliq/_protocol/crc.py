"""CRC-32C by the fastest library that is here. All of them read bytes and numpy arrays where they lie; not all read memoryviews."""
from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

Sum = Callable[..., int]  # of bytes or an array, and the sum of what came before


def _google() -> Sum:
    import google_crc32c

    if google_crc32c.implementation != "c":
        raise ImportError("without its C library")
    return lambda data, crc=0: google_crc32c.extend(crc, data)


def _google_in_python() -> Sum:
    """Seconds a frame: where there is no other."""
    import google_crc32c

    return lambda data, crc=0: google_crc32c.extend(crc, bytes(data))


def _isa_l() -> Sum:
    """Intel's library, which obliqd needs itself: where both run on one machine, it is there."""
    try:
        update = ctypes.CDLL("libisal.so.2").crc32_iscsi  # find_library would run programs
    except (OSError, AttributeError) as error:
        raise ImportError(str(error)) from None
    update.argtypes, update.restype = (ctypes.c_void_p, ctypes.c_int, ctypes.c_uint32), ctypes.c_uint32

    def crc32c(data: Any, crc: int = 0) -> int:
        # The bare register: it inverts neither what it begins with nor its result.
        place = data if isinstance(data, bytes) else data.__array_interface__["data"][0]
        return int(update(place, len(data), crc ^ 0xFFFFFFFF)) ^ 0xFFFFFFFF

    return crc32c


def _debian() -> Sum:
    import importlib

    update: Sum = importlib.import_module("crc32c").crc32c
    return update


LIBRARIES = {"google-crc32c": _google, "ISA-L": _isa_l, "crc32c": _debian,
             "google-crc32c without its C library": _google_in_python}


def choose(libraries: dict[str, Callable[[], Sum]]) -> tuple[str, Sum]:
    """The first that is here: its name, and crc32c(data, crc=0) of bytes or of an array of bytes without gaps."""
    for name, load in libraries.items():
        try:
            return name, load()
        except ImportError:
            continue
    raise ImportError("obliq needs a CRC-32C: pip install google-crc32c, or Debian's python3-crc32c")


NAME, crc32c = choose(LIBRARIES)

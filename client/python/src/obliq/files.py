"""A frame from a file that Frame.save() wrote."""
from __future__ import annotations

import os
import pathlib
import zipfile
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._saving import FORMAT
from .frame import Frame, restore
from .planes import BINS
from .trains import restore_trains
from .xarrays import need


def load(path: str | os.PathLike[str]) -> Frame:
    """The frame that save() wrote to .npz or .nc: the same bits."""
    readers: dict[str, Callable[[str | os.PathLike[str]], Frame]] = {".npz": load_npz, ".nc": load_nc}
    suffix = pathlib.Path(path).suffix.lower()
    if suffix not in readers:
        raise ValueError(f"{path}: found suffix {suffix!r}; allowed: {', '.join(readers)}")
    return readers[suffix](path)


def from_messages(planes: Mapping[str, npt.NDArray[Any]], kept: Mapping[str, Any]) -> Frame:
    """A frame of its planes and of what a file keeps beside them."""
    frame = restore(planes, bytes(kept["descriptor"]), bytes(kept["summary"]), int(kept["utc_ns"]), int(kept["frame_id"]),
                    np.asarray(kept["missed"]).tolist())
    if "pulses" in kept:
        restore_trains(frame, np.asarray(kept["pulses"]), bytes(kept["trains"]), np.asarray(kept["train_bytes"]))
    return frame


def load_npz(path: str | os.PathLike[str]) -> Frame:
    """What save_npz() wrote."""
    try:
        with open(path, "rb") as file, np.load(file) as kept:
            names = set(kept.files)
            if "obliq_descriptor" not in names or int(kept["format"]) > FORMAT:
                raise ValueError(f"{path}: not a frame that obliq saved, or by a later version")
            messages = {name[6:]: kept[name] for name in names if name.startswith("obliq_")}
            planes = {name: kept[name] for name in BINS if name in names}
            return from_messages(planes, messages)
    except (zipfile.BadZipFile, EOFError, KeyError) as error:
        raise ValueError(f"{path}: damaged, or not a frame that obliq saved: {error}") from None


def load_nc(path: str | os.PathLike[str]) -> Frame:
    """What save_nc() wrote."""
    netcdf = need("loading .nc", "netCDF4", "netcdf")
    try:
        file = netcdf.Dataset(path)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise ValueError(f"{path}: damaged, or not a netCDF file: {error}") from None
    with file:
        file.set_auto_mask(False)
        held = file.variables
        if "obliq_descriptor" not in held:
            raise ValueError(f"{path}: not a frame that obliq saved")
        planes = {name: np.asarray(held[name][...]) for name in BINS if name in held}
        if "i" in held:
            iq = np.empty(held["i"].shape, np.complex64)
            iq.real, iq.imag = held["i"][...], held["q"][...]
            planes = {"iq": iq, **planes}
        missed = np.atleast_1d(getattr(file, "missed", np.empty(0, "i8")))
        trains = {}
        if "pulses_i" in held:
            pulses = np.empty(held["pulses_i"].shape, np.complex64)
            pulses.real, pulses.imag = held["pulses_i"][...], held["pulses_q"][...]
            trains = {"pulses": pulses, "trains": held["obliq_trains"][...].tobytes(), "train_bytes": held["train_bytes"][...]}
        return from_messages(planes, {**trains, "descriptor": held["obliq_descriptor"][...].tobytes(),
                                      "summary": held["obliq_summary"][...].tobytes(), "utc_ns": held["time"][...],
                                      "frame_id": file.frame_id, "missed": missed.reshape(-1, 2)})

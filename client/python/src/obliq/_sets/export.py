"""A data set for other programs: xarray, zarr, WebDataset."""
from __future__ import annotations

import io
import json
import os
import pathlib
import tarfile
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .._saving import whole
from ..xarrays import attributes, need, variable_attributes

if TYPE_CHECKING:
    import xarray

    from .dataset import Dataset

# Of one frame, or of all: what differs from frame to frame is a coordinate.
COMMON = ("Conventions", "scene", "wavelength_m", "phase_sign", "frequency_hz", "radius_factor", "scene_hash", "build")


def column(values: list[Any]) -> npt.NDArray[Any]:
    """As an array of one kind: numbers, or texts where any is none."""
    numbers = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)
    if numbers or all(isinstance(value, bool) for value in values):
        return np.array(values)
    return np.array(["" if value is None else value if isinstance(value, str) else json.dumps(value) for value in values])


def coordinates(data: Dataset) -> dict[str, Any]:
    """Name -> (dimensions, values, attributes)."""
    first = data[0]
    kept = data.columns
    spots: dict[str, list[Any]] = {"azimuth_start_deg": [], "azimuth_width_deg": [], "range_start_m": [], "range_spacing_m": []}
    poses: dict[str, list[Any]] = {}
    for descriptor in data.descriptors():
        for name in spots:
            spots[name].append(descriptor.get(name, 0.0))
        for name in ("latitude_deg", "longitude_deg", "height_m", "bearing_deg"):
            poses.setdefault(name, []).append(descriptor["pose"].get(name, 0.0))
    start, width, r0, spacing = (np.array(values, float)[:, None] for values in spots.values())
    bearing = (start + (first.azimuth_index + 0.5) * width) % 360
    ranges = r0 + (first.range_index + 0.5) * spacing
    found = {
        "frame": ("frame", column([row["id"] for row in kept]), {"long_name": "id of the pose"}),
        "azimuth": ("azimuth", first.offset_deg, {"units": "degrees", "long_name":
                    "clockwise from the sector's centre, of the first frame"}),
        "bearing": (("frame", "azimuth"), bearing, {"units": "degrees", "long_name": "clockwise from true north, in [0, 360)"}),
    }
    same = bool((ranges == ranges[0]).all())
    found["range"] = ("range", ranges[0], {"units": "m", "long_name": f"slant range{'' if same else ', of the first frame'}"})
    if not same:
        found["slant_range"] = (("frame", "range"), ranges, {"units": "m", "long_name": "slant range"})
    for name, values in poses.items():
        found[f"pose_{name}"] = ("frame", column(values), {})
    for name in dict.fromkeys(name for row in kept for name in row):
        if name != "id" and any(row.get(name) is not None for row in kept):
            found[name if name not in found else f"meta_{name}"] = ("frame", column([row.get(name) for row in kept]), {})
    return found


def to_xarray(data: Dataset, lazy: bool) -> xarray.Dataset:
    """[frame, azimuth, range]; lazy by dask."""
    xr = need("Dataset.to_xarray()", "xarray", "xarray")
    if not len(data):
        raise ValueError("to_xarray(): found no frame in the data set")
    stack = need("Dataset.to_xarray(lazy=True)", "dask.array", "zarr") if lazy else np
    first, variables = data[0], {}
    for name in data.planes():
        rows = [(stack.from_array(values[at[0]], chunks=-1) if lazy else values[at[0]]) for values, at in data.stacks(name)]
        its = {key: text for key, text in variable_attributes(first, name).items() if key != "coordinates"}
        variables[name] = (("frame", "azimuth", "range"), stack.stack(rows), its)
    every = attributes(first)
    made: xarray.Dataset = xr.Dataset(variables, coordinates(data), {name: every[name] for name in COMMON if name in every})
    return made


def to_zarr(data: Dataset, path: str | os.PathLike[str]) -> None:
    """A store of a chunk for each frame."""
    need("Dataset.to_zarr()", "zarr", "zarr")
    to_xarray(data, True).to_zarr(os.fspath(path), mode="w-", consolidated=False)


def to_webdataset(data: Dataset, pattern: str, frames: int) -> list[pathlib.Path]:
    """Tar files, each whole or absent; the same bytes whenever they are made."""
    if frames < 1:
        raise ValueError(f"to_webdataset(): found frames={frames}; allowed: from 1")
    if "%" not in pattern and len(data) > frames:
        raise ValueError(f"to_webdataset(): found {pattern!r}; allowed: a name with a number, such as set-%05d.tar")
    made = []
    for first in range(0, len(data), frames):
        path = pathlib.Path(pattern % (first // frames) if "%" in pattern else pattern)
        with whole(path) as part, tarfile.open(part, "w") as archive:
            for at in range(first, min(first + frames, len(data))):
                for name, content in _sample(data, at).items():
                    member = tarfile.TarInfo(f"{at:09d}.{name}")
                    member.size = len(content)
                    archive.addfile(member, io.BytesIO(content))
        made.append(path)
    return made


def _sample(data: Dataset, at: int) -> dict[str, bytes]:
    """The files of one frame: their names without its key."""
    made = {}
    for name, values in data.arrays(at).items():
        file = io.BytesIO()
        np.save(file, values)
        made[f"{name}.npy"] = file.getvalue()
    frame = data[at]
    told = {**data.about(at), "pose": frame.pose.as_dict(), "settings": frame.settings.as_dict(),
            "coverage": frame.summary.coverage if frame.summary is not None else None}
    return {**made, "json": json.dumps(told).encode()}

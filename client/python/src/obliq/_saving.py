"""A frame to a file. .npz and .nc hold every bit, and files.load reads them; .tif and .png are maps."""
from __future__ import annotations

import contextlib
import io
import os
import pathlib
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import mapping
from .trains import messages_of as messages_of_trains
from .xarrays import attributes, coordinates, need, variable_attributes

if TYPE_CHECKING:
    from .frame import Frame

FORMAT = 1  # of .npz files


@contextlib.contextmanager
def whole(path: str | os.PathLike[str]) -> Iterator[pathlib.Path]:
    """A path to write to; the file has its name when it is whole, and not before."""
    path = pathlib.Path(path)
    part = path.with_name(f".{path.name}.{os.getpid()}{path.suffix}")
    try:
        part.touch()
    except OSError as error:
        raise OSError(error.errno, error.strerror, os.fspath(path)) from None
    try:
        yield part
        os.replace(part, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            part.unlink()


def save(frame: Frame, path: str | os.PathLike[str]) -> None:
    """By the path's suffix."""
    writers: dict[str, Callable[[Frame, pathlib.Path], None]] = {
        ".npz": save_npz, ".nc": save_nc, ".tif": save_tif, ".tiff": save_tif,
        ".png": save_png}
    suffix = pathlib.Path(path).suffix.lower()
    if suffix not in writers:
        raise ValueError(f"{path}: found suffix {suffix!r}; allowed: {', '.join(writers)}")
    with whole(path) as part:
        writers[suffix](frame, part)


def messages_of(frame: Frame) -> dict[str, Any]:
    """What a file keeps beside the planes, as arrays."""
    summary = frame.summary.SerializeToString() if frame.summary is not None else b""
    trains = messages_of_trains(frame.trains) if frame.trains else {}
    return {**trains, "descriptor": np.frombuffer(frame.descriptor.SerializeToString(), "u1"),
            "summary": np.frombuffer(summary, "u1"),
            "utc_ns": np.int64(frame.utc.astype("i8")), "frame_id": np.uint64(frame.frame_id),
            "missed": np.array([(rows.start, rows.stop) for rows in frame.missed], "i8").reshape(-1, 2)}


def save_npz(frame: Frame, path: pathlib.Path) -> None:
    """numpy's archive."""
    with open(path, "wb") as file:
        np.savez(file, **{"format": np.int64(FORMAT), "azimuth_deg": frame.azimuth_deg, "range_m": frame.range_m, **frame.planes(),
                          **{f"obliq_{name}": value for name, value in messages_of(frame).items()}})


def save_nc(frame: Frame, path: pathlib.Path) -> None:
    """CF netCDF-4. Complex numbers are no netCDF type: iq is two variables, i and q."""
    netcdf = need("saving .nc", "netCDF4", "netcdf")
    with netcdf.Dataset(path, "w") as file:
        for name, size in (("azimuth", frame.shape[0]), ("range", frame.shape[1]), ("bound", 2)):
            file.createDimension(name, size)

        def put(name: str, dimensions: str | tuple[str, ...], values: Any, its: Mapping[str, Any]) -> None:
            dimensions = (dimensions,) if isinstance(dimensions, str) else dimensions
            variable = file.createVariable(name, np.asarray(values).dtype, dimensions, zlib=bool(dimensions), complevel=1)
            variable[...] = values
            variable.setncatts(its)

        for name, (dimensions, values, its) in coordinates(frame).items():
            put(name, dimensions, values, its)
        put("time", (), np.int64(frame.utc.astype("i8")), {"units": "nanoseconds since 1970-01-01T00:00:00Z",
                                                           "standard_name": "time"})
        for name, values in frame.planes().items():
            its = variable_attributes(frame, name)
            if name == "iq":
                put("i", ("azimuth", "range"), values.real, dict(its, long_name="in phase, real part of iq"))
                put("q", ("azimuth", "range"), values.imag, dict(its, long_name="quadrature, imaginary part of iq"))
            else:
                put(name, ("azimuth", "range"), values, its)
        kept = messages_of(frame)
        if frame.trains:
            for name, size in zip(("train", "pulse"), kept["pulses"].shape):
                file.createDimension(name, size)
            its = {"units": frame.unit, "long_name": "samples of pulse trains, real part"}
            put("pulses_i", ("train", "pulse", "range"), kept["pulses"].real, its)
            put("pulses_q", ("train", "pulse", "range"), kept["pulses"].imag, dict(its, long_name="the imaginary part"))
            times = np.stack([train.times_s for train in frame.trains])
            put("pulse_time", ("train", "pulse"), times, {"units": "s", "long_name": "from the middle of the train"})
            put("train_bytes", "train", kept["train_bytes"], {"long_name": "length of each train's message"})
        for name, value in kept.items():
            if name in ("descriptor", "summary", "trains"):
                file.createDimension(f"{name}_bytes", len(value))
                put(f"obliq_{name}", f"{name}_bytes", value, {"long_name": f"protobuf message of the {name}"})
        missed = kept["missed"].ravel()
        file.setncatts({**attributes(frame), "history": "written by the obliq Python package",
                        **({"missed": missed} if missed.size else {})})


def save_tif(frame: Frame, path: pathlib.Path) -> None:
    """Bands and values as the ground_map.tif of `obliq get`: level in dB, and state (255 outside)."""
    rasterio = need("saving .tif", "rasterio", "geotiff")
    grid = mapping.north_up(frame)
    level, state = mapping.levels_on(frame, grid)
    pose = frame.pose
    with rasterio.open(
            path, "w", driver="GTiff", width=grid.width, height=grid.height, count=2, dtype="float32", tiled=True,
            compress="deflate", nodata=mapping.NO_VALUE,
            crs=f"+proj=aeqd +lat_0={pose.latitude_deg:.12f} +lon_0={pose.longitude_deg:.12f} +datum=WGS84 +units=m +no_defs",
            transform=rasterio.Affine(grid.pixel_m, 0, grid.left_m, 0, -grid.pixel_m, grid.top_m)) as file:
        file.write(level, 1)
        file.write(state.astype("float32"), 2)
        file.set_band_description(1, f"{mapping.level_name(frame)}, dB")
        file.set_band_description(2, "state: 0 not sampled, 1 sampled, 2 shadow, 3 no known surface, 4 no ground at this "
                                     "range, 254 not known, 255 outside")


def save_png(frame: Frame, path: pathlib.Path) -> None:
    """A picture."""
    need("saving .png", "matplotlib", "plot")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from . import plotting

    figure = Figure(figsize=(10, 8), dpi=150)
    FigureCanvasAgg(figure)  # type: ignore[no-untyped-call, unused-ignore]
    plotting.plot(frame, "ppi", figure.add_subplot(), None)
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    pathlib.Path(path).write_bytes(picture.getvalue())

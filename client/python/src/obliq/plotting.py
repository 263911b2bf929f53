"""Pictures of a frame with matplotlib."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import mapping
from .xarrays import need

if TYPE_CHECKING:
    import matplotlib.axes

    from .frame import Frame

# As the PNG of `obliq get`: percentiles of what is drawn, and no less than so much.
LOW, HIGH, LEAST_SPAN_DB = 0.05, 0.997, 10.0
# Of bins without a value: dark blue in shadow, black where the ground is not known or nearer than the swath, grey-blue where
# the sampling missed visible ground.
COLOURS = {0: (0.25, 0.30, 0.40), 2: (0.04, 0.06, 0.20), 3: (0.0, 0.0, 0.0), 4: (0.0, 0.0, 0.0)}


def scale_of(level: npt.NDArray[np.float32]) -> tuple[float, float]:
    """Black and white of a grey scale, in dB."""
    there = np.sort(level[level != mapping.NO_VALUE])
    if not there.size:
        return 0.0, LEAST_SPAN_DB
    low = np.floor(there[int(LOW * (there.size - 1))])
    return float(low), float(max(np.ceil(there[int(HIGH * (there.size - 1))]), low + LEAST_SPAN_DB))


def compensated(level: npt.NDArray[np.float32], frame: Frame) -> tuple[npt.NDArray[np.float32], str]:
    """With r^2, so that near and far ground of one kind look alike, unless the frame has that already, or its bins are
    more than echoes. As `obliq get`."""
    of_video = frame.iq is None and frame.power is None
    if frame.descriptor.settings.range_normalisation or of_video or not mapping.is_ideal(frame):
        return level, ""
    there = level != mapping.NO_VALUE
    return np.where(there, level + (40 * np.log10(frame.range_m)).astype("f4"), level), " + 40 log r"


def plot(frame: Frame, kind: str = "ppi", ax: matplotlib.axes.Axes | None = None,
         range_db: tuple[float, float] | None = None, cmap: str = "gray") -> matplotlib.axes.Axes:
    """Draws into `ax`, or into a new figure's. "ppi": a map in km, north up; "bscan": azimuth by slant range."""
    if kind not in ("ppi", "bscan"):
        raise ValueError(f"plot(): found kind={kind!r}; allowed: 'ppi', 'bscan'")
    need("frame.plot()", "matplotlib", "plot")
    if ax is None:
        import matplotlib.pyplot as pyplot

        ax = pyplot.figure(figsize=(9, 7)).add_subplot()
    level, words = compensated(mapping.levels(frame), frame)
    state: npt.NDArray[Any] | None = frame.state
    if kind == "ppi":
        grid = mapping.north_up(frame, 1024)
        bins = mapping.bins_on(frame, grid)
        inside = bins >= 0
        level = np.where(inside, level.ravel()[bins], mapping.NO_VALUE)
        state = np.where(inside, state.ravel()[bins], mapping.OUTSIDE) if state is not None else None
        extent = tuple(edge / 1000 for edge in grid.extent)
        ax.set(xlabel="east of the antenna, km", ylabel="north of the antenna, km")
    else:
        start, width, r0, spacing = mapping.sector(frame)
        level, state = level.T[::-1], None if state is None else state.T[::-1]
        inside = np.ones(level.shape, bool)
        extent = (start, start + width * frame.shape[0], r0 / 1000, (r0 + spacing * frame.shape[1]) / 1000)
        ax.set(xlabel="bearing, degrees", ylabel="slant range, km")
    low, high = range_db or scale_of(level)
    there = level != mapping.NO_VALUE
    grey = np.clip((level - low) / (high - low), 0, 1)
    picture = np.ones((*level.shape, 4), "f4")
    from matplotlib import colormaps

    picture[..., :3] = grey[..., None] if cmap == "gray" else colormaps[cmap](grey)[..., :3]
    for number, colour in COLOURS.items():
        where = ~there & inside & (state == number if state is not None else number == 3)
        picture[where, :3] = colour
    picture[~inside] = (1, 1, 1, 0)
    aspect = "equal" if kind == "ppi" else "auto"
    image = ax.imshow(picture, extent=extent, interpolation="nearest", origin="upper", aspect=aspect)
    ax.set_title(f"{frame.radar}, frame {frame.frame_id}, bearing {frame.pose.bearing_deg:g} degrees")
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    ax.figure.colorbar(ScalarMappable(Normalize(low, high), cmap), ax=ax, label=mapping.level_name(frame) + words)
    image.set_label("bins")
    return ax

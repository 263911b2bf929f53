"""Pictures of a frame: with matplotlib, or a map without words where there is none."""
from __future__ import annotations

import struct
import zlib

import numpy as np

from . import mapping
from .xarrays import need

# As the PNG of `obliq get`: percentiles of what is drawn, and no less than so much.
LOW, HIGH, LEAST_SPAN_DB = 0.05, 0.997, 10.0
# Of bins without a value: dark blue in shadow, black where the ground is not known or nearer than the swath, grey-blue where
# the sampling missed visible ground.
COLOURS = {0: (0.25, 0.30, 0.40), 2: (0.04, 0.06, 0.20), 3: (0.0, 0.0, 0.0), 4: (0.0, 0.0, 0.0)}


def scale_of(level):
    """Black and white of a grey scale, in dB."""
    there = np.sort(level[level != mapping.NO_VALUE])
    if not there.size:
        return 0.0, LEAST_SPAN_DB
    low = np.floor(there[int(LOW * (there.size - 1))])
    return float(low), float(max(np.ceil(there[int(HIGH * (there.size - 1))]), low + LEAST_SPAN_DB))


def compensated(level, frame):
    """With r^2, so that near and far ground of one kind look alike, unless the frame has that already, or its bins are
    more than echoes. As `obliq get`."""
    of_video = frame.iq is None and frame.power is None
    if frame.descriptor.settings.range_normalisation or of_video or not mapping.is_ideal(frame):
        return level, ""
    there = level != mapping.NO_VALUE
    return np.where(there, level + (40 * np.log10(frame.range_m)).astype("f4"), level), " + 40 log r"


def on_map(frame):
    """Level, state and whether it is inside of each pixel of a map, north up; words for the level; the grid."""
    level, words = compensated(mapping.levels(frame), frame)
    grid = mapping.north_up(frame, 1024)
    bins = mapping.bins_on(frame, grid)
    inside = bins >= 0
    level = np.where(inside, level.ravel()[bins], mapping.NO_VALUE)
    state = None if frame.state is None else np.where(inside, frame.state.ravel()[bins], mapping.OUTSIDE)
    return level, state, inside, words, grid


def paint(level, state, inside, low, high):
    """Red, green, blue, opacity of each pixel, 0 to 1."""
    there = level != mapping.NO_VALUE
    picture = np.ones((*level.shape, 4), "f4")
    picture[..., :3] = np.clip((level - low) / (high - low), 0, 1)[..., None]
    for number, colour in COLOURS.items():
        where = ~there & inside & (state == number if state is not None else number == 3)
        picture[where, :3] = colour
    picture[~inside] = (1, 1, 1, 0)
    return picture


def plain_png(frame):
    """The map alone as bytes of a PNG (ISO/IEC 15948: signature, IHDR, IDAT, IEND), where matplotlib is not installed."""
    level, state, inside, _, _ = on_map(frame)
    pixels = (paint(level, state, inside, *scale_of(level)) * 255 + 0.5).astype("u1")
    height, width = level.shape
    rows = np.concatenate([np.zeros((height, 1), "u1"), pixels.reshape(height, -1)], axis=1)  # each begins with its filter: none

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b""))


def plot(frame, kind="ppi", ax=None, range_db=None):
    """Draws into `ax`, or into a new figure's. "ppi": a map in km, north up; "bscan": azimuth by slant range."""
    if kind not in ("ppi", "bscan"):
        raise ValueError(f"plot(): found kind={kind!r}; allowed: 'ppi', 'bscan'")
    need("frame.plot()", "matplotlib", "plot")
    if ax is None:
        import matplotlib.pyplot as pyplot

        ax = pyplot.figure(figsize=(9, 7)).add_subplot()
    if kind == "ppi":
        level, state, inside, words, grid = on_map(frame)
        extent = [edge / 1000 for edge in grid.extent]
        ax.set(xlabel="east of the antenna, km", ylabel="north of the antenna, km")
    else:
        level, words = compensated(mapping.levels(frame), frame)
        start, width, r0, spacing = mapping.sector(frame)
        level, state = level.T[::-1], None if frame.state is None else frame.state.T[::-1]
        inside = np.ones(level.shape, bool)
        extent = [start, start + width * frame.shape[0], r0 / 1000, (r0 + spacing * frame.shape[1]) / 1000]
        ax.set(xlabel="bearing, degrees", ylabel="slant range, km")
    low, high = range_db or scale_of(level)
    aspect = "equal" if kind == "ppi" else "auto"
    image = ax.imshow(paint(level, state, inside, low, high), extent=extent, interpolation="nearest", origin="upper", aspect=aspect)
    ax.set_title(f"{frame.radar}, frame {frame.frame_id}, bearing {frame.pose.bearing_deg:g} degrees")
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    ax.figure.colorbar(ScalarMappable(Normalize(low, high), "gray"), ax=ax, label=mapping.level_name(frame) + words)
    image.set_label("bins")
    return ax

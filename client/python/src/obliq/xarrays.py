"""Frames as xarray.Dataset, after the CF conventions (cfconventions.org, 1.11)."""
from __future__ import annotations

import types
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import BadStream
from .planes import NO_MATERIAL, STATES

if TYPE_CHECKING:
    import xarray

    from ._requests import ServerInfo
    from .frame import Frame

Variable = tuple["str | tuple[str, ...]", Any, dict[str, Any]]  # dimensions, values, attributes

LONG_NAMES = {"iq": "complex amplitude", "power": "mean power, before speckle", "count": "samples",
              "material": "of the greatest sum of power; 255: none", "building": "share of the mean power that buildings give",
              "height": "above the datum, weighed by power", "returns": "separate stretches of visible surface",
              "target": "the strongest in the bin, the last 32 bits of its id; 0: none",
              "state": "why a bin has a sample, or none",
              "video": "log video: 0 at and below video_floor_db, the largest value setting_video_span_db above it"}


def need(call: str, module: str, extra: str) -> types.ModuleType:
    """Imports what an extra brings; the error says how to get it."""
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError:
        raise ImportError(f"{call} needs {module.split('.')[0]}: pip install 'obliq[{extra}]'") from None


def variable_attributes(frame: Frame, name: str) -> dict[str, Any]:
    """Of a plane."""
    attributes: dict[str, Any] = {"long_name": LONG_NAMES[name], "coordinates": "latitude longitude"}
    if name == "state":
        attributes["flag_values"] = np.arange(len(STATES), dtype="u1")
        attributes["flag_meanings"] = " ".join(STATES)
    elif name == "material":
        names = [material.name for material in frame.descriptor.materials]
        attributes["flag_values"] = np.append(np.arange(len(names), dtype="u1"), np.uint8(NO_MATERIAL))
        attributes["flag_meanings"] = " ".join([*("_".join(given.split()) for given in names), "none"])
    else:
        attributes["units"] = {"iq": frame.unit, "power": frame.power_unit, "height": "m"}.get(name, "1")
    return attributes


def attributes(frame: Frame, server: ServerInfo | None = None) -> dict[str, Any]:
    """What is the same for all bins. Numbers, texts and lists of texts alone, as netCDF wants."""
    d = frame.descriptor
    found: dict[str, Any] = {"Conventions": "CF-1.11", "radar": frame.radar, "scene": d.scene_name, "frame_id": frame.frame_id,
             "settings_version": d.settings_version, "wavelength_m": d.wavelength_m, "phase_sign": d.phase_sign,
             "frequency_hz": d.settings.frequency_ghz * 1e9, "radius_factor": d.radius_factor,
             "map_reference_height_m": d.map_reference_height_m, "noise_power_w": d.noise_power_w,
             "noise_counter": d.noise_counter, "adc_step": d.adc_step, "video_floor_db": d.video_floor_db,
             "scene_hash": d.scene_hash, "build": d.build, "warnings": "\n".join(frame.warnings)}
    if server is not None:
        found["server_version"] = server.version
    if frame.summary is not None:
        found["coverage"] = frame.summary.coverage
    for prefix, values in (("setting", frame.settings.as_dict()), ("pose", frame.pose.as_dict())):
        found.update({f"{prefix}_{name}": int(value) if isinstance(value, bool) else value
                      for name, value in values.items()})
    for field in d.source_error.DESCRIPTOR.fields:
        found[f"source_error_{field.name}"] = getattr(d.source_error, field.name)
    return found


def coordinates(frame: Frame) -> dict[str, Variable]:
    """Name -> (dimensions, values, attributes)."""
    d = frame.descriptor
    latitude, longitude = frame.places()
    width, spacing = d.azimuth_width_deg, d.range_spacing_m
    return {
        "azimuth": ("azimuth", frame.offset_deg, {"units": "degrees", "bounds": "azimuth_bounds", "long_name":
                    "clockwise from the sector's centre, rising along the axis"}),
        "bearing": ("azimuth", frame.azimuth_deg % 360, {"units": "degrees", "long_name":
                    "clockwise from true north at the antenna, in [0, 360)"}),
        "range": ("range", frame.range_m, {"units": "m", "bounds": "range_bounds", "long_name": "slant range"}),
        "ground_range": ("range", frame.ground_range_m, {"units": "m", "long_name": "at map_reference_height_m"}),
        "latitude": (("azimuth", "range"), latitude, {"units": "degrees_north", "standard_name": "latitude"}),
        "longitude": (("azimuth", "range"), longitude, {"units": "degrees_east", "standard_name": "longitude"}),
        "azimuth_bounds": (("azimuth", "bound"), frame.offset_deg[:, None] + np.array([-0.5, 0.5]) * width, {}),
        "range_bounds": (("range", "bound"), frame.range_m[:, None] + np.array([-0.5, 0.5]) * spacing, {}),
        "antenna_latitude": ((), frame.pose.latitude_deg, {"units": "degrees_north"}),
        "antenna_longitude": ((), frame.pose.longitude_deg, {"units": "degrees_east"}),
        "antenna_height": ((), frame.pose.height_m, {"units": "m", "long_name":
                           f"above {frame.pose.height_reference}"}),
    }


def to_xarray(frame: Frame) -> xarray.Dataset:
    """The planes with coordinates and attributes."""
    xr = need("frame.to_xarray()", "xarray", "xarray")
    if not frame.planes():
        raise BadStream("the frame has no plane")
    coords = dict(coordinates(frame), time=((), frame.utc, {}))
    data = {name: (("azimuth", "range"), values, {key: text for key, text in variable_attributes(frame, name).items()
                                                 if key != "coordinates"})
            for name, values in frame.planes().items()}
    made: xarray.Dataset = xr.Dataset(data, coords, attributes(frame))
    return made

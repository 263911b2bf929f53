"""What a data set was made of: its manifest, and whether a server has the same world."""
from __future__ import annotations

import contextlib
import datetime
import json
import os
import pathlib
import platform
import shutil
import socket
import uuid
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .files import digest, parsed, write_whole
from .._version import __version__
from ..client import Server
from ..frame import Frame
from ..parameters import Pose, Settings

if TYPE_CHECKING:
    from .batch import Job

FORMAT = 1
MANIFEST = "manifest.json"
ANOTHER_WORLD = ("The ground, the buildings, the surfaces or the materials are not those that the data set was begun with: start "
                 "with the same files and keys, or choose another folder")
ANOTHER_SERVER = ("The daemon has another origin, cell or build than the one that began the data set, and its bits differ: "
                  "start it again with the same scene file, or choose another folder")


def world_of_frame(frame: Frame, server: Server) -> dict[str, Any]:
    """What bits depend on beside pose and settings."""
    d = frame.descriptor
    return {"build": d.build or server.info.version, "scene": d.scene_name, "scene_hash": d.scene_hash,
            "origin_latitude_deg": d.origin_latitude_deg, "origin_longitude_deg": d.origin_longitude_deg,
            "radius_factor": repr(d.radius_factor), "cell_m": d.cell_m, "buildings": d.buildings_in_scene,
            "materials_sha256": digest([material.SerializeToString(deterministic=True).hex() for material in d.materials])}


def world_of(server: Server, job: Job, scene: str) -> dict[str, Any]:
    """Of a server: by a frame of one bin with nothing in it that could be refused, from where its radar stands, or else from
    the first pose that it takes."""
    tiny = Settings.of({"azimuth_bins": 1, "range_bins": 1, "pixel_columns": 1, "pixel_rows": 1, "frustum": "sweep",
                        "scan_mode": "frame", **Settings.ideal})
    poses = [Pose.of(line.pose) for line in job.lines if line.scene == scene][:20]
    for place in [server.radar(job.radar_of(server)).pose, *poses]:
        for result in server.render_many([place], tiny, planes="state", timeout=job.timeout, return_exceptions=True):
            if isinstance(result, Frame):
                return world_of_frame(result, server)
            error = result
    raise error


def same_world(wanted: Mapping[str, Any], found: Mapping[str, Any], where: str) -> None:
    """ValueError names what differs. What an older manifest does not have is not compared."""
    hashed = wanted.get("scene_hash") and found.get("scene_hash")
    for key, value in wanted.items():
        mine = found.get("build" if key == "server_version" else key)
        # How many buildings are loaded follows from the area; which ones there are is in the hash.
        if mine == value or (key == "buildings" and hashed) or (key == "scene_hash" and not value):
            continue
        raise ValueError(f"{where}: {key}: found {mine!r}; allowed: {value!r}, as in the manifest. "
                         + (ANOTHER_WORLD if key in ("scene_hash", "materials_sha256") else ANOTHER_SERVER))


def warn_without_hash(worlds: Mapping[str, Mapping[str, Any]], where: str) -> None:
    """A warning where nothing tells whether another world was mixed in."""
    if not all(world.get("scene_hash") for world in worlds.values()):
        warnings.warn(f"{where}: made without a scene hash: nothing tells whether all of it was made of one world", stacklevel=3)


def worlds_in(manifest: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """By the scene's name in the lines of poses; "": of those that name none."""
    worlds = dict(manifest.get("worlds") or {})
    return {"": manifest["world"], **worlds} if "world" in manifest else worlds


def manifest_of(job: Job, worlds: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    """All that the data set's values follow from."""
    made = {"format": FORMAT, "poses": len(job.lines), "poses_sha256": digest([line.told() for line in job.lines]),
            "shard_size": job.shard_size, "parts": len(job.shards()), "planes": list(job.planes), "settings": job.settings,
            "radar": job.radar, "seed": job.seed, "speckle_per_frame": job.speckle_per_frame, "min_coverage": job.min_coverage}
    if "" in worlds:
        made["world"] = worlds[""]
    named = {scene: world for scene, world in worlds.items() if scene}
    return {**made, "worlds": named} if named else made


def provenance(job: Job) -> dict[str, Any]:
    """Who made it, when; and its scene files, which are copied beside the manifest: what the words of the scene were."""
    copies = {}
    for number, (scene, path) in enumerate(job.scenes.items()):
        copies[scene] = "scene.toml" if number == 0 else f"scene-{number}.toml"
        shutil.copyfile(path, pathlib.Path(job.out) / copies[scene])
    return {"date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"), "client": __version__,
            "python": platform.python_version(), "host": socket.gethostname(), "server": job.server, "scenes": copies,
            "areas": job.areas}


def read_manifest(out: str | os.PathLike[str]) -> dict[str, Any]:
    """Of a data set. FileNotFoundError where there is none, ValueError where it is none of ours."""
    path = pathlib.Path(out) / MANIFEST
    try:
        found = parsed(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        raise FileNotFoundError(f"{out}: no data set: it has no {MANIFEST}") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        number = found.get("format") if isinstance(found, dict) else found
        raise ValueError(f"{path}: format: found {number}; allowed: {FORMAT}")
    return found


def check_manifest(job: Job, worlds: Mapping[str, dict[str, Any]]) -> None:
    """Writes the manifest, or compares it with the one that is there. ValueError names what differs."""
    path = pathlib.Path(job.out) / MANIFEST
    mine = json.loads(json.dumps(manifest_of(job, worlds)))
    if not path.exists():
        if any(pathlib.Path(job.out).glob("part-*")):
            raise ValueError(f"{job.out}: has parts but no {MANIFEST}: not a data set of obliq's")
        # Two that begin at once: the second finds the first's, or writes the same.
        draft = path.with_name(f".{MANIFEST}.draft.{uuid.uuid4().hex}")
        write_whole(draft, json.dumps({**mine, "provenance": provenance(job)}, indent=1) + "\n")
        with contextlib.suppress(FileExistsError):
            os.link(draft, path)
        draft.unlink()
    found = read_manifest(job.out)
    for scene, world in worlds_in(mine).items():
        theirs = worlds_in(found).get(scene)
        if theirs is None:
            raise ValueError(f"{path}: scene: found none of the name {scene!r}; this run has it. Choose another folder")
        same_world(theirs, world, str(path))
    if all(world.get("scene_hash") for world in worlds_in(mine).values()):
        warn_without_hash(worlds_in(found), str(path))
    for key, value in mine.items():
        if key in ("world", "worlds", "parts") or (key == "min_coverage" and key not in found and not value):
            continue
        theirs = found.get(key)
        if theirs != value:
            if isinstance(value, dict) and isinstance(theirs, dict):
                part = next(name for name in {**value, **theirs} if value.get(name) != theirs.get(name))
                key, theirs, value = f"{key}.{part}", theirs.get(part), value.get(part)
            raise ValueError(f"{path}: {key}: found {theirs!r}; this run has {value!r}. Choose another folder for another data set")

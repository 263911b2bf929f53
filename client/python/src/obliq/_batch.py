"""Many poses to a data set, by any number of workers on any number of machines, whichever of them are killed.

The unit of work is a shard. The engine gives shards to workers: a concurrent.futures executor (Dask has one),
a loop of Ray tasks, `--shard I/N` in pods. Nothing here schedules.
"""
from __future__ import annotations

import collections
import concurrent.futures
import contextlib
import dataclasses
import json
import os
import pathlib
import sys
import tempfile
import threading
import time
import uuid

from . import _seeds
from ._poses import read_poses
from ._requests import Tls
from ._shards import FORMAT, MANIFEST, Dataset, PartWriter, digest, parsed, part_name, sweep, write_whole
from .client import connect
from .local import Daemon
from .parameters import Pose, Settings
from .planes import plane_names


@dataclasses.dataclass(frozen=True)
class Job:
    """All that a worker on another machine needs; run(number) does one shard."""

    out: str
    poses: tuple  # (id, pose as dict, settings as dict, line)
    planes: tuple
    settings: dict
    radar: str  # whose patterns and name the frames have
    seed: int
    speckle_per_frame: bool
    shard_size: int
    server: str | None
    token_file: str | None
    ca_file: str | None
    tls: bool
    local: str | None
    obliqd: str | None
    local_settings: dict
    timeout: float

    def shards(self):
        return range(-(-len(self.poses) // self.shard_size))

    def run(self, number):
        """One shard; its frames, failed poses and seconds. Does nothing where the shard is there."""
        for done in self.run_some([number]):
            return done
        return number, 0, 0, 0.0

    def run_some(self, numbers):
        """The same of each shard that is not there, one after the other on one connection: while one is brought to the
        disk, frames of the next are taken."""
        numbers = [number for number in numbers if not (pathlib.Path(self.out) / part_name(number)).is_dir()]
        if not numbers:
            return
        began = time.monotonic()
        with self.connected() as server, concurrent.futures.ThreadPoolExecutor(1) as disk:
            check_manifest(self, world_of(server, self))
            wanted = read_manifest(self.out)["world"]
            asked = (self._asked(place) for number in numbers for place in self._places_of(number))
            results = server.render_many(asked, planes=self.planes, timeout=self.timeout, return_exceptions=True,
                                         radar=self.radar)
            before = None
            for number in numbers:
                part = PartWriter(self.out, number)
                try:
                    frames, failed = self._fill(part, number, results, wanted, server)
                except BaseException:
                    part.close()
                    raise
                now = time.monotonic()
                written = disk.submit(part.finish)
                if before:
                    before[0].result()
                    yield before[1:]
                before, began = (written, number, frames, failed, now - began), now
            before[0].result()
            yield before[1:]

    def _fill(self, part, number, results, wanted, server):
        """Counts of its frames and of its poses that failed."""
        frames = failed = 0
        for place, result in zip(self._places_of(number), results):
            its_id, _, _, line = self.poses[place]
            if isinstance(result, Exception):
                part.fail(its_id, line, result)
                failed += 1
                continue
            same_world(wanted, world_of_frame(result, server), its_id)
            part.add(its_id, result)
            frames += 1
        return frames, failed

    def _places_of(self, number):
        """Of a shard's poses in the data set."""
        return range(number * self.shard_size, min((number + 1) * self.shard_size, len(self.poses)))

    def _asked(self, place):
        """What is drawn follows from the place alone, so that shares, workers and resumed runs make the same frames; a line
        may name its own."""
        _, pose, its, _ = self.poses[place]
        return Pose.of(pose), Settings.of({**self.settings, **_seeds.draw(self.seed, place, self.speckle_per_frame), **its})

    @contextlib.contextmanager
    def connected(self):
        if self.server is not None:
            tls = Tls(self.ca_file) if self.tls or self.ca_file else None
            with connect(self.server, token_file=self.token_file, tls=tls, name="batch", timeout=30.0) as server:
                yield server
            return
        with connect(own_daemon(self.local, self.obliqd, self.local_settings), name="batch", timeout=30.0) as server:
            yield server


_daemons = {}  # of this process, which end with it
_one_at_a_time = threading.Lock()


def own_daemon(scene, obliqd, settings):
    """The address of this process's own daemon for a scene: started once, for all its shards."""
    key = (os.getpid(), scene, obliqd, json.dumps(settings, sort_keys=True))
    with _one_at_a_time:
        if key in _daemons and not _daemons[key].is_running():
            _daemons.pop(key).stop()
        if key not in _daemons:
            _daemons[key] = Daemon(scene, obliqd, settings)
        return _daemons[key].address


def stop_own_daemons():
    for key in [key for key in _daemons if key[0] == os.getpid()]:
        _daemons.pop(key).stop()


# ---- What a data set was made of ----

def world_of_frame(frame, server):
    """What bits depend on beside pose and settings."""
    d = frame.descriptor
    return {"server_version": server.info.version, "scene": d.scene_name, "origin_latitude_deg": d.origin_latitude_deg,
            "origin_longitude_deg": d.origin_longitude_deg, "radius_factor": repr(d.radius_factor), "cell_m": d.cell_m,
            "buildings": d.buildings_in_scene,
            "materials_sha256": digest([material.SerializeToString(deterministic=True).hex() for material in d.materials])}


def world_of(server, job):
    """Of a server: by a frame of one bin with nothing in it that could be refused, from where its radar stands, or else from
    the first pose that it takes."""
    tiny = Settings(azimuth_bins=1, range_bins=1, pixel_columns=1, pixel_rows=1, frustum="sweep", scan_mode="frame",
                    **Settings.ideal)
    for place in [server.radar(job.radar).pose, *(Pose.of(pose) for _, pose, _, _ in job.poses[:20])]:
        for result in server.render_many([place], tiny, planes="state", timeout=job.timeout, return_exceptions=True):
            if not isinstance(result, Exception):
                return world_of_frame(result, server)
            error = result
    raise error


def same_world(wanted, found, its_id):
    for key, value in wanted.items():
        if found.get(key) != value:
            raise ValueError(f"{its_id}: {key}: found {found.get(key)!r}; allowed: {value!r}, as in the manifest. The daemon "
                             "has another origin or another scene than the one that began the data set, and its bits differ: "
                             "start it again with the same scene file, or choose another folder")


def manifest_of(job, world):
    return {"format": FORMAT, "poses": len(job.poses), "poses_sha256": digest([pose[:3] for pose in job.poses]),
            "shard_size": job.shard_size, "planes": list(job.planes), "settings": job.settings, "radar": job.radar,
            "seed": job.seed, "speckle_per_frame": job.speckle_per_frame, "world": world}


def read_manifest(out):
    return parsed((pathlib.Path(out) / MANIFEST).read_text())


def check_manifest(job, world):
    """Writes the manifest, or compares it with the one that is there. ValueError names what differs."""
    path = pathlib.Path(job.out) / MANIFEST
    mine = json.loads(json.dumps(manifest_of(job, world)))
    if not path.exists():
        if any(pathlib.Path(job.out).glob("part-*")):
            raise ValueError(f"{job.out}: has parts but no {MANIFEST}: not a data set of obliq's")
        # Two that begin at once: the second finds the first's, or writes the same.
        draft = path.with_name(f".{MANIFEST}.draft.{uuid.uuid4().hex}")
        write_whole(draft, json.dumps(mine, indent=1) + "\n")
        with contextlib.suppress(FileExistsError):
            os.link(draft, path)
        draft.unlink()
    found = read_manifest(job.out)
    for key, value in mine.items():
        theirs = found.get(key)
        if key == "world":
            same_world(theirs, value, str(path))
        elif theirs != value:
            if isinstance(value, dict) and isinstance(theirs, dict):
                part = next(name for name in {**value, **theirs} if value.get(name) != theirs.get(name))
                key, theirs, value = f"{key}.{part}", theirs.get(part), value.get(part)
            raise ValueError(f"{path}: {key}: found {theirs!r}; this run has {value!r}. Choose another folder for another data set")


def make_folder(out):
    """A folder that can be written; modes say little to root, and nothing about a disk that is read-only."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except (FileExistsError, NotADirectoryError):
        raise NotADirectoryError(f"{out}: found a file; allowed: a folder, new or of the same data set") from None
    except OSError as error:
        raise PermissionError(f"{out}: cannot be written: {error.strerror}") from None


# ---- The whole run ----

@dataclasses.dataclass(frozen=True)
class Done:
    frames: int  # rendered by this run
    failed: int
    parts: int  # that are there now, of all
    parts_wanted: int
    seconds: float
    first_failed: dict | None = None  # its line of failed.jsonl

    @property
    def complete(self):
        return self.parts == self.parts_wanted


def prepare(poses, out, *, server=None, local=None, planes="iq state", settings=None, shard_size=64, token_file=None, tls=False,
            ca_file=None, obliqd=None, local_settings=None, radar=None, seed=0, speckle_per_frame=False, timeout=300.0):
    """The Job of a data set, checked against its folder. For engines that are no executor (Ray): job.run(number) for each
    number of todo(job). seed: a whole number from which each frame has noise and independent speckle of its own
    (noise_frame), unless its line names them; speckle_per_frame: a speckle_seed of its own as well, so that the ground's
    speckle is another in each frame."""
    if (server is None) == (local is None):
        raise TypeError("batch() needs one of server='HOST:PORT' and local='scene.toml'")
    if shard_size < 1:
        raise ValueError(f"shard_size: found {shard_size}; allowed: from 1")
    out = pathlib.Path(out)
    make_folder(out)
    sweep(out)
    job = Job(str(out.resolve()), read_poses(poses), plane_names(planes), {}, "", _seeds.checked(seed), bool(speckle_per_frame),
              shard_size, server, token_file, ca_file, tls, None if local is None else str(pathlib.Path(local).resolve()),
              obliqd, local_settings or {}, timeout)
    with job.connected() as connected:
        # Whole settings, so that a default of another version, or a change of the live radar, cannot slip in.
        known = connected.info.radars
        name = radar or ("main" if "main" in known else known[0])
        base = connected.radar(name).settings.replace(scan_mode="frame")
        job = dataclasses.replace(job, radar=name,
                                  settings=Settings.of({**base.as_dict(), **Settings.of(settings).as_dict()}).as_dict())
        check_manifest(job, world_of(connected, job))
    return job


def todo(job, shard=None):
    """Numbers of the shards that are not there, of those that part I of N is to do ("2/8"; 0 counts as N)."""
    first, n = 0, 1
    if shard is not None:
        first, n = _share(shard)
    return [number for number in job.shards()
            if number % n == first % n and not (pathlib.Path(job.out) / part_name(number)).is_dir()]


def _share(shard):
    i, slash, n = str(shard).partition("/")
    if not (slash and i.isdigit() and n.isdigit() and int(n) >= 1 and int(i) <= int(n)):
        raise ValueError(f"shard: found {shard!r}; allowed: I/N with I from 0 or 1 to N")
    return int(i), int(n)


def batch(poses, out, *, executor=None, shard=None, progress=None, **options):
    """Renders poses into a data set; options as those of prepare(). executor: any concurrent.futures executor, whose workers
    see the folder `out`; None: this process. Call it again after any failure: it does what is missing. Returns Done."""
    began = time.monotonic()
    if shard is not None:
        _share(shard)
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError(f"executor: found {type(executor).__name__}; allowed: a concurrent.futures executor")
    try:
        job = prepare(poses, out, **options)
        if executor is not None:
            stop_own_daemons()  # its workers start theirs
        numbers = todo(job, shard)
        say = Progress(len(numbers) * job.shard_size, progress)
        frames = failed = 0
        for _, more, lost, _ in _results(job, numbers, executor):
            frames, failed = frames + more, failed + lost
            say(frames + failed)
    finally:
        stop_own_daemons()
    found = Dataset(out)
    if not found.missing:
        write_whole(pathlib.Path(out) / "failed.jsonl", "".join(json.dumps(line) + "\n" for line in found.failed))
    wanted = found.parts_wanted
    return Done(frames, len(found.failed), wanted - len(found.missing), wanted, time.monotonic() - began,
                found.failed[0] if found.failed else None)


def _results(job, numbers, executor):
    """As they come. A failure ends the run when the others that have begun are done."""
    if executor is None:
        yield from job.run_some(numbers)
        return
    failures = collections.deque(maxlen=1)
    waiting = [executor.submit(job.run, number) for number in numbers]
    for future in concurrent.futures.as_completed(waiting) if all(
            isinstance(future, concurrent.futures.Future) for future in waiting) else waiting:
        try:
            yield future.result()
        except Exception as error:
            failures.append(error)
    if failures:
        raise failures[0]


class Progress:
    """A line on standard error now and then: how far, how fast, until when."""

    def __init__(self, total, wanted):
        self._total, self._began, self._last = total, time.monotonic(), 0.0
        self._wanted = sys.stderr.isatty() if wanted is None else wanted

    def __call__(self, done):
        now = time.monotonic()
        if not self._wanted or (now - self._last < 2 and done < self._total):
            return
        self._last = now
        rate = done / max(now - self._began, 1e-9)
        left = max(0, self._total - done) / max(rate, 1e-9)
        end = time.strftime("%H:%M:%S", time.localtime(time.time() + left))
        print(f"obliq.batch: {done} of at most {self._total} frames, {rate:.1f} a second, until {end}", file=sys.stderr)

"""Many poses to a data set, by any number of workers on any number of machines, whichever of them are killed.

The unit of work is a shard. The engine gives shards to workers: a concurrent.futures executor (Dask has one),
a loop of Ray tasks, `--shard I/N` in pods. Nothing here schedules.
"""
from __future__ import annotations

import collections
import concurrent.futures
import contextlib
import dataclasses
import itertools
import os
import pathlib
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np

from .. import _seeds
from . import judge
from .area import area_of, printed_config, with_area
from .daemons import own_daemon, stop_own_daemons
from .files import SUMS, as_lines, file_sum, read_sums, sum_lines, write_whole
from .poses import Line, Poses, name_of, read_poses
from .progress import Done, Progress, Watch
from .._requests import Tls
from .shards import PartWriter, failed_of, part_name, parts_of, sweep
from .world import MANIFEST, check_manifest, read_manifest, same_world, world_of, world_of_frame, worlds_in
from ..client import Server, connect
from .dataset import Dataset
from ..frame import Frame
from ..parameters import Pose, Settings, SettingsFields
from ..planes import Planes, plane_names

Shard = tuple[int, int, int, float]  # number, frames, failed poses, seconds


@dataclasses.dataclass(frozen=True)
class Left:
    """Of a shard the places without a frame, and how many parts (`again`) were there when they were looked for: the number of the
    part that they come into. Where another worker has made that part meanwhile, the other worker's stays."""

    number: int
    again: int
    places: list[int]


@dataclasses.dataclass(frozen=True)
class Job:
    """All that a worker on another machine needs; run(number) does one shard. radar: whose patterns and name the frames have.
    scenes: the scene files, by their names in the lines; "": of lines that name none. areas: by scene, what is loaded of it."""

    out: str
    name: str
    lines: tuple[Line, ...]
    planes: tuple[str, ...]
    settings: dict[str, Any]
    radar: str
    seed: int
    speckle_per_frame: bool
    shard_size: int
    min_coverage: float
    server: str | None
    token_file: str | None
    ca_file: str | None
    tls: bool
    scenes: dict[str, str]
    obliqd: str | None
    local_settings: dict[str, Any]
    areas: dict[str, list[list[float]] | None]
    timeout: float

    def shards(self) -> range:
        """Numbers of all shards."""
        return range(len(self._shards()))

    def _shards(self) -> list[list[int]]:
        """Places of each shard's poses in the data set. A shard is of one scene."""
        by_scene: dict[str, list[int]] = {}
        for place, line in enumerate(self.lines):
            by_scene.setdefault(line.scene, []).append(place)
        return [places[first: first + self.shard_size] for places in by_scene.values()
                for first in range(0, len(places), self.shard_size)]

    def run(self, number: int) -> Shard:
        """One shard; its frames, failed poses and seconds. Does nothing where the shard is there; poses that failed before are
        taken up again."""
        for done in self.run_some([number]):
            return done
        return number, 0, 0, 0.0

    def run_some(self, numbers: Sequence[int]) -> Iterator[Shard]:
        """The same of each shard that is not there, one after the other on one connection: while one is brought to the
        disk, frames of the next are taken."""
        shards = self._shards()
        wanted = [left for number in numbers if (left := self._left(number, shards[number])).places]
        for scene, some in itertools.groupby(wanted, key=lambda left: self.lines[left.places[0]].scene):
            with self.connected(scene) as server:
                check_manifest(self, {scene: world_of(server, self, scene)})
                yield from self._render(server, list(some))

    def _left(self, number: int, places: list[int]) -> Left:
        again = len(parts_of(self.out, number))
        if again:
            failed = {line["id"] for line in failed_of(self.out, number)}
            places = [place for place in places if self.lines[place].id in failed]
        return Left(number, again, places)

    def _render(self, server: Server, wanted: list[Left]) -> Iterator[Shard]:
        began = time.monotonic()
        scene = self.lines[wanted[0].places[0]].scene
        world = worlds_in(read_manifest(self.out))[scene]
        places = [place for left in wanted for place in left.places]
        low = self._too_low(server, places)
        results = server.render_many([self.asked(place) for place in places if place not in low], planes=self.planes,
                                     timeout=self.timeout, return_exceptions=True, radar=self.radar,
                                     truth=any(self.lines[place].targets is not None for place in places))
        before: tuple[concurrent.futures.Future[None], Shard] | None = None
        with concurrent.futures.ThreadPoolExecutor(1) as disk:
            for left in wanted:
                part = PartWriter(self.out, left.number, len(left.places), left.again)
                try:
                    frames = self._fill(part, left.places, low, results, world, server)
                except BaseException:
                    part.close()
                    raise
                now = time.monotonic()
                written = disk.submit(part.finish if frames or not left.again else part.close)
                if before:
                    before[0].result()
                    yield before[1]
                before, began = (written, (left.number, frames, len(left.places) - frames, now - began)), now
            if before:
                before[0].result()
                yield before[1]

    def _fill(self, part: PartWriter, places: Iterable[int], low: Mapping[int, Exception],
              results: Iterator[Any], world: Mapping[str, Any], server: Server) -> int:
        """How many frames there are; the other poses failed."""
        frames = 0
        for place in places:
            line, result = self.lines[place], low.get(place) or next(results)
            if isinstance(result, Frame):
                same_world(world, world_of_frame(result, server), f"{self.name}, line {line.number}")
                coverage = result.summary.coverage if result.summary is not None else 0.0
                if coverage < self.min_coverage:
                    result = judge.too_low(coverage, self.min_coverage)
            if isinstance(result, Frame):
                part.add(line, result)
                frames += 1
            else:
                part.fail(line, result)
        return frames

    def _too_low(self, server: Server, places: Sequence[int]) -> dict[int, Exception]:
        """Those whose coverage is far too low, before they are rendered: the frame's own is the last word."""
        if self.min_coverage <= 0:
            return {}
        found = judge.coverage_of(server, [self.lines[place] for place in places], self.settings)
        return {place: judge.too_low(float(coverage), self.min_coverage) for place, coverage in zip(places, found)
                if coverage < self.min_coverage - 0.1}

    def asked(self, place: int) -> tuple[Pose, Settings, tuple[dict[str, Any], ...]]:
        """Pose, settings and targets of a frame. What is drawn follows from the place alone, so that shares, workers and
        resumed runs make the same frames; a line may name its own."""
        line = self.lines[place]
        drawn = _seeds.draw(self.seed, place, self.speckle_per_frame)
        return Pose.of(line.pose), Settings.of({**self.settings, **drawn, **line.settings}), line.targets or ()

    def radar_of(self, server: Server) -> str:
        """Of a server: the radar of that name, or its first."""
        known = server.info.radars
        return self.radar if self.radar in known else "main" if "main" in known else known[0]

    @contextlib.contextmanager
    def connected(self, scene: str = "") -> Iterator[Server]:
        """The server, or the process's own daemon for a scene."""
        if self.server is not None:
            tls = Tls(self.ca_file) if self.tls or self.ca_file else None
            with connect(self.server, token_file=self.token_file, tls=tls, name="batch", timeout=30.0) as server:
                yield server
            return
        settings = with_area(self.local_settings, self.areas.get(scene))
        with own_daemon(self.scenes[scene], self.obliqd, settings) as address:
            with connect(address, name="batch", timeout=30.0) as server:
                yield server


def make_folder(out: pathlib.Path) -> None:
    """A folder that can be written; modes say little to root, and nothing about a disk that is read-only."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except (FileExistsError, NotADirectoryError):
        raise NotADirectoryError(f"{out}: found a file; allowed: a folder, new or of the same data set") from None
    except OSError as error:
        raise PermissionError(f"{out}: cannot be written: {error.strerror}") from None


def _scenes(lines: Sequence[Line], name: str, given: Poses, server: str | None, local: object) -> dict[str, str]:
    """The scene files by their names in the lines. A line's is looked for beside the file of poses."""
    scenes = {} if local is None else {"": str(pathlib.Path(os.fspath(local)).resolve())}  # type: ignore[call-overload]
    folder = pathlib.Path(os.fspath(given)).parent if isinstance(given, (str, os.PathLike)) else pathlib.Path()
    for line in lines:
        where = f"{name}, line {line.number}"
        if server is not None and line.scene:
            raise ValueError(f"{where}: scene: found {line.scene!r}; allowed with local= alone: a server has one scene")
        if server is None and line.scene not in scenes:
            path = folder / line.scene
            if not line.scene:
                raise ValueError(f"{where}: scene: found none; allowed: a scene file, here or by local=")
            if not path.is_file():
                raise ValueError(f"{where}: scene: found {line.scene!r}; allowed: a scene file, and {path} is none")
            scenes[line.scene] = str(path.resolve())
    used = {line.scene for line in lines}
    return {scene: path for scene, path in scenes.items() if scene in used}


def _job(poses: Poses, out: pathlib.Path, *, server: str | None = None, local: str | os.PathLike[str] | None = None,
         planes: Planes = "iq state", settings: Settings | SettingsFields | Mapping[str, Any] | None = None, shard_size: int = 64,
         token_file: str | None = None, tls: bool = False, ca_file: str | None = None, obliqd: str | None = None,
         local_settings: Mapping[str, Any] | None = None, radar: str | None = None, seed: int = 0,
         speckle_per_frame: bool = False, min_coverage: float = 0.0, area: Literal["poses", "scene"] = "poses",
         timeout: float = 300.0) -> Job:
    """What is asked for, before any server is."""
    if server is not None and local is not None:
        raise TypeError("batch() needs one of server='HOST:PORT' and local='scene.toml'")
    if shard_size < 1:
        raise ValueError(f"shard_size: found {shard_size}; allowed: from 1")
    if not 0 <= min_coverage <= 1:
        raise ValueError(f"min_coverage: found {min_coverage}; allowed: 0 to 1")
    if area not in ("poses", "scene"):
        raise ValueError(f"area: found {area!r}; allowed: 'poses', 'scene'")
    lines, name = read_poses(poses), name_of(poses)
    if server is None and local is None and not all(line.scene for line in lines):
        raise TypeError("batch() needs one of server='HOST:PORT' and local='scene.toml', or a scene in each line")
    scenes = _scenes(lines, name, poses, server, local)
    given = Settings.of(settings).as_dict()  # type: ignore[arg-type, unused-ignore]
    own = dict(local_settings or {})
    areas: dict[str, list[list[float]] | None] = {}
    for scene, path in scenes.items():
        if area == "poses" and pathlib.Path(path).is_file():
            areas[scene] = area_of([line for line in lines if line.scene == scene], given, printed_config(path, obliqd, own))
    return Job(str(out.resolve()), name, lines, plane_names(planes), given, radar or "", _seeds.checked(seed),
               bool(speckle_per_frame), shard_size, float(min_coverage), server, token_file, ca_file, tls, scenes, obliqd, own,
               areas, timeout)


def _with_settings(job: Job, server: Server) -> Job:
    """Whole settings, so that a default of another version, or a change of the live radar, cannot slip in."""
    radar = job.radar or job.radar_of(server)
    base = server.radar(radar).settings.replace(scan_mode="frame")
    return dataclasses.replace(job, radar=radar, settings={**base.as_dict(), **job.settings})


def _each_scene(job: Job) -> Iterator[tuple[str, Server]]:
    """The server for each scene of the lines."""
    for scene in dict.fromkeys(line.scene for line in job.lines):
        with job.connected(scene) as server:
            yield scene, server


def prepare(poses: Poses, out: str | os.PathLike[str], **options: Any) -> Job:
    """The Job of a data set, checked against its folder. For engines that are no executor (Ray): job.run(number) for each
    number of todo(job). Options as those of batch()."""
    out = pathlib.Path(out)
    make_folder(out)
    sweep(out)
    job = _job(poses, out, **options)
    worlds: dict[str, dict[str, Any]] = {}
    said = 0
    for scene, server in _each_scene(job):
        job = _with_settings(job, server) if not worlds else job
        worlds[scene] = world_of(server, job, scene)
        lines = [line for line in job.lines if line.scene == scene]
        if not said and server.info.limits.max_query_points and (off := judge.off_the_ground(server, lines)):
            said = len(off)
            print(f"obliq.batch: {said} of {len(lines)} poses stand where no ground is loaded: {job.name}, line {off[0].number}"
                  f"{'' if job.server is None else '; terrain.area in the scene file says what is loaded'}", file=sys.stderr)
    check_manifest(job, worlds)
    return job


def check(poses: Poses, **options: Any) -> judge.Checked:
    """All poses judged, none rendered, nothing written: which would be refused, and how much of each sector has ground.
    Options as those of batch()."""
    try:
        job = _job(poses, pathlib.Path(), **options)
        refused: list[tuple[int, dict[str, Any]]] = []
        coverage = np.full(len(job.lines), np.nan)
        first = True
        for scene, server in _each_scene(job):
            job, first = (_with_settings(job, server) if first else job), False
            places = [place for place, line in enumerate(job.lines) if line.scene == scene]
            lines = [job.lines[place] for place in places]
            coverage[places] = judge.coverage_of(server, lines, job.settings)
            errors = judge.refusals(server, [job.asked(place) for place in places], job.timeout, job.radar)
            for place, line, error in zip(places, lines, errors):
                if error is None and coverage[place] < job.min_coverage:
                    error = judge.too_low(coverage[place], job.min_coverage)
                if error is not None:
                    refused.append((place, {"id": line.id, "line": line.number, "text": str(error)}))
        return judge.Checked(len(job.lines), [row for _, row in sorted(refused, key=lambda item: item[0])], coverage)
    finally:
        stop_own_daemons()


def todo(job: Job, shard: str | None = None) -> list[int]:
    """Numbers of the shards that are not there, or have poses that failed, of those that part I of N is to do ("2/8"; 0
    counts as N)."""
    first, n = _share(shard) if shard is not None else (0, 1)
    return [number for number in job.shards() if number % n == first % n
            and (not (pathlib.Path(job.out) / part_name(number)).is_dir() or failed_of(job.out, number))]


def _share(shard: str) -> tuple[int, int]:
    i, slash, n = str(shard).partition("/")
    if not (slash and i.isdigit() and n.isdigit() and int(n) >= 1 and int(i) <= int(n)):
        raise ValueError(f"shard: found {shard!r}; allowed: I/N with I from 0 or 1 to N")
    return int(i), int(n)


def batch(poses: Poses, out: str | os.PathLike[str], *, executor: concurrent.futures.Executor | None = None,
          shard: str | None = None, progress: Watch = None, **options: Any) -> Done:
    """Renders poses into a data set. Call it again after any failure: it does what is missing, and takes up poses that were
    refused. Returns Done.

    poses: a file of JSON lines, or poses and dicts. A line has fields of a pose and of the settings, and id, meta (an object
    of your own columns), split ("train"), scene (the path of another scene file).
    out: the folder. executor: any concurrent.futures executor, whose workers see that folder; None: this process. shard: "I/N",
    a share of the work. progress: called with frames done and in all; True: lines on standard error.

    server: HOST:PORT, with token_file, tls, ca_file; or local: a scene file, for which obliqd is started and stopped. obliqd:
    the program; local_settings: what its --set would take. area: "poses" loads the ground that the poses reach, where the scene
    file names no area of its own; "scene" loads what it says.
    planes: "iq state". settings: of all frames, else as the server's radar has them; radar: which. shard_size: poses a part.
    min_coverage: a frame with less ground in its sector fails. seed: a whole number from which each frame has noise and
    independent speckle of its own (noise_frame), unless its line names them; speckle_per_frame: a speckle_seed of its own as
    well, so that the ground's speckle is another in each frame. timeout: seconds for each frame."""
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
        every = job._shards()
        say = Progress(sum(len(job._left(number, every[number]).places) for number in numbers), progress)
        frames = failed = 0
        for _, more, lost, _ in _results(job, numbers, executor):
            frames, failed = frames + more, failed + lost
            say(frames + failed)
    finally:
        stop_own_daemons()
    return _finish(pathlib.Path(out), frames, began)


def _finish(out: pathlib.Path, frames: int, began: float) -> Done:
    """What is said of a whole data set: the poses that failed, and the sums of all files."""
    found = Dataset(out, _quiet=True)
    wanted = found.parts_wanted
    if not found.missing:
        write_whole(out / "failed.jsonl", as_lines(found.failed))
        sums = {path.name: file_sum(path) for path in (out / MANIFEST, out / "failed.jsonl", *out.glob("scene*.toml"))}
        for part in sorted(out.glob("part-*")):
            sums.update({f"{part.name}/{name}": value for name, value in read_sums(part / SUMS).items()})
        write_whole(out / SUMS, sum_lines(sums))
    return Done(frames, len(found.failed), wanted - len(found.missing), wanted, time.monotonic() - began,
                found.failed[0] if found.failed else None)


def _results(job: Job, numbers: Sequence[int], executor: concurrent.futures.Executor | None) -> Iterator[Shard]:
    """As they come. A failure ends the run when the others that have begun are done."""
    if executor is None:
        yield from job.run_some(numbers)
        return
    failures: collections.deque[Exception] = collections.deque(maxlen=1)
    waiting = [executor.submit(job.run, number) for number in numbers]
    for future in concurrent.futures.as_completed(waiting) if all(
            isinstance(future, concurrent.futures.Future) for future in waiting) else waiting:
        try:
            yield future.result()
        except Exception as error:
            failures.append(error)
    if failures:
        raise failures[0]

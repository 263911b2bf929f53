"""Targets: vehicles, ships and aircraft of a server's world, and where they are in a frame. PROTOCOL.md, "Targets"."""
from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal, TypedDict, Union

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire
from ._fields import Fields
from .errors import BadStream

HIDDEN_BY = ("nothing", "ground", "building", "horizon", "unknown_ground")
# A record as it follows a TargetBlock; a later server's may be longer.
RECORD = np.dtype([("id", "<u8"), ("latitude_deg", "<f8"), ("longitude_deg", "<f8"), ("height_m", "<f8"),
                   ("bearing_deg", "<f8"), ("range_m", "<f8"), ("elevation_deg", "<f4"), ("closing_m_s", "<f4"),
                   ("snr_db", "<f4"), ("rcs_dbsm", "<f4"), ("share_seen", "<f4"), ("azimuth_bin", "<i4"),
                   ("range_bin", "<i4"), ("hidden_by", "u1"), ("is_power", "?"), ("reserved", "<u2")])
# Of the targets in one message, well below what a server takes.
PAGE_BYTES = 1 << 17


@dataclasses.dataclass(frozen=True)
class Route:
    """Where a target goes from its place: to each point in turn. height_m: over the target's reference; empty: its own.
    speed_m_s: on the way to each point, or one for all. loops: back to its place, and so on."""

    latitude_deg: Sequence[float] = ()
    longitude_deg: Sequence[float] = ()
    speed_m_s: float | Sequence[float] = 10.0
    height_m: Sequence[float] = ()
    loops: bool = False

    def message(self) -> wire.TargetRoute:
        """As it is sent."""
        speeds = [self.speed_m_s] if isinstance(self.speed_m_s, (int, float)) else self.speed_m_s
        return wire.TargetRoute(latitude_deg=self.latitude_deg, longitude_deg=self.longitude_deg, height_m=self.height_m,
                                speed_m_s=speeds, loops=self.loops)

    @staticmethod
    def read(message: wire.TargetRoute) -> Route:
        """From the message."""
        return Route(tuple(message.latitude_deg), tuple(message.longitude_deg), tuple(message.speed_m_s),
                     tuple(message.height_m), message.loops)


class TargetFields(TypedDict, total=False):
    """Keywords that Target takes."""

    id: int
    name: str | None
    type: str | None
    latitude_deg: float | None
    longitude_deg: float | None
    height_m: float | None
    height_reference: Literal["datum", "ground", "ellipsoid"] | None
    geoid_undulation_m: float | None
    velocity_north_m_s: float | None
    velocity_east_m_s: float | None
    velocity_up_m_s: float | None
    acceleration_north_m_s2: float | None
    acceleration_east_m_s2: float | None
    acceleration_up_m_s2: float | None
    heading_deg: float | None
    heading_rate_deg_s: float | None
    rcs_dbsm: float | None
    swerling: int | None
    length_m: float | None
    width_m: float | None
    top_m: float | None
    sim_time_ns: int | None
    valid_s: float | None
    age_s: float | None
    route: Route | None


@dataclasses.dataclass(frozen=True, repr=False)
class Target(Fields):
    """A target. None: as it is; of a new one its type's value, or the default.

    id: from 1.  name; type: of the scene's [target_types.NAME].  latitude_deg, longitude_deg, height_m over
    height_reference ("ground", the default, "datum" or "ellipsoid" with geoid_undulation_m): its foot.  velocity_...,
    acceleration_...: along its own north, east and up.  heading_deg: of its nose; None of a new one: along its course.
    heading_rate_deg_s.  rcs_dbsm: mean radar cross section.  swerling: 0 to 4.  length_m, width_m: of what echoes; 0: a
    point.  top_m: over its foot, what a hill must hide.  sim_time_ns: of place and motion, by the poses' clock; None: of
    its arrival.  age_s: place and motion were so this long ago.  valid_s: it goes so long after its arrival; 0: never.
    route: a Route, in place of a velocity.
    """

    id: int | None = None
    name: str | None = None
    type: str | None = None
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    height_m: float | None = None
    height_reference: Literal["datum", "ground", "ellipsoid"] | None = None
    geoid_undulation_m: float | None = None
    velocity_north_m_s: float | None = None
    velocity_east_m_s: float | None = None
    velocity_up_m_s: float | None = None
    acceleration_north_m_s2: float | None = None
    acceleration_east_m_s2: float | None = None
    acceleration_up_m_s2: float | None = None
    heading_deg: float | None = None
    heading_rate_deg_s: float | None = None
    rcs_dbsm: float | None = None
    swerling: int | None = None
    length_m: float | None = None
    width_m: float | None = None
    top_m: float | None = None
    sim_time_ns: int | None = None
    valid_s: float | None = None
    age_s: float | None = None
    route: Route | None = None

    @classmethod
    def _checked(cls, call: str, name: str, value: Any) -> Any:
        if name != "route" or value is None or isinstance(value, Route):
            return super()._checked(call, name, value) if name != "route" else value
        if isinstance(value, Mapping):
            return Route(**value)
        raise TypeError(f"{call}() got route={value!r}; allowed: obliq.targets.Route or a dict of its fields")

    @classmethod
    def read(cls, message: Any) -> Target:
        """From the message."""
        values = {name: getattr(message, name) for name in cls.names() if name == "id" or message.HasField(name)}
        if "height_reference" in values:
            values["height_reference"] = next((text for text, number in cls.choices["height_reference"].items()
                                               if number == values["height_reference"]), None)
        if "route" in values:
            values["route"] = Route.read(values["route"])
        return cls(**values)


Target.choices = {"height_reference": {"datum": 0, "ground": 1, "ellipsoid": 2}}

TargetLike = Union[Target, TargetFields, Mapping[str, Any]]


def message_of(target: TargetLike, call: str = "Target") -> wire.Target:
    """As it is sent. TypeError or ValueError names the field that does not fit."""
    given: Mapping[str, Any] = target.as_dict() if isinstance(target, Target) else target
    try:
        fields: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
        if "height_reference" in fields:
            fields["height_reference"] = Target.choices["height_reference"][fields["height_reference"]]
        if "route" in fields:
            route = fields["route"]
            fields["route"] = (route if isinstance(route, Route) else Route(**route)).message()
        message = wire.Target(**fields)
    except (TypeError, ValueError, KeyError, AttributeError):
        Target.of(given, call)  # says what is wrong
        raise
    if not message.id:
        raise ValueError(f"{call}() got a target without an id; allowed: a whole number from 1")
    return message


def messages_of(targets: Iterable[TargetLike], call: str) -> list[wire.Target]:
    """Of several."""
    if isinstance(targets, (Mapping, Target)):
        raise TypeError(f"{call}: found one target; allowed: a list of them")
    return [message_of(target, call) for target in targets]


def requests_of(targets: Sequence[wire.Target], gone: Iterable[int] = (), clear: bool = False) -> Iterator[wire.SetTargets]:
    """One SetTargets, in as many messages as it takes: the server does all of it at once. ValueError before the first: a change
    that does not end would be the beginning of the next."""
    for target in targets:
        if target.ByteSize() > PAGE_BYTES // 2:
            raise ValueError(f"target {target.id}: found {target.ByteSize()} bytes; allowed: at most {PAGE_BYTES // 2}")
    items: list[tuple[str, Any, int]] = [("gone", number, 10) for number in gone]
    items += [("targets", target, target.ByteSize() + 4) for target in targets]
    request, bytes_of_page = wire.SetTargets(clear=clear), 0
    for name, item, size in items:
        if bytes_of_page > PAGE_BYTES:
            request.more = True
            yield request
            request, bytes_of_page = wire.SetTargets(), 0
        getattr(request, name).append(item)
        bytes_of_page += size
    yield request


def records_of(block: wire.TargetBlock, plane: memoryview | bytes) -> npt.NDArray[Any]:
    """The records behind a TargetBlock, as RECORD."""
    size = block.record_bytes
    if size < RECORD.itemsize or block.records * size != len(plane):
        raise BadStream(f"TargetBlock: found {len(plane)} bytes for {block.records} records of {size}")
    fields = RECORD.fields
    assert fields is not None and RECORD.names is not None
    kind = np.dtype({"names": list(RECORD.names), "formats": [fields[name][0] for name in RECORD.names],
                     "offsets": [fields[name][1] for name in RECORD.names], "itemsize": size})
    return np.frombuffer(plane, kind).astype(RECORD)


@dataclasses.dataclass(frozen=True)
class World:
    """What of targets a RenderOnce asks for."""

    targets: tuple[wire.Target, ...] = ()
    live: bool = False
    truth: bool = False

    @staticmethod
    def of(targets: Iterable[TargetLike] | None, live: bool, truth: bool) -> World:
        """From what render() is given."""
        return World(tuple(messages_of(targets or (), "targets")), bool(live), bool(truth))

    def write(self, request: wire.RenderOnce) -> None:
        """Into the request."""
        request.targets.extend(self.targets)
        request.live_targets, request.truth = self.live, self.truth


NO_TARGETS = World()

"""Ground queries: what is at places, and whether an antenna sees points there. PROTOCOL.md, "Ground queries"."""
from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import obliq_pb2 as wire
from .errors import BadStream, ObliqError
from .parameters import Pose, PoseFields

STATES = ("known", "unknown", "outside", "too_near")
SIGHTS = ("not_asked", "visible", "visible_over_unknown", "behind_ground", "behind_building", "below_ground",
          "inside_building", "no_height")
# A record as it follows a GroundAnswer; a later server's may be longer.
MEMBERS = (("latitude_deg", "<f8"), ("longitude_deg", "<f8"), ("height_m", "<f8"), ("surface_height_m", "<f8"),
           ("point_height_m", "<f8"), ("slope_deg", "<f4"), ("downhill_deg", "<f4"), ("clearance_deg", "<f4"),
           ("obstacle_range_m", "<f4"), ("building", "<u4"), ("state", "u1"), ("sight", "u1"), ("material", "u1"),
           ("water", "?"))
RECORD = np.dtype(list(MEMBERS))
OF_GROUND = ("height_m", "surface_height_m", "slope_deg", "downhill_deg")
REFERENCES = {"datum": wire.DATUM, "ground": wire.GROUND, "ellipsoid": wire.ELLIPSOID}


Reference = Literal["datum", "ground", "ellipsoid"]
Floats = npt.NDArray[np.float64]


class GroundPoints:
    """What is at the places of a query: arrays of the shape in which the places were given.

    latitude_deg, longitude_deg; height_m of the ground, surface_height_m of a roof or the ground, point_height_m of the
    point that is seen or not, above the datum; slope_deg, downhill_deg (true bearing of the steepest descent);
    building (number, from 1; 0: none); material (index into .materials); water; state (index into obliq.ground.STATES);
    sight (index into obliq.ground.SIGHTS); clearance_deg (angle above what stands highest before the point, negative:
    hidden by so much); obstacle_range_m. What is not known is NaN. materials: their names. antenna: that looked; None: sight
    was not asked for.
    """

    latitude_deg: Floats
    longitude_deg: Floats
    height_m: Floats
    surface_height_m: Floats
    point_height_m: Floats
    slope_deg: npt.NDArray[np.float32]
    downhill_deg: npt.NDArray[np.float32]
    clearance_deg: npt.NDArray[np.float32]
    obstacle_range_m: npt.NDArray[np.float32]
    building: npt.NDArray[np.uint32]
    state: npt.NDArray[np.uint8]
    sight: npt.NDArray[np.uint8]
    material: npt.NDArray[np.uint8]
    water: npt.NDArray[np.bool_]

    def __init__(self, records: npt.NDArray[Any], shape: tuple[int, ...], materials: tuple[str, ...], antenna: Pose | None,
                 by_bearing: bool = False):
        self.materials = materials
        self.antenna = antenna
        unknown = records["state"] != 0
        for name, kind in MEMBERS:
            values = records[name].reshape(shape).astype(np.dtype(kind).newbyteorder("="))
            if name in OF_GROUND:
                values[unknown.reshape(shape)] = np.nan
            setattr(self, name, values)
        no_point = np.isin(records["sight"], (5, 6, 7, 0)).reshape(shape)
        self.clearance_deg[no_point] = np.nan
        self.obstacle_range_m[no_point] = np.nan
        self.point_height_m[(records["sight"] == 7).reshape(shape)] = np.nan
        if by_bearing:  # a place is known by its ground
            self.latitude_deg[~self.known] = self.longitude_deg[~self.known] = np.nan

    @property
    def shape(self) -> tuple[int, ...]:
        """In which the places were given."""
        return self.state.shape

    def __len__(self) -> int:
        return len(self.state)

    def __repr__(self) -> str:
        return f"<obliq.GroundPoints of shape {self.shape}>"

    @property
    def known(self) -> npt.NDArray[np.bool_]:
        """Where the ground is known."""
        return np.asarray(self.state == 0)

    @property
    def visible(self) -> npt.NDArray[np.bool_]:
        """Where nothing known hides the point; .sight tells where the way is not all known."""
        return np.asarray((self.sight == 1) | (self.sight == 2))

    @property
    def sight_name(self) -> npt.NDArray[np.object_]:
        """As in obliq.ground.SIGHTS."""
        return np.asarray(np.array(SIGHTS, object)[np.minimum(self.sight, len(SIGHTS) - 1)])

    @property
    def material_name(self) -> npt.NDArray[np.object_]:
        """Empty where the ground is not known."""
        names = np.array([*self.materials, ""], object)
        return np.asarray(names[np.where(self.known, np.minimum(self.material, len(self.materials)), len(self.materials))])


class Asked:
    """A query as the messages that ask it: as many as the server's limit makes of it."""

    def __init__(self, limits: wire.Limits, latitude_deg: npt.ArrayLike | None = None,
                 longitude_deg: npt.ArrayLike | None = None, height_m: npt.ArrayLike | None = None, *,
                 bearing_deg: npt.ArrayLike | None = None, range_m: npt.ArrayLike | None = None,
                 height_reference: str = "datum", geoid_undulation_m: float = 0.0, radar: str = "",
                 antenna: Pose | PoseFields | None = None):
        if limits.max_query_points == 0:
            raise ObliqError("this server answers no ground queries: it replays a recording, or is too old")
        if height_reference not in REFERENCES:
            raise ValueError(f"query() got height_reference={height_reference!r}; allowed: {', '.join(REFERENCES)}")
        geodetic = latitude_deg is not None or longitude_deg is not None
        by_bearing = bearing_deg is not None or range_m is not None
        pair = ("bearing_deg", bearing_deg, "range_m", range_m) if by_bearing else (
            "latitude_deg", latitude_deg, "longitude_deg", longitude_deg)
        if geodetic == by_bearing or pair[1] is None or pair[3] is None:
            raise TypeError("query() takes latitude_deg and longitude_deg, or bearing_deg and range_m")
        columns: dict[str, npt.ArrayLike] = {pair[0]: pair[1], pair[2]: pair[3]}
        if height_m is not None:
            columns["height_m"] = height_m
        arrays = np.broadcast_arrays(*(np.asarray(column, np.float64) for column in columns.values()))
        self.shape = arrays[0].shape
        self._columns = {name: array.ravel() for name, array in zip(columns, arrays)}
        for name, values in self._columns.items():
            if not np.isfinite(values).all():
                bad = int(np.flatnonzero(~np.isfinite(values))[0])
                raise ValueError(f"{name}[{bad}]: found {values[bad]}; allowed: a finite number")
        self._common = wire.QueryGround(radar=radar, height_reference=REFERENCES[height_reference],
                                        geoid_undulation_m=float(geoid_undulation_m))
        if antenna is not None:
            Pose.of(antenna, "antenna").write(self._common.antenna)
        self._most = limits.max_query_points
        self._parts: list[npt.NDArray[Any]] = []
        self._materials: tuple[str, ...] = ()
        self._antenna: Pose | None = None

    def requests(self) -> Iterator[wire.QueryGround]:
        """One after the other; add() what answers each."""
        points = len(self._columns[next(iter(self._columns))])
        for first in range(0, points, self._most):
            request = wire.QueryGround()
            request.CopyFrom(self._common)
            for name, values in self._columns.items():
                getattr(request, name).extend(values[first: first + self._most].tolist())
            yield request

    def add(self, reply: wire.GroundAnswer, plane: memoryview) -> None:
        """Takes the answer to one of requests()."""
        if reply.record_bytes < RECORD.itemsize or reply.points * reply.record_bytes != len(plane):
            raise BadStream(f"GroundAnswer: found {len(plane)} bytes for {reply.points} records of {reply.record_bytes}")
        fields = RECORD.fields
        assert fields is not None
        offsets = [fields[name][1] for name, _ in MEMBERS]
        kind = np.dtype({"names": [name for name, _ in MEMBERS], "formats": [kind for _, kind in MEMBERS],
                         "offsets": offsets, "itemsize": reply.record_bytes})
        self._parts.append(np.frombuffer(plane, kind).astype(RECORD))
        self._materials = tuple(reply.materials)
        self._antenna = Pose.read(reply.antenna) if reply.HasField("antenna") else None

    def points(self) -> GroundPoints:
        """All answers together."""
        records = np.concatenate(self._parts) if self._parts else np.zeros(0, RECORD)
        expected = len(self._columns[next(iter(self._columns))])
        if len(records) != expected:
            raise BadStream(f"GroundAnswer: found {len(records)} points; {expected} were asked for")
        return GroundPoints(records, self.shape, self._materials, self._antenna, "range_m" in self._columns)

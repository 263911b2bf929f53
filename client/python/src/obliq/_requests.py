"""What both clients ask of a server: names and values into messages, messages into plain objects."""
from __future__ import annotations

import dataclasses
import ipaddress
import os
import ssl
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar, Union

from . import _seeds
from . import obliq_pb2 as wire
from ._fields import hint, number
from ._protocol.asked import Subscription
from .errors import Fault, UnknownRadar
from .parameters import Pose, PoseFields, Settings, SettingsFields
from .planes import Planes, Window, write_choice
from .targets import NO_TARGETS, TargetLike, World

DEFAULT_PORT = 7420
CLAIMS: dict[str, wire.ClaimKind] = {"pose": wire.POSE_CLAIM, "settings": wire.SETTINGS_CLAIM}

PoseLike = Union[Pose, PoseFields, Mapping[str, Any], None]
SettingsLike = Union[Settings, SettingsFields, Mapping[str, Any], None]
# A pose, or with settings, or with these and targets.
PoseRequest = Union[PoseLike, tuple[PoseLike, SettingsLike], tuple[PoseLike, SettingsLike, Iterable[TargetLike]]]
# planes, encoding, compress, window, radar, as_live
Choice = tuple[Planes, str, Union[str, None], Union[Window, None], str, bool]
FrameRequest = tuple[SettingsLike, PoseLike, Planes, str, Union[str, None], Union[Window, None], str, bool,
                     Union[dict[str, int], None], World]


@dataclasses.dataclass(frozen=True)
class Tls:
    """TLS 1.2 or later. ca_file: PEM of the authorities to trust instead of this machine's."""

    ca_file: str | os.PathLike[str] | None = None

    def context(self) -> ssl.SSLContext:
        """For Python's ssl."""
        context = ssl.create_default_context(cafile=None if self.ca_file is None else os.fspath(self.ca_file))
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        return context


@dataclasses.dataclass(frozen=True)
class ServerInfo:
    """What a server said of itself. role: of this client: viewer, controller or admin. limits: the message. truth:
    this client may be told where targets are."""

    name: str
    version: str
    scene: str
    radars: tuple[str, ...]
    encodings: tuple[str, ...]
    role: str
    limits: wire.Limits
    truth: bool

    def __repr__(self) -> str:
        return (f"ServerInfo(name={self.name!r}, version={self.version!r}, scene={self.scene!r}, radars={self.radars!r}, "
                f"role={self.role!r}, ...)")

    @staticmethod
    def of(welcome: wire.Welcome) -> ServerInfo:
        """From its Welcome."""
        return ServerInfo(welcome.server_name, welcome.server_version, welcome.scene_name, tuple(welcome.radars),
                          tuple(welcome.encodings), welcome.role, welcome.limits, welcome.truth)


@dataclasses.dataclass(frozen=True)
class RadarInfo:
    """A radar as it is now. controller: which client holds its pose; empty: none; settings_controller: its settings.
    controlled_by_me, claimed_by_me: whether that is this client, and what it holds: "pose", "settings". fault: why no frame
    can be rendered at present; empty: none. pose_stale: its pose's validity has run out. gimbal: the limit that the
    antenna stands at, in words; empty: it looks as asked."""

    radar: str
    settings: Settings
    pose: Pose
    settings_version: int
    controller: str
    controlled_by_me: bool
    watchers: int
    rate_hz: float
    fault: str
    pose_stale: bool
    transmit: bool
    frozen: bool
    rate_limit_hz: float
    settings_controller: str
    claimed_by_me: tuple[str, ...]
    exercise_frozen: bool
    gimbal: str

    @staticmethod
    def of(m: wire.RadarInfo) -> RadarInfo:
        """From the message."""
        return RadarInfo(m.radar, Settings.read(m.settings), Pose.read(m.pose), m.settings_version, m.controller,
                         m.controlled_by_you, m.subscribers, m.rate_hz, m.fault, m.pose_stale, not m.transmit_off,
                         m.frozen, m.rate_limit_hz, m.settings_controller,
                         tuple(name for name, kind in CLAIMS.items() if kind in m.claimed_by_you), m.exercise_frozen,
                         m.gimbal)


@dataclasses.dataclass(frozen=True)
class Accepted:
    """A change that the server took. coverage: of a pose: part of the disc within r_max_m for which the files have ground."""

    settings_version: int
    warnings: tuple[str, ...]
    coverage: float | None

    @staticmethod
    def of(ack: wire.Ack) -> Accepted:
        """From the message."""
        return Accepted(ack.settings_version, tuple(ack.warnings),
                        ack.coverage if ack.HasField("coverage") else None)


@dataclasses.dataclass(frozen=True)
class ConnectOptions:
    """Where to connect and as whom, checked before anything is sent."""

    host: str
    port: int
    tls: Tls | None
    name: str
    token: str
    timeout_s: float

    @staticmethod
    def of(address: str | int, token: str | None, token_file: str | os.PathLike[str] | None, tls: Tls | bool | None, name: str,
           timeout: float) -> ConnectOptions:
        """From what connect() is given."""
        host, port = parse_address(address)
        if tls is True:
            tls = Tls()
        if tls is False:
            tls = None
        if not isinstance(tls, (Tls, type(None))):
            raise TypeError(f"tls: found {tls!r}; allowed: obliq.Tls(ca_file=...), True, or None for a connection without")
        for what, text in (("name", name), ("token", token)):
            if not isinstance(text, str) and (what == "name" or text is not None):
                raise TypeError(f"{what}: found {type(text).__name__}; allowed: a text")
        if not number("timeout", timeout) > 0:
            raise ValueError(f"timeout: found {timeout!r}; allowed: seconds above 0")
        return ConnectOptions(host, port, tls, name, read_token(token, token_file), timeout)


def parse_address(address: str | int) -> tuple[str, int]:
    """HOST:PORT, HOST, :PORT, PORT or [IPv6]:PORT as (host, port)."""
    if not isinstance(address, (str, int)) or isinstance(address, bool):
        raise TypeError(f"address: found {address!r}; allowed: a text such as 127.0.0.1:7420")
    text = str(address).strip()
    if text.startswith("["):
        host, closed, rest = text[1:].partition("]")
        port = rest[1:] if rest.startswith(":") else ("" if not rest and closed else "?")
    elif text.count(":") > 1:
        host, port = text, ""
    elif text.isdigit():
        host, port = "", text
    else:
        host, _, port = text.partition(":")
    if ":" in host:
        try:
            ipaddress.IPv6Address(host)
        except ValueError:
            port = "?"
    if not (port == "" or (port.isdigit() and 0 < int(port) < 65536)) or "/" in host:
        raise ValueError(f"address: found {address!r}; allowed: HOST:PORT, HOST, :PORT, PORT, [IPv6]:PORT")
    return host or "127.0.0.1", int(port) if port else DEFAULT_PORT


def read_token(token: str | None, token_file: str | os.PathLike[str] | None) -> str:
    """The token, or the first line of its file."""
    if token_file is None:
        return token or ""
    if token:
        raise TypeError("connect() got both token and token_file")
    with open(token_file, encoding="utf-8") as lines:
        return lines.readline().strip()


def radar_name(radars: Sequence[str], name: str | None, what: str = "radar") -> str:
    """The only one, or the one of that name."""
    if name is None:
        if len(radars) == 1:
            return radars[0]
        raise ValueError(f"{what}: the server has {len(radars)}" + (f"; name one of {', '.join(radars)}" if radars else ""))
    if name not in radars:
        raise UnknownRadar(101, f"unknown {what}" + hint(name, radars),
                           [Fault(what, str(name), ", ".join(radars) or f"none, the scene has no {what}s")])
    return name


def frame_requests(poses: Iterable[PoseRequest], settings: SettingsLike, seed: int | None, choice: Choice,
           world: World = NO_TARGETS) -> Iterator[FrameRequest]:
    """Arguments of render_request() for each pose, or pose with settings and targets of its own."""
    if seed is not None:
        seed = _seeds.checked(seed)
    for place, pose in enumerate(poses):
        its_pose, its, *own = pose if isinstance(pose, tuple) else (pose, settings)
        its_world = World.of(own[0], world.live, world.truth) if own else world
        yield its, its_pose, *choice, None if seed is None else _seeds.draw(seed, place), its_world


def render_request(settings: SettingsLike, pose: PoseLike, planes: Planes, encoding: str, compress: str | None,
                   window: Window | None, radar: str, as_live: bool = False,
                   draw: dict[str, int] | None = None, world: World = NO_TARGETS) -> tuple[wire.RenderOnce, tuple[str, ...]]:
    """RenderOnce and the planes that it asks for. as_live: what settings and pose do not name is the live radar's. draw:
    settings that win. world: targets."""
    antenna = Pose.of(pose, "pose")
    request = wire.RenderOnce(radar=radar, as_live=bool(as_live))
    world.write(request)
    Settings.of(settings, "settings", **(draw or {})).write(request.settings)
    antenna.write(request.pose)
    lacking = [name for name in ("latitude_deg", "longitude_deg", "height_m") if getattr(antenna, name) is None]
    if lacking and not as_live:
        raise TypeError(f"pose: lacks {', '.join(lacking)}: a frame needs an antenna")
    return request, write_choice(request, planes, encoding, compress, window)


def subscription(radar: str, rate_hz: float, planes: Planes, encoding: str, compress: str | None, window: Window | None,
                 lossless: bool, by_wedge: bool, copy: bool, truth: bool = False) -> Subscription:
    """What stream() and wedges() ask for."""
    request = wire.Subscribe(radar=radar, rate_hz=float(number("rate_hz", rate_hz)), lossless=bool(lossless), truth=bool(truth))
    names = write_choice(request, planes, encoding, compress, window)
    return Subscription(request, names, by_wedge, copy)


E = TypeVar("E", wire.ResetExercise, wire.GetExercise, wire.LoadExercise, wire.SetExercise,
            wire.GetEvents, wire.AddBookmark, wire.SetTargets, wire.GetTargets, wire.ClaimControl)


def of_1_2(welcome: wire.Welcome, request: E) -> E:
    """A request that an older server would skip, and never answer."""
    if welcome.minor < 2:
        raise ValueError(f"the server speaks version 1.{welcome.minor} of the protocol; allowed: 1.2 or later")
    return request


# As the server has them (proto/limits.h, proto/bookmark.h).
MOST_BOOKMARK_BYTES = 1000


def bookmark_request(text: str) -> wire.AddBookmark:
    """What bookmark() asks for."""
    size = len(text.encode())
    if not 1 <= size <= MOST_BOOKMARK_BYTES:
        raise ValueError(f"text: found {size} bytes; allowed: 1 to {MOST_BOOKMARK_BYTES} bytes of text without control characters")
    return wire.AddBookmark(text=text)


def claim_kinds(claims: str | None) -> list[wire.ClaimKind]:
    """Of names with spaces between; None: those that a request without any means."""
    names = [] if claims is None else claims.split()
    for name in names:
        if name not in CLAIMS:
            raise ValueError(f"claims: found {name!r}; allowed: {', '.join(CLAIMS)}")
    if claims is not None and not names:
        raise ValueError(f"claims: found nothing; allowed: {', '.join(CLAIMS)}")
    return [CLAIMS[name] for name in names]


def state_request(radar: str, transmit: bool | None, freeze: bool | None) -> wire.SetState:
    """What set_state() asks for."""
    request = wire.SetState(radar=radar)
    if transmit is not None:
        request.transmit = bool(transmit)
    if freeze is not None:
        request.freeze = bool(freeze)
    return request


def pose_request(radar: str, pose: PoseLike, fields: Mapping[str, Any], new_time_line: bool = False) -> wire.SetPose:
    """What set_pose() asks for."""
    request = wire.SetPose(radar=radar)
    Pose.of(pose, "set_pose", **fields).write(request.pose)
    if new_time_line:
        request.pose.new_time_line = True
    return request


def settings_request(radar: str, settings: SettingsLike, fields: Mapping[str, Any]) -> wire.SetSettings:
    """What set() asks for."""
    request = wire.SetSettings(radar=radar)
    Settings.of(settings, "set", **fields).write(request.settings)
    return request


def stream_timeout(timeout_s: float | None, rate_hz: float) -> float | None:
    """At low rates a frame may take longer than any fixed time."""
    return None if timeout_s is None else max(number("timeout", timeout_s), 3 / max(rate_hz, 1e-9))

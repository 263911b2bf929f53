"""What both clients ask of a server: names and values into messages, messages into plain objects."""
from __future__ import annotations

import dataclasses
import ipaddress
import os
import ssl

from . import _seeds
from . import obliq_pb2 as wire
from ._fields import hint, number
from ._session import Subscription
from .errors import Fault, UnknownRadar
from .parameters import Pose, Settings
from .planes import write_choice

DEFAULT_PORT = 7420


@dataclasses.dataclass(frozen=True)
class Tls:
    """TLS 1.2 or later. ca_file: PEM of the authorities to trust instead of this machine's."""

    ca_file: str | os.PathLike | None = None

    def context(self):
        context = ssl.create_default_context(cafile=None if self.ca_file is None else os.fspath(self.ca_file))
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        return context


@dataclasses.dataclass(frozen=True)
class ServerInfo:
    name: str
    version: str
    scene: str
    radars: tuple[str, ...]
    encodings: tuple[str, ...]
    role: str  # viewer, controller or admin
    limits: wire.Limits

    @staticmethod
    def of(welcome):
        return ServerInfo(welcome.server_name, welcome.server_version, welcome.scene_name, tuple(welcome.radars),
                          tuple(welcome.encodings), welcome.role, welcome.limits)


@dataclasses.dataclass(frozen=True)
class RadarInfo:
    radar: str
    settings: Settings
    pose: Pose
    settings_version: int
    controller: str  # empty: none
    controlled_by_me: bool
    watchers: int
    rate_hz: float
    fault: str  # why no frame can be rendered at present; empty: none
    pose_stale: bool
    transmit: bool
    frozen: bool
    rate_limit_hz: float

    @staticmethod
    def of(m):
        return RadarInfo(m.radar, Settings.read(m.settings), Pose.read(m.pose), m.settings_version, m.controller,
                         m.controlled_by_you, m.subscribers, m.rate_hz, m.fault, m.pose_stale, not m.transmit_off,
                         m.frozen, m.rate_limit_hz)


@dataclasses.dataclass(frozen=True)
class Accepted:
    """A change that the server took."""

    settings_version: int
    warnings: tuple[str, ...]
    coverage: float | None  # of a pose: part of the disc within r_max_m for which the files have ground

    @staticmethod
    def of(ack):
        return Accepted(ack.settings_version, tuple(ack.warnings),
                        ack.coverage if ack.HasField("coverage") else None)


@dataclasses.dataclass(frozen=True)
class Door:
    """Where to connect and as whom, checked before anything is sent."""

    host: str
    port: int
    tls: Tls | None
    name: str
    token: str
    timeout_s: float

    @staticmethod
    def of(address, token, token_file, tls, name, timeout):
        host, port = parse_address(address)
        if tls is True:
            tls = Tls()
        if not isinstance(tls, (Tls, type(None))) and tls is not False:
            raise TypeError(f"tls: found {tls!r}; allowed: obliq.Tls(ca_file=...), True, or None for a connection without")
        for what, text in (("name", name), ("token", token)):
            if not isinstance(text, str) and (what == "name" or text is not None):
                raise TypeError(f"{what}: found {type(text).__name__}; allowed: a text")
        if not number("timeout", timeout) > 0:
            raise ValueError(f"timeout: found {timeout!r}; allowed: seconds above 0")
        return Door(host, port, tls or None, name, read_token(token, token_file), timeout)


def parse_address(address):
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


def read_token(token, token_file):
    if token_file is None:
        return token or ""
    if token:
        raise TypeError("connect() got both token and token_file")
    with open(token_file, encoding="utf-8") as lines:
        return lines.readline().strip()


def radar_name(radars, name):
    """The only one, or the one of that name."""
    if name is None:
        if len(radars) == 1:
            return radars[0]
        raise ValueError(f"radar: the server has {len(radars)}; name one of {', '.join(radars)}")
    if name not in radars:
        raise UnknownRadar(101, "unknown radar" + hint(name, radars),
                           [Fault("radar", str(name), ", ".join(radars))])
    return name


def wishes(poses, settings, seed, choice):
    """Arguments of render_request() for each pose, or pair of pose and settings."""
    if seed is not None:
        seed = _seeds.checked(seed)
    for place, pose in enumerate(poses):
        pose, its = pose if isinstance(pose, tuple) else (pose, settings)
        yield its, pose, *choice, None if seed is None else _seeds.draw(seed, place)


def render_request(settings, pose, planes, encoding, compress, window, radar, draw=None):
    """RenderOnce and the planes that it asks for. draw: settings that win."""
    pose = Pose.of(pose, "pose")
    request = wire.RenderOnce(radar=radar)
    Settings.of(settings, "settings", **(draw or {})).write(request.settings)
    pose.write(request.pose)
    lacking = [name for name in ("latitude_deg", "longitude_deg", "height_m") if getattr(pose, name) is None]
    if lacking:
        raise TypeError(f"pose: lacks {', '.join(lacking)}: a frame needs an antenna")
    return request, write_choice(request, planes, encoding, compress, window)


def subscription(radar, rate_hz, planes, encoding, compress, window, lossless, by_wedge, copy):
    request = wire.Subscribe(radar=radar, rate_hz=float(number("rate_hz", rate_hz)), lossless=bool(lossless))
    names = write_choice(request, planes, encoding, compress, window)
    return Subscription(request, names, by_wedge, copy)


def state_request(radar, transmit, freeze):
    request = wire.SetState(radar=radar)
    if transmit is not None:
        request.transmit = bool(transmit)
    if freeze is not None:
        request.freeze = bool(freeze)
    return request


def pose_request(radar, pose, fields):
    request = wire.SetPose(radar=radar)
    Pose.of(pose, "set_pose", **fields).write(request.pose)
    return request


def settings_request(radar, settings, fields):
    request = wire.SetSettings(radar=radar)
    Settings.of(settings, "set", **fields).write(request.settings)
    return request


def stream_timeout(timeout_s, rate_hz):
    """At low rates a frame may take longer than any fixed time."""
    return None if timeout_s is None else max(number("timeout", timeout_s), 3 / max(rate_hz, 1e-9))

"""Client of obliqd, the radar ground-map simulator.

    import obliq
    with obliq.connect("127.0.0.1:7420") as server:
        frame = server.radar("main").frame()
        frame.iq, frame.azimuth_deg, frame.range_m

obliq.connect, obliq.local: blocking; obliq.aio.connect: for asyncio. obliq.open: a recording. obliq.load: a saved
frame. obliq.batch, obliq.Dataset: data sets.
"""
from . import aio, errors, ground
from . import obliq_pb2 as wire
from ._protocol.assembly import Wedge
from ._sets.batch import Job, batch, prepare, todo
from ._sets.progress import Done
from ._requests import Accepted, RadarInfo, ServerInfo, Tls
from ._version import __version__
from ._sets.dataset import Dataset
from .client import Control, Radar, Replay, Server, Stream, Targets, connect
from .errors import (
    BadStream,
    CannotConnect,
    ConnectionLost,
    Fault,
    FrameAborted,
    InvalidValue,
    NotInControl,
    ObliqError,
    OverLimit,
    Refused,
    RenderFailed,
    ReplayOnly,
    ServerFull,
    ServerStopping,
    TimedOut,
    Unauthorized,
    UnknownRadar,
    Untrusted,
)
from .files import load
from .frame import Dwell, Frame
from .ground import GroundPoints
from .local import Daemon as local_daemon
from .local import local
from .parameters import Pose, Settings
from .planes import STATES, Window
from .recording import Loss, Recording
from .recording import open_recording as open
from .replay import ReplayState
from .targets import Route, Target
from .trains import RangeDoppler, Train

__all__ = [
    "STATES", "Accepted", "BadStream", "CannotConnect", "ConnectionLost", "Control", "Dataset", "Done", "Dwell",
    "Fault", "Frame", "FrameAborted", "GroundPoints", "InvalidValue", "Job", "Loss", "NotInControl", "ObliqError",
    "OverLimit", "Pose", "Radar", "RadarInfo", "RangeDoppler", "Recording", "Refused", "RenderFailed", "Replay", "ReplayOnly",
    "ReplayState", "Route", "Server", "ServerFull", "ServerInfo", "ServerStopping", "Settings", "Stream", "Target",
    "Targets", "TimedOut", "Tls", "Train", "Unauthorized", "UnknownRadar", "Untrusted", "Wedge", "Window", "__version__", "aio",
    "batch", "connect", "errors", "ground", "load", "local", "local_daemon", "open", "prepare", "todo", "wire",
]

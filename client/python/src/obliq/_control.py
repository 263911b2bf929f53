"""The blocking classes. Written by generate.py from those for asyncio: do not edit."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from . import _requests as requests
from . import obliq_pb2 as wire
from .errors import ObliqError
from .parameters import PoseFields, SettingsFields
from .targets import Target, TargetFields, TargetLike, message_of, messages_of, requests_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._classes import Server


class Control:
    """A radar that this client controls."""

    def __init__(self, server: Server, name: str):
        self._server, self.name = server, name
        self._refused: ObliqError | None = None

    def set_pose(self, pose: requests.PoseLike = None, *, new_time_line: bool = False,
                 **fields: Unpack[PoseFields]) -> requests.Accepted:
        """Moves and turns the antenna; what is not given stays. sim_time_ns: by your own clock, for smooth motion.
        new_time_line: that clock was set, poses before this one are forgotten."""
        request = requests.pose_request(self.name, pose, fields, new_time_line)
        return requests.Accepted.of(self._server._run(self._server._session.act(request)))

    def send_pose(self, pose: requests.PoseLike = None, *, new_time_line: bool = False,
                  on_refused: Callable[[ObliqError], object] | None = None, **fields: Unpack[PoseFields]) -> None:
        """As set_pose, without waiting for the answer: for a host that moves the antenna in a loop of its own. A refusal goes
        to on_refused, in whichever later call it arrives; without one the next send_pose raises it."""
        if self._refused is not None:
            refused, self._refused = self._refused, None
            raise refused
        self._server._connection.tell(requests.pose_request(self.name, pose, fields, new_time_line),
                                      on_refused or self._keep)

    def _keep(self, refusal: ObliqError) -> None:
        self._refused = refusal

    def set(self, settings: requests.SettingsLike = None, **fields: Unpack[SettingsFields]) -> requests.Accepted:
        """Changes settings, all or none; the next frame has them."""
        request = requests.settings_request(self.name, settings, fields)
        return requests.Accepted.of(self._server._run(self._server._session.act(request)))

    def set_state(self, transmit: bool | None = None, freeze: bool | None = None) -> None:
        """transmit=False: no frames. freeze=True: frames keep the pose and settings of this moment."""
        self._server._run(self._server._session.act(requests.state_request(self.name, transmit, freeze)))


class Targets:
    """The world's targets, that this client holds."""

    def __init__(self, server: Server):
        self._server = server

    def set(self, *targets: TargetLike, **fields: Unpack[TargetFields]) -> tuple[str, ...]:
        """Sets targets, all or none: objects, dicts, or one by keywords. Of known ids only what is named changes. Returns
        warnings."""
        messages = messages_of(targets, "set")
        if fields:
            messages.append(message_of(fields, "set"))
        return self._change(messages)

    def replace(self, targets: Iterable[TargetLike]) -> tuple[str, ...]:
        """These and no others, at once."""
        return self._change(messages_of(targets, "replace"), clear=True)

    def remove(self, *ids: int) -> tuple[str, ...]:
        """Takes targets away."""
        return self._change([], ids)

    def clear(self) -> tuple[str, ...]:
        """Takes all away."""
        return self._change([], clear=True)

    def list(self) -> list[Target]:
        """All there are."""
        return self._server.target_list()

    def _change(self, messages: Sequence[wire.Target], gone: Iterable[int] = (), clear: bool = False) -> tuple[str, ...]:
        warnings: tuple[str, ...] = ()
        for request in requests_of(messages, gone, clear):
            warnings += tuple((self._server._run(self._server._session.act(request))).warnings)
        return warnings

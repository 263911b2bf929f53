"""Daemons of this process's own, which end with it: one for each scene, for all its shards."""
from __future__ import annotations

import contextlib
import json
import os
import threading
from collections.abc import Iterator, Mapping
from typing import Any

from ..local import Daemon

_daemons: dict[tuple[Any, ...], Daemon] = {}
_users: dict[tuple[Any, ...], int] = {}
_one_at_a_time = threading.Lock()


@contextlib.contextmanager
def own_daemon(scene: str, obliqd: str | None, settings: Mapping[str, Any]) -> Iterator[str]:
    """The address of a daemon with that scene, started once. Those of other scenes that nothing uses any more are stopped
    first: each takes the memory of a world."""
    key = (os.getpid(), scene, obliqd, json.dumps(settings, sort_keys=True))
    with _one_at_a_time:
        for other in [other for other in _daemons if other[0] == os.getpid() and other != key and not _users.get(other)]:
            _daemons.pop(other).stop()
        if key in _daemons and not _daemons[key].is_running():
            _daemons.pop(key).stop()
        if key not in _daemons:
            _daemons[key] = Daemon(scene, obliqd, settings)
        _users[key] = _users.get(key, 0) + 1
        address = _daemons[key].address
    try:
        yield address
    finally:
        with _one_at_a_time:
            _users[key] -= 1


def stop_own_daemons() -> None:
    """All of this process."""
    for key in [key for key in _daemons if key[0] == os.getpid()]:
        _daemons.pop(key).stop()

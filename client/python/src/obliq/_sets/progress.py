"""How far a run is, and what it has done."""
from __future__ import annotations

import dataclasses
import sys
import time
from collections.abc import Callable
from typing import Any, Union

Watch = Union[bool, Callable[[int, int], object], None]


@dataclasses.dataclass(frozen=True)
class Done:
    """What a run has done. frames: rendered by this run. failed: poses without a frame. parts: that are there now, of
    parts_wanted. first_failed: its line of failed.jsonl."""

    frames: int
    failed: int
    parts: int
    parts_wanted: int
    seconds: float
    first_failed: dict[str, Any] | None = None

    @property
    def complete(self) -> bool:
        """Every part is there."""
        return self.parts == self.parts_wanted


class Progress:
    """How far: told to a callable, or a line on standard error now and then, with how fast and until when."""

    def __init__(self, total: int, wanted: Watch):
        self._total, self._began, self._last = total, time.monotonic(), 0.0
        self._watch = wanted if callable(wanted) else None
        self._wanted = sys.stderr.isatty() if wanted is None else bool(wanted)

    def __call__(self, done: int) -> None:
        if self._watch is not None:
            self._watch(done, self._total)
            return
        now = time.monotonic()
        if not self._wanted or (now - self._last < 2 and done < self._total):
            return
        self._last = now
        rate = done / max(now - self._began, 1e-9)
        left = max(0, self._total - done) / max(rate, 1e-9)
        end = time.strftime("%H:%M:%S", time.localtime(time.time() + left))
        print(f"obliq.batch: {done} of {self._total} frames, {rate:.1f} a second, until {end}", file=sys.stderr)

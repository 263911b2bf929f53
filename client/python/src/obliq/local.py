"""A daemon of one's own: started, used, stopped."""
from __future__ import annotations

import contextlib
import importlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from typing import Any

from .client import Server, connect
from .errors import CannotConnect, TimedOut

READY = re.compile(r"ready: .* on (\S+)")


def packaged() -> Any:
    """The module of the package obliq-server, which contains the programs, where it is installed."""
    try:
        return importlib.import_module("obliq_server")
    except ImportError:
        return None


def find_program(name: str, program: str | os.PathLike[str] | None = None) -> tuple[str, dict[str, str] | None]:
    """obliqd or obliq: as given, or of $OBLIQD or $OBLIQ, or of the package obliq-server, or in PATH; with the environment
    that it needs. FileNotFoundError where there is none."""
    variable = name.upper()
    found = program or os.environ.get(variable)
    server = packaged()
    if not found and server:
        return os.fspath(server.program(name)), server.environment()
    found = found or shutil.which(name)
    if not found or not shutil.which(os.fspath(found)):
        raise FileNotFoundError(f"{name}: found {found!r}; allowed: the package obliq-server, a program in PATH, in the variable "
                                f"{variable}, or given as {name}=PATH")
    return os.fspath(found), None


def toml(value: object) -> object:
    """A value as --set takes it."""
    if isinstance(value, (bool, list, tuple)):
        return json.dumps(value)
    return value


class Daemon:
    """obliqd with a scene, on any free port of this machine. It ends with this object or with this process, even where
    that is killed: a keeper between them watches a pipe."""

    def __init__(self, scene: str | os.PathLike[str], obliqd: str | os.PathLike[str] | None = None,
                 settings: Mapping[str, Any] | None = None, timeout: float = 600.0):
        file = pathlib.Path(scene)
        if not file.is_file():
            raise FileNotFoundError(f"{file}: no such scene file")
        program, environment = find_program("obliqd", obliqd)
        words = [program, "--config", os.fspath(file), "--set", "server.port=0", "--set", "http.enabled=false",
                 "--set", "server.address=127.0.0.1", "--set", "server.tokens=", "--set", "server.tls_certificate=", "--set",
                 "server.tls_key="]
        for key, value in (settings or {}).items():
            words += ["--set", f"{key}={toml(value)}"]
        # Without a name, so that nothing of it stays, however this process ends; log() reads it by its descriptor.
        self._log = tempfile.TemporaryFile(prefix="obliqd-", buffering=0)
        keeper = pathlib.Path(__file__).with_name("_keeper.py")
        # A group of its own: Ctrl-C in a notebook is not for the daemon.
        self._keeper = subprocess.Popen([sys.executable, "-I", os.fspath(keeper), *words], stdin=subprocess.PIPE,
                                        stdout=self._log, stderr=self._log, start_new_session=True, env=environment)
        try:
            self.address = self._await_ready(timeout)
        except BaseException:
            self.stop()
            raise

    def log(self) -> str:
        """What it has printed so far."""
        # Where the daemon writes goes on from where this file's position is: it stays.
        return os.pread(self._log.fileno(), os.fstat(self._log.fileno()).st_size, 0).decode(errors="replace")

    def _last_words(self) -> str:
        return "; ".join(self.log().strip().splitlines()[-5:]) or "nothing"

    def is_running(self) -> bool:
        """It has not ended."""
        return self._keeper.poll() is None

    def _await_ready(self, timeout: float) -> str:
        end = time.monotonic() + timeout
        while True:
            ended = self._keeper.poll() is not None
            found = READY.search(self.log())
            if found:
                return found.group(1)
            if ended:
                raise CannotConnect(f"obliqd ended at its start; it printed: {self._last_words()}")
            if time.monotonic() > end:
                raise TimedOut(f"obliqd was not ready within {timeout:g} s; it printed: {self._last_words()}")
            time.sleep(0.02)

    def stop(self, timeout: float = 15.0) -> None:
        """Ends it, by force after so many seconds."""
        assert self._keeper.stdin is not None
        if self._keeper.poll() is None:
            self._keeper.stdin.close()
            try:
                self._keeper.wait(timeout)
            except subprocess.TimeoutExpired:
                os.killpg(self._keeper.pid, signal.SIGKILL)
                self._keeper.wait()
        with contextlib.suppress(OSError):
            self._keeper.stdin.close()
        self._log.close()


@contextlib.contextmanager
def local(scene: str | os.PathLike[str], *, obliqd: str | os.PathLike[str] | None = None,
          settings: Mapping[str, Any] | None = None, timeout: float = 600.0, name: str = "python") -> Iterator[Server]:
    """Starts obliqd with a scene file, yields it connected, stops it at the end. settings: what --set would take, such as
    {"terrain.cell_m": 30}. obliqd: the program; else $OBLIQD, else that of the package
    obliq-server, else the one in PATH."""
    daemon = Daemon(scene, obliqd, settings, timeout)
    try:
        with connect(daemon.address, name=name, timeout=30.0) as server:
            yield server
    finally:
        daemon.stop()

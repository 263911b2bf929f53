"""Small files that are whole or absent, JSON, and sums that `sha256sum -c` reads."""
from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pathlib
import uuid
from typing import Any

SUMS = "SHA256SUMS"


def sync(path: pathlib.Path) -> None:
    """So that what is renamed is on the disk before its name is."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_whole(path: pathlib.Path, text: str) -> None:
    """A small file that is old or new, never half."""
    part = path.with_name(f".{path.name}.{os.getpid()}.{uuid.uuid4().hex[:8]}")
    try:
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            part.unlink()


def parsed(text: str) -> Any:
    """A JSON text; ValueError also where it is nested too deep."""
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deep") from None


def json_lines(path: pathlib.Path) -> list[dict[str, Any]]:
    """The objects of a file of JSON lines. ValueError names the line, FileNotFoundError the file."""
    found = []
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            try:
                found.append(parsed(line))
            except ValueError as error:
                raise ValueError(f"{path}, line {number}: not JSON: {error}") from None
    return found


def as_lines(values: list[Any]) -> str:
    """A JSON value a line."""
    return "".join(json.dumps(value) + "\n" for value in values)


def digest(value: object) -> str:
    """Of anything that JSON holds."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def file_sum(path: pathlib.Path) -> str:
    """SHA-256 of a file."""
    found = hashlib.sha256()
    with open(path, "rb") as file:
        while piece := file.read(1 << 20):
            found.update(piece)
    return found.hexdigest()


def sum_lines(sums: dict[str, str]) -> str:
    """The text of a SHA256SUMS, by name."""
    return "".join(f"{sums[name]}  {name}\n" for name in sorted(sums))


def read_sums(path: pathlib.Path) -> dict[str, str]:
    """The sums of a SHA256SUMS by name; none where there is no such file."""
    with contextlib.suppress(FileNotFoundError):
        return {name: value for value, _, name in (line.partition("  ") for line in path.read_text().splitlines())}
    return {}

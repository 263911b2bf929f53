"""What the declarations of tables share."""
import json
from dataclasses import dataclass
from typing import Callable

PAPER = "tests/bench/paper_hills.toml"
CITY = "tests/bench/city.toml"


@dataclass
class Part:
    """What is measured together and shown as one table."""
    name: str
    title: str
    commands: Callable   # (folder of programs, folder for results) -> list of commands, programs first
    collect: Callable    # (their outputs, folder) -> figures
    words: Callable      # (figures) -> Markdown
    quick: bool = False  # one of those that take twelve minutes together


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def ms(seconds):
    return f"{1000 * seconds:.0f} ms" if seconds >= 0.01 else f"{1000 * seconds:.1f} ms"


def share(value):
    return f"{100 * value:.1f} %"


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)


def measured_at(kept):
    """Of a part as it is kept: a cell for tables whose rows are of several parts."""
    return f"{kept['where']['date']}, {kept['where']['commit']}"

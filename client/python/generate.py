#!/usr/bin/python3
"""Writes what the package takes from elsewhere: messages from proto/obliq.proto, parameters from `obliq parameters`, and the
blocking classes from those for asyncio.

  generate.py --obliq PROGRAM [--protoc protoc] [--out DIR | --check]

--check writes nothing and fails where the files of the package are not what would be written.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "src" / "obliq"
PROTO = HERE.parent.parent / "proto"
FILES = ["obliq_pb2.py", "obliq_pb2.pyi", "parameters.py", "_keywords.py", "_classes.py", "_control.py", "_streams.py"]
# What the asyncio classes say, and what the blocking ones say instead.
BLOCKING = [(r"async (def|with|for) ", r"\1 "), (r"\bawait ", ""), (r"\basynccontextmanager\b", "contextmanager"),
            (r"__(aenter|aexit|aiter|anext)__", lambda found: f"__{found[1][1:]}__"), (r"\bStopAsyncIteration\b", "StopIteration"),
            (r"\bAsyncIterator\b", "Iterator"), (r"Callable\[\[\], Awaitable\[Connection\]\]", "Callable[[], Connection]"),
            (r"\((self\.info\(\))\)", r"\1"), (r"\basyncio\.Lock\b", "threading.Lock"), (r"\basyncio\.sleep\b", "time.sleep"), (r"_aio_(connection|control|streams|classes)", r"_\1")]
PYTHON_TYPES = {"number": "float", "integer": "int", "boolean": "bool", "choice": "str", "text": "str",
                "list of numbers": "Sequence[float]"}


def choices(row, kind):
    """Name in scene files -> number on the wire: "ground" is GROUND_SPECKLE there."""
    return {name: kind.values_by_name[wire_name].number for name, wire_name in row["enumerators"].items()}


def blocking_text(source):
    """The blocking classes, from those for asyncio."""
    body = source[source.index("from __future__"):]
    body = re.sub(r"^.*# aio\n", "", body, flags=re.M)
    body = re.sub(r"# blocking: ?", "", body)
    body = body.replace("import asyncio\nimport collections\nimport contextlib\nimport time\n",
                        "import collections\nimport contextlib\nimport threading\nimport time\n")
    body = body.replace("AsyncIterator, Awaitable, Callable, Iterable\n", "Callable, Iterable, Iterator\n")
    for pattern, text in BLOCKING:
        body = re.sub(pattern, text, body)
    body = re.sub(r"^ +$", "", body, flags=re.M)
    return f'"""The blocking classes. Written by generate.py from those for asyncio: do not edit."""\n{aligned(body)}'


def aligned(text):
    """Continued lines under the bracket that they are in: what stood before it has become shorter."""
    lines, depth, told = [], [], False
    for line in text.split("\n"):
        if told or '"""' in line:
            told ^= line.count('"""') % 2 == 1
            lines.append(line)
            continue
        if depth and line.strip():
            line = " " * depth[-1] + line.lstrip()
        for column, character in enumerate(line.partition("  #")[0]):
            if character in "([{":
                depth.append(column + 1)
            elif character in ")]}" and depth:
                depth.pop()
        lines.append(line)
    return "\n".join(lines)


def python_type(row, choices):
    if row["type"] == "choice":
        return f"Literal[{', '.join(json.dumps(name) for name in choices)}]"
    return PYTHON_TYPES[row["type"]]


def wrapped(text, width=124, indent="        "):
    return textwrap.wrap(text, width, initial_indent="    ", subsequent_indent=indent, break_on_hyphens=False)


def parameters_texts(rows, messages):
    """Of parameters.py and of _keywords.py."""
    by_message = {"RadarSettings": [], "Pose": []}
    for row in rows:
        message, _, field = (row.get("message_field") or "").partition(".")
        if message in by_message:
            by_message[message].append((field, row))
    out = ['"""The parameters of a radar and the pose of its antenna. Written by generate.py: do not edit."""',
           "from __future__ import annotations", "", "import dataclasses", "from collections.abc import Sequence",
           "from typing import TYPE_CHECKING, Literal", "",
           "from ._fields import Fields", "from ._keywords import PoseFields, SettingsFields", "",
           "if TYPE_CHECKING:", "    from typing_extensions import Unpack", "",
           '__all__ = ["Pose", "PoseFields", "Settings", "SettingsFields"]']
    keywords = ['"""The keywords that Settings and Pose take, for type checkers. Written by generate.py: do not edit."""',
                "from __future__ import annotations", "", "from collections.abc import Sequence", "from typing import Literal, TypedDict"]
    for python_name, message, text in (
            ("Settings", "RadarSettings", "Settings of a radar. None: as it is, or the default where a frame is rendered."),
            ("Pose", "Pose", "Where the antenna is and where it looks. None: as it is.")):
        found = {field: choices(row, messages.DESCRIPTOR.message_types_by_name[message].fields_by_name[field].enum_type)
                 for field, row in by_message[message] if row["type"] == "choice"}
        types = {field: f"{python_type(row, found.get(field))} | None" for field, row in by_message[message]}
        keywords += ["", "", f"class {python_name}Fields(TypedDict, total=False):",
                     f'    """Keywords that {python_name} takes."""', ""]
        keywords += [f"    {field}: {kind}" for field, kind in types.items()]
        out += ["", "", "@dataclasses.dataclass(frozen=True, repr=False)", f"class {python_name}(Fields):", f'    """{text}', ""]
        for field, row in by_message[message]:
            out += wrapped(f"{field}: {row['text']} Allowed: {row['allowed']}.")
        out += ['    """', ""]
        out += [f"    {field}: {kind} = None" for field, kind in types.items()]
        out += ["", f"    def replace(self, **changes: Unpack[{python_name}Fields]) -> {python_name}:",
                '        """The same, but for these."""', "        return self._replaced(changes)"]
        out += ["", "", f"{python_name}.choices = {json.dumps(found, indent=4)}"]
        ideal = {field: row["default"] for field, row in by_message[message] if row.get("not_ideal")}
        if ideal:
            out.append(f"{python_name}.ideal = {json.dumps(ideal, indent=4)}".replace("false", "False").replace("true", "True"))
        keys = {row["key"]: field for field, row in by_message[message]}
        out += [f"{python_name}.keys = {json.dumps(keys, indent=4)}"]
    return "\n".join([*out, ""]), "\n".join([*keywords, ""])


def generate(folder, obliq, protoc):
    subprocess.run([protoc, f"--proto_path={PROTO}", f"--python_out={folder}", f"--pyi_out={folder}", "obliq.proto"],
                   check=True)
    stubs = folder / "obliq_pb2.pyi"
    stubs.write_text(stubs.read_text().replace("__slots__ = []", "__slots__ = ()"))  # as type checkers want it
    rows = json.loads(subprocess.run([obliq, "parameters", "--json"], check=True, capture_output=True).stdout)
    sys.path.insert(0, str(folder))
    import obliq_pb2

    for name, text in zip(("parameters", "_keywords"), parameters_texts(rows, obliq_pb2)):
        (folder / f"{name}.py").write_text(text)
    for name in ("classes", "control", "streams"):
        (folder / f"_{name}.py").write_text(blocking_text((PACKAGE / f"_aio_{name}.py").read_text()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--obliq", required=True)
    parser.add_argument("--protoc", default="protoc")
    parser.add_argument("--out", type=pathlib.Path, default=PACKAGE)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if not given.check:
        return generate(given.out, given.obliq, given.protoc)
    with tempfile.TemporaryDirectory() as folder:
        generate(pathlib.Path(folder), given.obliq, given.protoc)
        stale = [name for name in FILES
                 if (pathlib.Path(folder) / name).read_text() != (given.out / name).read_text()]
    if stale:
        sys.exit(f"client/python: {', '.join(stale)} not what generate.py writes; run: cmake --build --preset release --target generated")


if __name__ == "__main__":
    main()

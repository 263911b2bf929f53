#!/usr/bin/env python3
"""Writes what the package takes from elsewhere: messages from proto/obliq.proto, parameters from `obliq parameters`.

  generate.py --obliq PROGRAM [--protoc protoc] [--out DIR | --check]

--check writes nothing and fails where the files of the package are not what would be written.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "src" / "obliq"
PROTO = HERE.parent.parent / "proto"
FILES = ["obliq_pb2.py", "obliq_pb2.pyi", "parameters.py"]
PYTHON_TYPES = {"number": "float", "integer": "int", "boolean": "bool", "choice": "str", "text": "str"}


def choices(row, kind):
    """Name in scene files -> number on the wire: "ground" is GROUND_SPECKLE there."""
    return {name: kind.values_by_name[wire_name].number for name, wire_name in row["enumerators"].items()}


def parameters_text(rows, messages):
    by_message = {"RadarSettings": [], "Pose": []}
    for row in rows:
        message, _, field = (row.get("message_field") or "").partition(".")
        if message in by_message:
            by_message[message].append((field, row))
    out = ['"""The parameters of a radar and the pose of its antenna. Written by generate.py: do not edit."""',
           "from __future__ import annotations", "", "import dataclasses", "", "from ._fields import Fields", ""]
    for python_name, message, text in (
            ("Settings", "RadarSettings", "Settings of a radar. None: as it is, or the default where a frame is rendered."),
            ("Pose", "Pose", "Where the antenna is and where it looks. None: as it is.")):
        out += ["", "@dataclasses.dataclass(frozen=True, repr=False)", f"class {python_name}(Fields):", f'    """{text}"""', ""]
        found = {}
        for field, row in by_message[message]:
            out.append(f"    # {row['text']} Allowed: {row['allowed']}")
            out.append(f"    {field}: {PYTHON_TYPES[row['type']]} | None = None")
            if row["type"] == "choice":
                found[field] = choices(row, messages.DESCRIPTOR.message_types_by_name[message].fields_by_name[field].enum_type)
        out += ["", "", f"{python_name}.choices = {json.dumps(found, indent=4)}"]
        ideal = {field: row["default"] for field, row in by_message[message] if row.get("not_ideal")}
        if ideal:
            out.append(f"{python_name}.ideal = {ideal!r}")
        keys = {row["key"]: field for field, row in by_message[message]}
        out += [f"{python_name}.keys = {json.dumps(keys, indent=4)}", ""]
    return "\n".join(out)


def generate(folder, obliq, protoc):
    subprocess.run([protoc, f"--proto_path={PROTO}", f"--python_out={folder}", f"--pyi_out={folder}", "obliq.proto"],
                   check=True)
    rows = json.loads(subprocess.run([obliq, "parameters", "--json"], check=True, capture_output=True).stdout)
    sys.path.insert(0, str(folder))
    import obliq_pb2

    (folder / "parameters.py").write_text(parameters_text(rows, obliq_pb2))


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

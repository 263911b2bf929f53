#!/usr/bin/python3
"""Writes wire.d.ts, the types of proto/obliq.proto's messages as the page reads and writes them, from protoc's descriptors.

  make_types.py [--protoc PROGRAM] [--check]

--check writes nothing and fails where the file is not what would be written. Exit code 77 without protoc or Python's protobuf.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PROTO = HERE.parent.parent / "proto"
TARGET = HERE / "wire.d.ts"
WIDTH = 140
HEAD = """// The messages of proto/obliq.proto in protobuf's JSON: enumerators by name, 64 bits as text, an absent field has its default.
// Written by server/http/make_types.py: do not edit.

export type Int64 = string;
export type Real = number | "Infinity" | "-Infinity" | "NaN";
"""


def described(protoc):
    """The FileDescriptorProto of obliq.proto with its comments."""
    from google.protobuf import descriptor_pb2
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "set"
        subprocess.run([protoc, f"--proto_path={PROTO}", f"--descriptor_set_out={out}", "--include_source_info", "obliq.proto"], check=True)
        (file,) = descriptor_pb2.FileDescriptorSet.FromString(out.read_bytes()).file
    return file


def comments_of(file):
    """By path in the descriptor: the comment above an item, or behind it on its line; nothing of a section's heading."""
    said = {}
    for location in file.source_code_info.location:
        words = " ".join((location.leading_comments or location.trailing_comments).split()).replace("*/", "* /")
        if words and not words.startswith("----"):
            said[tuple(location.path)] = words
    return said


def type_of(field):
    """Of one value of a field, in TypeScript."""
    kinds = {field.TYPE_BOOL: "boolean", field.TYPE_STRING: "string", field.TYPE_DOUBLE: "Real", field.TYPE_FLOAT: "Real"}
    kinds |= dict.fromkeys((field.TYPE_INT32, field.TYPE_UINT32, field.TYPE_SINT32, field.TYPE_FIXED32, field.TYPE_SFIXED32), "number")
    kinds |= dict.fromkeys((field.TYPE_INT64, field.TYPE_UINT64, field.TYPE_SINT64, field.TYPE_FIXED64, field.TYPE_SFIXED64), "Int64")
    kinds |= dict.fromkeys((field.TYPE_MESSAGE, field.TYPE_ENUM), field.type_name.rpartition(".")[2])
    return kinds[field.type] + ("[]" if field.label == field.LABEL_REPEATED else "")


def comment(words, indent=""):
    return [f"{indent}/** {words} */"] if words else []


def text_of(file):
    said = comments_of(file)
    lines = [HEAD.rstrip(), ""]
    for k, enum in enumerate(file.enum_type):
        lines += comment(said.get((5, k)))
        names = [f'"{value.name}"' for value in enum.value]
        one_line = f"export type {enum.name} = {' | '.join(names)};"
        if len(one_line) <= WIDTH:
            lines.append(one_line)
        else:
            lines += [f"export type {enum.name} ="] + [f"  | {name}" for name in names]
            lines[-1] += ";"
    for k, message in enumerate(file.message_type):
        if message.nested_type or message.oneof_decl and any(not field.proto3_optional for field in message.field if field.HasField("oneof_index")):
            raise SystemExit(f"{message.name}: this program knows no nested messages and no oneof")
        lines += ["", *comment(said.get((4, k))), f"export interface {message.name} {{"]
        for n, field in enumerate(message.field):
            lines += comment(said.get((4, k, 2, n)), "  ")
            lines.append(f"  {field.name}?: {type_of(field)};")
        lines.append("}")
    names = [message.name for message in file.message_type]
    lines += ["", "/** By name. */", "export interface Messages {", *(f"  {name}: {name};" for name in names), "}"]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--protoc", default="protoc")
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    try:
        import google.protobuf  # noqa: F401
    except ImportError:
        print("skipped: Python's protobuf is missing; deploy/install-deps.sh test installs it")
        return 77
    if not shutil.which(args.protoc):
        print(f"skipped: {args.protoc} is missing; deploy/install-deps.sh installs it")
        return 77
    text = text_of(described(args.protoc))
    if not args.check:
        TARGET.write_text(text)
    elif not TARGET.exists() or TARGET.read_text() != text:
        print(f"{TARGET} is not what make_types.py writes; run: cmake --build --preset release --target generated")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

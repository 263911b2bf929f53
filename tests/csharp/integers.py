#!/usr/bin/env python3
"""The lists in ObliqStream.cs of the integers among the fields of RadarSettings, Pose and Target, from obliq.proto.

  integers.py [--check]      --check: fails where the lists are others
"""
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CODE = ROOT / "client" / "csharp" / "ObliqStream.cs"


def settled(code):
    proto = (ROOT / "proto" / "obliq.proto").read_text()
    bodies = "".join(re.search(rf"^message {name} {{(.*?)^}}", proto, re.M | re.S).group(1) for name in ("RadarSettings", "Pose", "Target"))
    for kind in ("int32", "int64", "uint32", "uint64"):
        found = re.findall(rf"^ *(?:optional )?{kind} (\w+) =", bodies, re.M)
        names = ", ".join(f'"{name}"' for name in dict.fromkeys(found))
        lines = textwrap.fill(names, 116, initial_indent=" " * 12, subsequent_indent=" " * 12)
        code, lists = re.subn(rf"(\b{kind.capitalize()}s = {{).*?( }};)", rf"\g<1>\n{lines}\g<2>", code, flags=re.S)
        if names and not lists:
            sys.exit(f"integers.py: ObliqStream.cs has no list for {kind}: {names}")
    return code


def main():
    code = CODE.read_text()
    if "--check" not in sys.argv[1:]:
        CODE.write_text(settled(code))
    elif settled(code) != code:
        sys.exit(f"{CODE} has other integers than obliq.proto; run: cmake --build --preset release --target generated")


if __name__ == "__main__":
    main()

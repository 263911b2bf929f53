#!/usr/bin/env python3
"""Fails on an include that points upstream, or on a heavy library's header in one of our .h files.

  include_direction.py ROOT          check the tree
  include_direction.py --self-test   plant wrong includes in a scratch tree and see that each is found
"""
import pathlib
import re
import sys
import tempfile

# What each folder may include from the others, besides itself. Data flows the other way.
SERVER_CORE = ["terrain", "server/scene", "server/radar"]
ALLOWED = {
    "terrain": [],
    "proto": [],
    "client": ["proto"],
    "server/scene": ["terrain"],
    "server/radar": ["terrain", "server/scene"],
    # The truth shares no code with the pipeline but the material functions.
    "server/truth": ["terrain", "server/scene/materials.h", "server/radar/scattering.h"],
    "server/accuracy": SERVER_CORE + ["server/truth"],
    "server/explain": SERVER_CORE + ["server/accuracy"],
    "server/control": SERVER_CORE + ["proto"],
    "server/flight": SERVER_CORE + ["server/control"],
    "server/output": SERVER_CORE
    + ["proto", "server/truth", "server/accuracy", "server/control", "server/explain/thresholds.h"],
    "server/log": ["server/control/log_config.h"],
    "server/net": SERVER_CORE + ["proto", "server/log", "server/control", "server/flight", "server/output"],
    "server/http": SERVER_CORE
    + ["proto", "server/log", "server/control", "server/flight", "server/output", "server/net"],
    "server/modbus": SERVER_CORE
    + ["proto", "server/log", "server/control", "server/flight", "server/output", "server/net"],
    "server/apps": ["terrain", "proto", "client", "server"],
    "tests": ["terrain", "proto", "client", "server"],
}
GENERATED = "obliq.pb.h"  # made from proto/obliq.proto; belongs to proto/

# Headers that cost every includer seconds or that we promise to keep behind our own interfaces.
CPP_ONLY = {
    "protobuf": r"google/protobuf/|.*\.pb\.h$",
    "Boost": r"boost/",
    "GDAL": r"(gdal|ogr|cpl)_?[a-z0-9_]*\.h$",
    "GEOS": r"geos(_c\.h|/|\.h)",
    "OpenSSL": r"openssl/",
    "toml++": r"toml(\+\+/|\.hpp|plusplus)",
    "CLI11": r"CLI/",
    "Embree": r"embree\d*/",
}
EMBREE_HOME = "server/scene"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def folder_of(path):
    """The entry of ALLOWED that holds this path, or None."""
    fits = [f for f in ALLOWED if path == f or path.startswith(f + "/")]
    return max(fits, key=len) if fits else None


def fault_of(source, bracket, included):
    """One sentence when `source` may not include `included`, else None."""
    if source.endswith(".h"):
        for library, pattern in CPP_ONLY.items():
            if re.match(pattern, included):
                return f"{library} headers belong in .cpp files"
    home = folder_of(source)
    if re.match(CPP_ONLY["Embree"], included) and home != EMBREE_HOME:
        return f"only {EMBREE_HOME} knows Embree"
    target = "proto/" + GENERATED if included.endswith(GENERATED) else included
    there = folder_of(target)
    if there is None and not target.startswith("server/"):
        return None if bracket == "<" else "our includes are written from the root of the project"
    if there == home:
        return None
    fits = any(target == a or target.startswith(a + "/") for a in ALLOWED[home])
    return None if fits else f"{home} may include only from {[home] + ALLOWED[home]}"


def sources(root):
    for top in sorted({f.split("/")[0] for f in ALLOWED}):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path


def check(root):
    """All faults below `root`, as printable lines, and the number of files read."""
    faults, files = [], 0
    for path in sources(root):
        files += 1
        name = path.relative_to(root).as_posix()
        if folder_of(name) is None:
            faults.append(f"{name}: this folder is not in the table of include_direction.py")
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = INCLUDE.match(line)
            fault = found and fault_of(name, *found.groups())
            if fault:
                faults.append(f"{name}:{number}: includes {found.group(2)}: {fault}")
    return faults, files


def self_test():
    wrong = {
        "terrain/a.h": '#include "server/radar/bins.h"',
        "terrain/b.cpp": '#  include <proto/codec.h>',
        "terrain/c.h": "#include <gdal_priv.h>",
        "terrain/d.h": "#include <geos_c.h>",
        "terrain/e.cpp": '#include "obliq.pb.h"',
        "proto/a.cpp": '#include "terrain/world.h"',
        "proto/b.h": '#include "obliq.pb.h"',
        "client/a.cpp": '#include "server/output/frame_files.h"',
        "client/b.h": "#include <boost/asio.hpp>",
        "server/scene/a.h": '#include "server/radar/settings.h"',
        "server/scene/b.h": "#include <embree3/rtcore.h>",
        "server/radar/a.cpp": '#include "server/control/table.h"',
        "server/radar/b.cpp": "#include <embree3/rtcore.h>",
        "server/output/a.cpp": '#include "server/net/session.h"',
        "server/control/b.cpp": '#include "server/output/frame_files.h"',
        "server/truth/a.cpp": '#include "server/scene/scene.h"',
        "server/truth/b.h": '#include "server/radar/frame_plan.h"',
        "server/control/a.h": "#include <toml++/toml.h>",
        "server/net/a.cpp": '#include "client/client.h"',
        "server/apps/a.h": "#include <CLI/CLI.hpp>",
        "server/net/c.h": "#include <openssl/ssl.h>",
        "server/radar/c.cpp": '#include "bins.h"',
        "server/radar/e.cpp": '#include "server/accuracy/bin_errors.h"',
        "server/accuracy/a.h": '#include "server/control/key.h"',
    }
    right = {
        "server/truth/c.cpp": '#include "server/radar/scattering.h"\n#include "server/scene/materials.h"',
        "terrain/f.cpp": '#include <gdal_priv.h>\n#include <vector>\n#include "terrain/world.h"',
        "client/c.cpp": '#include "obliq.pb.h"\n#include "proto/codec.h"',
        "server/scene/c.cpp": '#include <embree3/rtcore.h>\n#include "terrain/world.h"',
        "server/radar/d.cpp": '#include "server/scene/scene.h"\n#include "terrain/world.h"',
        "server/apps/b.cpp": '#include <CLI/CLI.hpp>\n#include "client/client.h"\n#include "server/net/session.h"',
    }
    with tempfile.TemporaryDirectory() as scratch:
        root = pathlib.Path(scratch)
        for name, text in {**wrong, **right}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text + "\n", encoding="utf-8")
        faults, _ = check(root)
    accused = {fault.split(":")[0] for fault in faults}
    for name in sorted(set(wrong) - accused):
        print(f"self-test: not found: {name}: {wrong[name]}")
    for name in sorted(accused - set(wrong)):
        print(f"self-test: wrongly accused: {name}")
    return accused == set(wrong)


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    if sys.argv[1] == "--self-test":
        return 0 if self_test() else 1
    faults, files = check(pathlib.Path(sys.argv[1]))
    print("\n".join(faults + [f"{files} files, {len(faults)} wrong includes"]))
    return 1 if faults or files == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Fails on an include that points upstream, or on a heavy library's header in one of our .h files.

  include_direction.py ROOT          check the tree
  include_direction.py --self-test   plant wrong includes in a scratch tree and see that each is found
"""
import pathlib
import re
import sys
import tempfile

# What each folder may include from the others, besides itself and what its files may include. Data flows the
# other way. Where a folder holds both what is below and what is above its rooms, files are named one by one:
# the longest name that fits decides.
BASE = ["terrain/base"]
WORDS = ["server/radar/bins", "server/radar/pulse_train", "server/radar/settings", "server/radar/beam_settings", "server/radar/samples", "server/radar/unsampled",
    "server/radar/receiver_settings", "server/radar/doppler_settings"]
R = "server/radar/"
BELOW_LANES = BASE + ["terrain/height_grid", R + "samples"] + ["server/scene/" + f for f in
    ("tracer_isa", "ground_triangle", "tolerances")]
TO_LANES = BELOW_LANES + [R + "simd/lanes"]
TO_PROFILE = ["terrain", "server/scene", R + "simd", R + "profile"]
TO_GEOMETRY = TO_PROFILE + WORDS + [R + "geometry"]
TO_PLAN = TO_GEOMETRY + [R + "beam", R + "doppler", R + "sea_state", R + "taper", R + "narrow_bins", R + "scene_plan", R + "frame_plan"]
TO_PLATES = TO_PLAN + [R + "visibility", R + "echo", R + "rays/ray_batch"]
SERVER_CORE = ["terrain", "server/scene", "server/radar"]
TO_OUTPUT = SERVER_CORE + ["proto", "server/truth", "server/accuracy", "server/control", "server/output"]
TO_STREAM = BASE + ["proto", "server/radar"]
ALLOWED = {
    "terrain/base": [],
    "terrain": [],
    "terrain/dem": BASE + ["terrain/cache/cache_key"] + ["terrain/" + f for f in
        ("world_spec", "frames", "grid_area", "height_grid", "polygon")],
    "terrain/cache": BASE + ["terrain/height_grid", "terrain/dem/source_error"],
    "terrain/buildings": BASE + ["terrain/dem"] + ["terrain/" + f for f in
        ("world", "world_spec", "frames", "height_grid", "polygon")],
    "proto": [],
    "client": ["proto"],
    "server/security": BASE,
    "server/scene": ["terrain"],
    "server/radar/simd": BELOW_LANES,
    "server/radar/simd/lanes": ["terrain/base", "server/scene/tracer_isa"],
    "server/radar/simd/echoes": TO_LANES,
    "server/radar/simd/ground": TO_LANES + [R + "simd/echoes"],
    "server/radar/simd/buildings": TO_LANES + [R + "simd/echoes", R + "simd/ground"],
    "server/radar/simd/receiver": TO_LANES,
    "server/radar/profile": TO_PROFILE,
    "server/radar/bins": TO_PROFILE,
    "server/radar/beam_settings": [],
    "server/radar/receiver_settings": [],
    "server/radar/doppler_settings": [],
    "server/radar/sea_state": BASE + WORDS + ["server/radar/simd"],
    "server/radar/taper": ["terrain/base"],
    "server/radar/settings": TO_PROFILE + ["server/radar/beam_settings", "server/radar/receiver_settings", "server/radar/doppler_settings"],
    "server/radar/samples": ["terrain/buildings/buildings"],
    "server/radar/unsampled": TO_PROFILE + WORDS,
    "server/radar/doppler": TO_PROFILE + WORDS + [R + "sea_state", R + "taper"],
    "server/radar/beam": TO_PROFILE + WORDS + [R + "doppler", R + "sea_state", R + "taper"],
    "server/radar/geometry": TO_GEOMETRY,
    "server/radar/scene_plan": TO_GEOMETRY + [R + "beam", R + "doppler", R + "taper"],
    "server/radar/narrow_bins": TO_PROFILE + WORDS,
    "server/radar/frame_plan": TO_PLAN,
    "server/radar/visibility": TO_PLAN,
    "server/radar/echo": TO_PLAN,
    "server/radar/echo/corners": ["terrain", "server/scene/materials", R + "receiver_settings", R + "simd/lanes/exact_math"],
    "server/radar/echo/scattering": ["terrain", "server/scene/materials", R + "echo/corners", R + "simd/lanes/exact_math", R + "simd/echoes/cross_section"],
    "server/radar/rays/ray_batch": TO_GEOMETRY,
    "server/radar/rays/plates": TO_PLATES,
    "server/radar/rays": TO_PLATES + [R + "rays/plates"],
    "server/radar/sweep": TO_PLAN + [R + "echo"],
    "server/radar/receiver": BASE + WORDS + [R + "simd", R + "beam", R + "doppler"],
    "server/radar/targets": TO_PLAN + [R + "receiver/weather"],
    "server/radar": ["terrain", "server/scene"],
    # The truth shares no code with the pipeline but the material functions.
    "server/truth": ["terrain", "server/scene/materials", "server/radar/echo/corners", "server/radar/echo/scattering"],
    "server/ground_query": SERVER_CORE + ["proto"],
    "server/accuracy": SERVER_CORE + ["server/truth"],
    "server/explain": SERVER_CORE + ["server/accuracy"],
    "server/control": SERVER_CORE + ["proto", "server/security/networks", "server/log/log_config"],
    "server/flight": SERVER_CORE + ["server/control", "server/log/log"],
    "server/output": TO_OUTPUT,
    "server/loading": SERVER_CORE + ["server/truth", "server/accuracy", "server/control"],
    "server/frontier": TO_OUTPUT + ["server/loading"],
    "server/timing": TO_OUTPUT + ["server/stream", "client"],
    "server/log": BASE,
    "server/stream": TO_STREAM,
    "server/rendering": TO_STREAM + ["server/scene", "server/control", "server/flight", "server/output",
        "server/stream", "server/log/log"],
    "server/net": TO_STREAM + ["server/control", "server/flight", "server/stream", "server/rendering",
        "server/security", "server/log", "server/ground_query"],
    "server/websocket": BASE + ["proto", "server/net", "server/stream", "server/http"],
    "server/http": BASE + ["server/scene", "server/security", "server/log", "server/rendering", "server/net"],
    "server/modbus": BASE + ["server/control", "server/security", "server/log", "server/net"],
    "server/asterix": BASE + ["proto", "client"],
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


def is_in(path, place):
    """Whether a path is a file of this name, whatever its ending, or lies in a folder of this name."""
    return path.startswith((place + "/", place + "."))


def room_of(path):
    """The entry of ALLOWED that holds this path, or None."""
    fits = [f for f in ALLOWED if is_in(path, f)]
    return max(fits, key=len) if fits else None


def fault_of(source, bracket, included):
    """One sentence when `source` may not include `included`, else None."""
    if source.endswith(".h"):
        for library, pattern in CPP_ONLY.items():
            if re.match(pattern, included):
                return f"{library} headers belong in .cpp files"
    home = room_of(source)
    if re.match(CPP_ONLY["Embree"], included) and home != EMBREE_HOME:
        return f"only {EMBREE_HOME} knows Embree"
    target = "proto/" + GENERATED if included.endswith(GENERATED) else included
    there = room_of(target)
    if there is None and not target.startswith("server/"):
        return None if bracket == "<" else "our includes are written from the root of the project"
    if there == home:
        return None
    fits = any(is_in(target, a) for a in [home] + ALLOWED[home])
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
        if room_of(name) is None:
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
        "server/net/b.cpp": '#include "server/output/frame_files.h"',
        "server/stream/a.cpp": '#include "server/rendering/job.h"',
        "server/stream/b.h": '#include "server/control/key.h"',
        "server/rendering/a.cpp": '#include "server/net/peer.h"',
        "server/security/a.h": '#include "server/net/tcp.h"',
        "server/apps/a.h": "#include <CLI/CLI.hpp>",
        "server/net/c.h": "#include <openssl/ssl.h>",
        "server/radar/c.cpp": '#include "bins.h"',
        "server/radar/f.cpp": '#include "server/ground_query/question.h"',
        "server/ground_query/a.cpp": '#include "server/net/peer.h"',
        "server/radar/e.cpp": '#include "server/accuracy/bin_errors.h"',
        "server/accuracy/a.h": '#include "server/control/key.h"',
    }
    right = {
        "server/truth/c.cpp": '#include "server/radar/echo/scattering.h"\n#include "server/scene/materials.h"',
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

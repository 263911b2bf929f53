#!/usr/bin/env python3
"""The structure of the sources: how large, who knows whom.

  tests/structure.py              prints lines by folder, the largest folder, arrows back, circles, marches over the grid, and public
                                  Python names without types; exit code 1 where one of them is not as it should be
  tests/structure.py --self-test  plants each fault in a scratch tree and sees that it is found

An arrow goes from a file to what it includes or imports. It points back where it goes against the flow of data: in C++ by the
table of tests/checks/include_direction.py; in the Python package where a module imports the package's face or its command; in the
page where a module imports main.js, which starts it. A circle is of files, or in C++ of rooms: the folders of server/, those of
server/radar. Lazy imports count; imports for types alone do not.
"""
import ast
import collections
import pathlib
import posixpath
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "checks"))
import include_direction  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRODUCT = ("terrain", "proto", "client", "server")
CPP, SOURCES = (".h", ".cpp"), (".h", ".cpp", ".c", ".py", ".js", ".cs", ".sh", ".css", ".html", ".proto")
DEEP = {"client": 2, "server": 3, "tests": 3, "deploy": 2}  # names of a folder that is counted by itself
MOST_FILES = 40  # sources of a folder, without those below it
DATA = ("tests/fuzz/corpus",)  # inputs, not sources
PACKAGE, PAGE = "client/python/src/obliq", "server/http/page"
FACES = ("__init__", "__main__")
# The one march: `march` in ground_cells.h moves profiles from cell to cell by move_on.
CELLS = "server/radar/simd/ground/ground_cells.h"
NO_MARCHES = {"server/radar/profile/tile_walk.h": "tiles, not cells",
              "server/scene/exact_hit.cpp": "one ray in double, where a tracer's answer is repaired: slow and sure"}
MOVES_ON = re.compile(r"(?<!void )\bmove_on\(")
LEAVES_BY = re.compile(r"\bto_x\b[^;\n]*<[^;\n]*\bto_z\b")  # by which of the lines ahead a cell is left
IMPORT = re.compile(r"""(?:^|[;}])\s*(?:import|export)\b[^;'"]*?from\s*["'](\.\.?/[^"']+)["']|^\s*import\s*["'](\.\.?/[^"']+)["']|"""
                    r"""\bimport\(\s*["'](\.\.?/[^"']+)["']\s*\)""", re.M)
COMMENT = re.compile(r"/\*.*?\*/|(?<!:)//[^\n]*", re.S)


def files_of(root):
    """Paths below root, as text with slashes: those that git knows, or all of a tree that is none."""
    known = subprocess.run(["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                           capture_output=True, text=True)
    names = known.stdout.split("\0") if known.returncode == 0 else [p.relative_to(root).as_posix() for p in root.rglob("*")]
    return sorted(name for name in names if name and (root / name).is_file())


def text_of(root, name):
    return (root / name).read_text(encoding="utf-8", errors="replace")


def circles(arrows):
    """Groups of nodes that reach each other (Tarjan), those of more than one."""
    number, low, stack, found = {}, {}, [], []

    def visit(node):
        number[node] = low[node] = len(number)
        stack.append(node)
        for there in sorted(arrows.get(node, ())):
            if there not in number:
                visit(there)
                low[node] = min(low[node], low[there])
            elif there in stack:
                low[node] = min(low[node], number[there])
        if low[node] == number[node]:
            group = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(group) > 1:
                found.append(sorted(group))
    sys.setrecursionlimit(10000)
    for node in sorted(arrows):
        if node not in number:
            visit(node)
    return found


def cpp_arrows(root, files):
    """{file: files that it includes}."""
    known, arrows = set(files), {}
    for name in files:
        for line in text_of(root, name).splitlines():
            found = include_direction.INCLUDE.match(line)
            if found and found.group(2) in known:
                arrows.setdefault(name, set()).add(found.group(2))
    return arrows


def between(arrows, room_of):
    """Those between rooms; room_of(file): None where it is in none of them."""
    found = {}
    for name, included in arrows.items():
        for there in included:
            if room_of(name) and room_of(there) and room_of(name) != room_of(there):
                found.setdefault(room_of(name), set()).add(room_of(there))
    return found


def room_of_product(name):
    top, *rest = name.split("/")
    return None if top not in PRODUCT else f"server/{rest[0]}" if top == "server" else top


def room_of_radar(name):
    """A folder of server/radar; a file that lies beside them by itself."""
    parts = name.split("/")
    return "/".join(parts[:3]) if parts[:2] == ["server", "radar"] else None


def for_types_alone(tree):
    """Import nodes below `if TYPE_CHECKING:`."""
    return {node for branch in ast.walk(tree) if isinstance(branch, ast.If) and "TYPE_CHECKING" in ast.unparse(branch.test)
            for child in branch.body for node in ast.walk(child)}


def python_arrows(root, files):
    """{module: modules of the package that it imports}."""
    modules, arrows = {pathlib.PurePath(name).relative_to(PACKAGE).with_suffix("").as_posix(): name for name in files}, {}
    for module, name in modules.items():
        tree = ast.parse(text_of(root, name))
        skipped, folder = for_types_alone(tree), pathlib.PurePath(module).parent
        for node in ast.walk(tree):
            if not isinstance(node, ast.ImportFrom) or node in skipped:
                continue
            if node.level:
                base = folder
                for _ in range(node.level - 1):
                    base = base.parent
                base = base / node.module.replace(".", "/") if node.module else base
            elif (node.module or "").split(".")[0] == "obliq":
                base = pathlib.PurePath(*node.module.split(".")[1:])
            else:
                continue
            there = [(base / alias.name).as_posix() for alias in node.names if (base / alias.name).as_posix() in modules]
            if len(there) < len(node.names):  # names that are no modules are of the base itself
                there += [m for m in (base.as_posix(), (base / "__init__").as_posix()) if m in modules]
            arrows.setdefault(module, set()).update(m for m in there if m != module)
    return arrows


def page_arrows(root, files):
    arrows = {}
    for name in files:
        module = pathlib.PurePath(name).relative_to(PAGE)
        for groups in IMPORT.findall(COMMENT.sub("", text_of(root, name))):
            arrows.setdefault(module.as_posix(), set()).add(posixpath.normpath(module.parent / "".join(groups)))
    return arrows


def untyped(root, files):
    """Public functions and methods of public modules that lack a type, as MODULE.NAME."""
    found = []

    def look(body, where):
        for node in body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                look(node.body, f"{where}.{node.name}")
            elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and (node.name == "__init__" or not node.name.startswith("_")):
                a = node.args
                named = [*a.posonlyargs, *a.args, *a.kwonlyargs, *filter(None, (a.vararg, a.kwarg))]
                bare = [arg for k, arg in enumerate(named) if arg.annotation is None and not (k == 0 and arg.arg in ("self", "cls"))]
                if bare or (node.returns is None and node.name != "__init__"):
                    found.append(f"{where}.{node.name}")
    for name in files:
        module = pathlib.PurePath(name).stem
        if not module.startswith("_") and not module.endswith("_pb2"):
            look(ast.parse(text_of(root, name)).body, module)
    return found


def marches(root, files):
    """Places that step from cell to cell of the grid."""
    found = []
    for name in files:
        if not name.startswith("server/") or name in NO_MARCHES:
            continue
        for number, line in enumerate(COMMENT.sub(lambda m: "\n" * m[0].count("\n"), text_of(root, name)).splitlines(), 1):
            if MOVES_ON.search(line) or (name != CELLS and LEAVES_BY.search(line)):
                found.append(f"{name}:{number}")
    return found


def folder_of(name):
    parts = name.split("/")[:-1]
    return "/".join(parts[:DEEP.get(parts[0], 1)]) if parts else "."


class Structure:
    def __init__(self, root):
        files = [name for name in files_of(root) if not name.startswith(DATA)]
        self.sources = [name for name in files if name.endswith(SOURCES)]
        self.lines = {name: text_of(root, name).count("\n") for name in self.sources}
        cpp = [name for name in self.sources if name.endswith(CPP)]
        python = [name for name in self.sources if name.startswith(PACKAGE + "/") and name.endswith(".py")]
        page = [name for name in self.sources if name.startswith(PAGE + "/") and name.endswith(".js")]
        self.back, _ = include_direction.check(root)
        self.counts = collections.Counter(str(pathlib.PurePath(name).parent) for name in self.sources)
        self.circles, self.arrows = [], {}
        includes = cpp_arrows(root, cpp)
        for room_of in (room_of_product, room_of_radar):
            self.circles += [f"rooms: {', '.join(group)}" for group in circles(between(includes, room_of))]
        for language, arrows in (("C++", includes), ("Python", python_arrows(root, python)), ("JavaScript", page_arrows(root, page))):
            self.circles += [f"{language}: {', '.join(group)}" for group in circles(arrows)]
            self.arrows[language] = sum(map(len, arrows.values()))
            for module, there in sorted(arrows.items()):
                if language == "Python":
                    self.back += [f"{PACKAGE}/{module}.py: imports {face}, which is above it"
                                  for face in FACES if face in there and module not in FACES]
                if language == "JavaScript" and "main.js" in there:
                    self.back.append(f"{PAGE}/{module}: imports main.js, which is above it")
        self.marches = marches(root, cpp)
        self.untyped = untyped(root, python)

    def too_large(self):
        return [f"{folder}: found {count} files; allowed: {MOST_FILES}" for folder, count in sorted(self.counts.items()) if count > MOST_FILES]

    def faults(self):
        ours = [place for place in self.marches if place.startswith(CELLS)][:1]
        return [*self.back, *(f"circle: {words}" for words in self.circles),
                *(f"march over the grid: {place}" for place in self.marches if place not in ours),
                *(f"no types: {name}" for name in self.untyped), *self.too_large()]

    def text(self):
        by_folder = collections.Counter()
        for name, count in self.lines.items():
            by_folder[folder_of(name)] += count
        product = sum(count for name, count in self.lines.items() if name.endswith(CPP) and name.split("/")[0] in PRODUCT)
        tests = sum(count for name, count in self.lines.items() if name.startswith("tests/"))
        rows = [f"{count:8,}  {folder}" for folder, count in sorted(by_folder.items())]
        folder, count = max(self.counts.items(), key=lambda item: (item[1], item[0]))
        of_tests = max((item for item in self.counts.items() if item[0].startswith("tests")), key=lambda item: item[1], default=("none", 0))
        arrows = ", ".join(f"{count} {language}" for language, count in self.arrows.items())
        return "\n".join(["lines by folder", *rows, f"lines: {sum(self.lines.values()):,}; C++ of the product {product:,}, tests {tests:,}",
                          f"largest folder: {folder}, {count} files; of tests: {of_tests[0]}, {of_tests[1]}",
                          f"arrows: {arrows}", f"arrows back: {len(self.back)}", f"circles: {len(self.circles)}",
                          f"marches over the grid: {len(self.marches)}",
                          *(f"  not counted: {name} ({why})" for name, why in NO_MARCHES.items()), f"public Python names without types: {len(self.untyped)}"])


RIGHT = {
    CELLS: "void move_on(int);\nconst bool by_x = ends.to_x < ends.to_z;\nvoid march() { move_on(1); }  // move_on( in words\n",
    list(NO_MARCHES)[0]: "if (to_x < to_z) ++i;\n",
    "server/scene/a.h": '#include "terrain/world.h"\n',
    PACKAGE + "/__init__.py": "from .client import connect\n",
    PACKAGE + "/client.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from . import __init__\n\n\ndef connect(x: int) -> int:\n    return x\n",
    PAGE + "/main.js": 'import { a } from "./a.js";\n',
    PAGE + "/a.js": '/** @param {import("./main.js").App} app */\nexport const a = 1; // import("./main.js")\n',
}
WRONG = {  # what is planted, and the words that name it
    "terrain/a.h": ('#include "server/scene/a.h"\n', "terrain/a.h:1"),
    "server/radar/echo/a.h": ('#include "server/radar/echo/b.h"\n', "circle: C++: server/radar/echo/a.h, server/radar/echo/b.h"),
    "server/radar/echo/b.h": ('#include "server/radar/echo/a.h"\n#include "server/radar/sweep/e.h"\n', "circle: rooms: server/radar/echo, server/radar/sweep"),
    "server/radar/sweep/e.cpp": ('#include "server/radar/echo/a.h"\n', "circle: rooms"),
    "server/radar/sweep/e.h": ("\n", "circle: rooms"),
    "server/radar/echo/c.cpp": ("void walk() {\n  if (ray.to_x < ray.to_z) ++i;\n}\n", "march over the grid: server/radar/echo/c.cpp:2"),
    "server/radar/echo/d.cpp": ("void walk() {\n  move_on(p);\n}\n", "march over the grid: server/radar/echo/d.cpp:2"),
    PACKAGE + "/frames.py": ("def f():\n    from . import _files\n", "circle: Python: _files, frames"),
    PACKAGE + "/_files.py": ("from .frames import f\n\n\ndef g(x):\n    pass\n", "circle: Python: _files, frames"),
    PACKAGE + "/sets.py": ("class Set:\n    def size(self, of):\n        pass\n", "no types: sets.Set.size"),
    PACKAGE + "/tools.py": ("from obliq import connect\n", "tools.py: imports __init__"),
    PAGE + "/b.js": ('import {\n  c,\n} from "./c.js";\n', "circle: JavaScript: b.js, c.js"),
    PAGE + "/c.js": ('export const c = () => import("./b.js");\n', "circle: JavaScript: b.js, c.js"),
    PAGE + "/d.js": ('import "./main.js";\n', "d.js: imports main.js"),
    **{f"tests/unit/t{k}_test.cpp": ("\n", "tests/unit: found 41 files; allowed: 40") for k in range(41)},
}


def self_test():
    def faults(tree):
        with tempfile.TemporaryDirectory() as scratch:
            for name, content in tree.items():
                path = pathlib.Path(scratch) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(content, encoding="utf-8")
            structure = Structure(pathlib.Path(scratch))
            return structure.faults(), len(structure.marches)
    clean, count = faults(RIGHT)
    missed = [f"wrongly accused: {fault}" for fault in clean] + ([] if count == 1 else [f"{count} marches where there is one"])
    found, _ = faults({**RIGHT, **{name: content for name, (content, _) in WRONG.items()}})
    missed += [f"not found: {words}" for words in sorted({words for _, words in WRONG.values()}) if not any(words in fault for fault in found)]
    print("\n".join(f"self-test: {line}" for line in missed) or f"self-test: {len(found)} faults found")
    return not missed


def main():
    if sys.argv[1:] == ["--self-test"]:
        return 0 if self_test() else 1
    if len(sys.argv) > 1:
        print(__doc__)
        return 2
    structure = Structure(ROOT)
    print(structure.text())
    for fault in structure.faults():
        print(fault, file=sys.stderr)
    return 1 if structure.faults() or len(structure.marches) != 1 else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""How the page's modules hang together.

  page_modules.py ROOT         fails on a circle of imports, on a module that knows main.js or what it gives to tests, on one but
                               main.js that knows more than MOST_KNOWN others, on one above MOST_LINES lines
  page_modules.py --self-test  plants each of these
"""
import pathlib
import re
import sys
import tempfile

MOST_KNOWN = 15  # modules that one imports, or whose types it names; main.js alone knows all
MOST_LINES = 400
IMPORT = re.compile(r'^import .*?from "(\.[\w./]+\.js)";', re.M | re.S)
TYPE = re.compile(r'import\("(\.[\w./]+\.js)"\)')
GLOBAL = re.compile(r"\b(?:globalThis|window)\.obliq\b")


def named(folder, file, pattern):
    """The modules below `folder` that a pattern finds in one of them, by their paths."""
    paths = ((file.parent / found).resolve() for found in pattern.findall(file.read_text()))
    return {path.relative_to(folder).as_posix() for path in paths if path.is_relative_to(folder)}


def imports_of(folder):
    """By module: those that it imports."""
    folder = folder.resolve()
    return {file.relative_to(folder).as_posix(): named(folder, file, IMPORT) for file in sorted(folder.rglob("*.js"))}


def circles(imports):
    """Circles of imports, each as a list of modules whose last one imports its first."""
    found, done = [], set()

    def walk(module, way):
        if module in way:
            found.append(way[way.index(module):])
        elif module not in done:
            for other in sorted(imports.get(module, ())):
                walk(other, [*way, module])
            done.add(module)

    for module in imports:
        walk(module, [])
    return found


def faults(folder):
    """In words, a line each."""
    folder = folder.resolve()
    imports = imports_of(folder)
    found = [f"circle of imports: {' -> '.join([*circle, circle[0]])}" for circle in circles(imports)]
    for module, own in imports.items():
        text = (folder / module).read_text()
        known = own | named(folder, folder / module, TYPE)
        lines = text.count("\n")
        if lines > MOST_LINES:
            found.append(f"{module}: {lines} lines; allowed: {MOST_LINES}")
        if module == "main.js":
            continue
        if "main.js" in known or GLOBAL.search(text):
            found.append(f"{module}: knows main.js; allowed: none")
        if len(known) > MOST_KNOWN:
            found.append(f"{module}: knows {len(known)} modules; allowed: {MOST_KNOWN}")
    return found


def self_test():
    ring = {"a.js": 'import { b } from "./b.js";\n', "b.js": 'import {\n  c,\n} from "./c.js";\n', "c.js": 'import { a } from "./a.js";\n'}
    many = "".join(f'import {{ m{k} }} from "./m{k}.js";\n' for k in range(MOST_KNOWN + 1))
    cases = [(ring, "circle of imports: a.js -> b.js -> c.js -> a.js"),
             ({"a.js": '/** @param {import("./main.js").App} app */\n'}, "a.js: knows main.js"),
             ({"a.js": "globalThis.obliq.tell();\n"}, "a.js: knows main.js"),
             ({"a.js": many}, f"a.js: knows {MOST_KNOWN + 1} modules"),
             ({"a.js": "\n" * (MOST_LINES + 1)}, f"a.js: {MOST_LINES + 1} lines"),
             ({"main.js": many, "a.js": 'import { b } from "./b.js";\n', "b.js": '/** @type {import("./a.js").A} */\n'}, "")]
    for files, wanted in cases:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for file, text in files.items():
                (folder / file).write_text(text)
            found = faults(folder)
            if len(found) != (1 if wanted else 0) or not all(line.startswith(wanted) for line in found):
                print(f"wanted {wanted!r}, found {found}")
                return 1
    print(f"{len(cases)} cases")
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    folder = pathlib.Path(sys.argv[1]) / "server" / "http" / "page"
    found = faults(folder)
    imports = imports_of(folder)
    print("\n".join(found) or f"{len(imports)} modules, {sum(map(len, imports.values()))} imports, no circle")
    return 1 if found or not imports else 0


if __name__ == "__main__":
    sys.exit(main())

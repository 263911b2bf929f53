#!/usr/bin/env python3
"""Links between documents lead somewhere: to a file, to a heading of it. And where a text says PROTOCOL.md or model.md
and a name in quotes, that document has a part of this name.

  links.py [FOLDER]      exit code 1 and a line for each link that leads nowhere
  links.py --self-test   planted links are found
"""
import os
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^()\s]+)\)")
# A part that another document or a comment names; the name stands on the same line.
NAMED = re.compile(r"(PROTOCOL|model)\.md\)?, \\?\"([^\"\\]+?),?\\?\"")
DOCUMENTS = {"PROTOCOL": "proto/PROTOCOL.md", "model": "client/guide/model.md"}
SOURCES = {".md", ".cpp", ".h", ".py", ".js", ".cs", ".proto", ".toml", ".ipynb"}
LEFT_OUT = {"build", "out", ".git", "node_modules"}


def files(folder, suffixes):
    for here, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in LEFT_OUT)
        for name in sorted(names):
            if pathlib.PurePath(name).suffix in suffixes:
                yield pathlib.Path(here) / name


def anchors(text):
    """As GitHub makes them of headings."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    found = set()
    for heading in re.findall(r"^#+ (.+)$", text, re.M):
        heading = re.sub(r"[`*]|\[|\]\([^)]*\)", "", heading).lower()
        found.add(re.sub(r"[^\w\- ]", "", heading).replace(" ", "-"))
    return found


def parts_of(text):
    """Headings, and paragraphs and items that begin with an emphasised name."""
    return set(re.findall(r"^#+ (.+)$", text, re.M)) | set(re.findall(r"^(?:- )?\*{1,2}([^*]+?)\.?\*{1,2}", text, re.M))


def faults_of(folder):
    found = []
    for page in files(folder, {".md"}):
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for target in LINK.findall(text):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            path = (page.parent / name).resolve() if name else page
            if not path.exists():
                found.append(f"{page.relative_to(folder)}: {target}: no such file")
            elif anchor and path.suffix == ".md" and anchor not in anchors(path.read_text(encoding="utf-8")):
                found.append(f"{page.relative_to(folder)}: {target}: no such heading")
    parts = {name: parts_of((folder / path).read_text(encoding="utf-8")) for name, path in DOCUMENTS.items() if (folder / path).exists()}
    for path in files(folder, SOURCES):
        if path == pathlib.Path(__file__).resolve():
            continue  # it plants names
        for document, name in NAMED.findall(path.read_text(encoding="utf-8")):
            if document in parts and name not in parts[document]:
                found.append(f'{path.relative_to(folder)}: {document}.md has no part "{name}"')
    return found


def self_test():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "proto").mkdir()
        (folder / "proto/PROTOCOL.md").write_text("# The stream\n\n### Where a bin lies\n\n*Latency.* Words.\n")
        good = '[a](proto/PROTOCOL.md) [b](proto/PROTOCOL.md#where-a-bin-lies) PROTOCOL.md, "Latency"\n'
        (folder / "good.md").write_text(good)
        assert not faults_of(folder), faults_of(folder)
        for bad in ("[a](gone.md)", "[a](proto/PROTOCOL.md#gone)", '[P](proto/PROTOCOL.md), "Gone"'):
            (folder / "bad.md").write_text(bad + "\n")
            assert len(faults_of(folder)) == 1, bad
    print("planted links are found")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    found = faults_of(pathlib.Path(sys.argv[1]).resolve() if sys.argv[1:] else ROOT)
    print("\n".join(found) or "every link leads somewhere")
    return sys.exit(bool(found))


if __name__ == "__main__":
    main()

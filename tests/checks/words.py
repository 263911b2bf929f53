#!/usr/bin/env python3
"""Comments and documents are plain English: none has a phrase of the list below, but for the exceptions that are listed.

  words.py              exit code 1 and a line for each phrase: file, line, what was found, what says it plainly
  words.py --self-test  sentences planted in each kind of source are found, and code and strings are left alone

Read are comments of C++, C#, JavaScript, proto, Python (docstrings too), shell, CMake, TOML and YAML, and all of Markdown but code.
A phrase may run over a line's end.
"""
import io
import os
import pathlib
import re
import sys
import tempfile
import tokenize

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Phrase (a regular expression, one space for any gap), and what to write.
WORDS = {
    r"in hand": "current, in progress",
    r"at hand": "current, nearby",
    r"such an? one": "name the thing again",
    r"what is no": "what is not a",
    r"hears": "receives, gets, notices",
    r"(?:is|are|was) heard": "is received, is noticed",
    r"(?:what )?it is late by": "its delay",
    r"those who": "clients that, programs that",
    r"somebody": "a client, the operator",
    r"whoever": "name who: the holder, any client",
    r"who (?:wants|asks)": "a client that",
    r"as ever": "as usual, unchanged",
    r"to be had": "available",
    r"for want of": "for lack of, because ... is missing",
    r"many a": "many per, a number per",
    r"nought|naught": "0, nothing",
    r"lest|whence|whither|thereof|wherefore": "a word of today",
    r"of a sudden|of no account|in its stead|word of mouth": "suddenly, unimportant, instead",
    r"he|his|him|she": "the operator, the client, it",
    r"knows nothing": "does not depend on, does not know",
    r"tells? of": "reports, describes",
}
# File, phrase as found: why it stays.
EXCEPTIONS = {
    ("tests/checks/words.py", "*"): "the list itself",
}
C_LIKE = {".cpp", ".h", ".c", ".cs", ".js", ".proto"}
HASH = {".sh", ".cmake", ".toml", ".yaml", ".yml", ".service", ".rules"}
DOCUMENTS = {".md"}
DOCUMENT_FILES = {"client/guide/not_modelled.txt", "client/guide/known_faults.txt", "server/http/page/index.html"}
LEFT_OUT = {"build", "out", ".git", "corpus", "node_modules", "data"}
GENERATED = {"help.html", "obliq_pb2.py", "obliq_pb2.pyi"}
C_TOKEN = re.compile(r"""(?P<comment>//[^\n]*|/\*.*?\*/)|R"(?P<mark>[^\s()\\]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`""", re.S)
CODE = "\0"


def blank(text):
    """Code, so that words on either side of it are no neighbours."""
    return re.sub(r"\S", CODE, text)


def leaders(comment):
    """Without what marks a comment, at the same places."""
    return re.sub(r"(?m)^(\s*)(//[/!]?<?|/\*+<?|\*/?|#+:?)|\*/$|(?<=\A)//[/!]?<?", lambda m: " " * len(m.group(0)), comment)


def c_like(text):
    out, at = [], 0
    for match in C_TOKEN.finditer(text):
        out.append(blank(text[at : match.start()]))
        out.append(leaders(match.group(0)) if match.group("comment") else blank(match.group(0)))
        at = match.end()
    return "".join(out) + blank(text[at:])


def hash_marked(text):
    return re.sub(r"(?m)^(.*?)(?:(?<!\S)#(.*))?$",
                  lambda m: blank(m.group(1)) + ("" if m.group(2) is None else " " + m.group(2)), text)


def python(text):
    """Comments, and strings that stand by themselves."""
    kept, before = [], tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and before in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)):
            kept.append((token.start, token.end))
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            before = token.type
    lines = text.splitlines(True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    out, at = [], 0
    for (row, column), (end_row, end_column) in kept:
        begin, end = starts[row - 1] + column, starts[end_row - 1] + end_column
        out += [blank(text[at:begin]), leaders(text[begin:end]).replace("\"\"\"", "   ")]
        at = end
    return "".join(out) + blank(text[at:])


def document(text):
    text = re.sub(r"(?ms)^```.*?^```", lambda m: blank(m.group(0)), text)
    text = re.sub(r"`[^`\n]*`", lambda m: blank(m.group(0)), text)
    return re.sub(r"\]\([^)\n]*\)", lambda m: blank(m.group(0)), text)


def prose_of(name, text):
    """The text with all that is no prose blanked out; None: a file of another kind."""
    path = pathlib.PurePath(name)
    if path.suffix in C_LIKE:
        return c_like(text)
    if path.suffix in HASH or path.name == "CMakeLists.txt" or name == ".ci/run":
        return hash_marked(text)
    if path.suffix == ".py":
        return python(text)
    if path.suffix in DOCUMENTS or name in DOCUMENT_FILES:
        return document(text)
    return None


PATTERNS = [(re.compile(r"\b(?:" + phrase.replace(" ", r"\s+") + r")\b"), plain) for phrase, plain in WORDS.items()]
ANY = re.compile("|".join(pattern.pattern for pattern, _ in PATTERNS))


def faults_of(name, text):
    prose = prose_of(name, text)
    if prose is None:
        return []
    prose = prose.lower()
    if ANY.search(prose) is None:
        return []
    found = []
    for pattern, plain in PATTERNS:
        for match in pattern.finditer(prose):
            words = re.sub(r"\s+", " ", match.group(0))
            if (name, words) not in EXCEPTIONS and (name, "*") not in EXCEPTIONS:
                found.append((prose.count("\n", 0, match.start()) + 1, words, plain))
    return [f'{name}:{line}: found "{words}"; allowed: {plain}' for line, words, plain in sorted(found)]


def names_in(folder):
    for here, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name not in LEFT_OUT]
        for name in files:
            if name not in GENERATED:
                yield os.path.relpath(os.path.join(here, name), folder)


def faults_in(folder):
    found, read = [], 0
    for name in sorted(names_in(folder)):
        if prose_of(name, "") is not None:
            read += 1
            found += faults_of(name, (folder / name).read_text(encoding="utf-8"))
    return found, read


PLANTED = {
    "a.cpp": ("/// The frame in\n/// hand is lost.\nint x;  // \"quoted\"\n", 1),
    "b.h": ('const char* kText = "in hand // at hand";\nauto r = R"(such a one)";\nint in; int hand;\n', 0),
    "c.py": ('"""What is no\nframe."""\nTEXT = "hears"\nx = 1  # it hears\n', 2),
    "d.js": ("/**\n * For those who watch.\n */\nconst a = 'at hand';\n", 1),
    "e.proto": ("message M {\n  bool b = 1;  // what it is late by\n}\n", 1),
    "f.sh": ("#!/bin/sh\necho 'in hand' ${#x}\n# as\n# ever\n", 1),
    "g.toml": ("a = 1  # at hand\n", 1),
    "h/CMakeLists.txt": ("# Such a one.\nset(a hand)\n", 1),
    "i.md": ("Words `in hand`, then in\nhand.\n\n```sh\n# at hand\n```\n", 1),
}


def self_test():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for path, (text, _) in PLANTED.items():
            (folder / path).parent.mkdir(exist_ok=True)
            (folder / path).write_text(text, encoding="utf-8")
        found, read = faults_in(folder)
        for path, (_, wanted) in PLANTED.items():
            here = [fault for fault in found if fault.startswith(f"{path}:")]
            assert len(here) == wanted, (path, wanted, here)
        assert read == len(PLANTED)
    print("planted sentences are found, and code and strings are left alone")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    found, read = faults_in(ROOT)
    if read < 1000:
        sys.exit(f"words.py read {read} files; allowed: 1000 and more")
    print("\n".join(found) or f"{read} files have none of {len(WORDS)} phrases")
    return sys.exit(bool(found))


if __name__ == "__main__":
    main()

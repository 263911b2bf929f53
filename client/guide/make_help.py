#!/usr/bin/env python3
"""Makes the page's help.html from display.md. make_help.py [--check]: with --check nothing is written, and a difference is an error.

Knows what display.md uses: headings, paragraphs, tables, lists, fenced blocks, `code`, *emphasis*, **strong**."""
import html
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE / "display.md"
TARGET = HERE.parent.parent / "server" / "http" / "page" / "help.html"
HEAD = """<!doctype html>
<!-- Made by client/guide/make_help.py from client/guide/display.md: do not edit. -->
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark">
<title>obliq: the display</title>
<link rel="icon" href="icon.svg" type="image/svg+xml">
<link rel="stylesheet" href="style.css">
</head>
<body class="help">
<article>
"""
TAIL = """<p><a href="/">Back to the picture</a></p>
</article>
</body>
</html>
"""


def inline(text):
    parts = re.split(r"`([^`]*)`", text)
    for k, part in enumerate(parts):
        part = html.escape(part, quote=False)
        if k % 2:
            parts[k] = f"<code>{part}</code>"
        else:
            part = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", part)
            parts[k] = re.sub(r"\*(.+?)\*", r"<em>\1</em>", part)
    return "".join(parts)


def table(lines):
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    head, body = rows[0], rows[2:]
    out = ["<table>"]
    if any(head):
        out.append("<tr>" + "".join(f"<th>{inline(cell)}</th>" for cell in head) + "</tr>")
    out += ["<tr>" + "".join(f"<td>{inline(cell)}</td>" for cell in row) + "</tr>" for row in body]
    return "\n".join(out + ["</table>"])


def block(lines):
    first = lines[0]
    if first.startswith("#"):
        level = len(first) - len(first.lstrip("#"))
        return f"<h{level}>{inline(first.lstrip('# '))}</h{level}>"
    if first.startswith("|"):
        return table(lines)
    if first.startswith("- "):
        items = re.split(r"^- ", "\n".join(lines), flags=re.M)[1:]
        return "<ul>\n" + "\n".join(f"<li>{inline(' '.join(item.split()))}</li>" for item in items) + "\n</ul>"
    return f"<p>{inline(' '.join(lines))}</p>"


def made(text):
    out = []
    for k, part in enumerate(re.split(r"^```\w*\n(.*?)^```\n", text, flags=re.M | re.S)):
        if k % 2:
            out.append(f"<pre>{html.escape(part.rstrip(), quote=False)}</pre>")
        else:
            out += [block(piece.splitlines()) for piece in re.split(r"\n\n+", part.strip()) if piece]
    return HEAD + "\n".join(out) + "\n" + TAIL


def main():
    text = made(SOURCE.read_text())
    if "--check" not in sys.argv[1:]:
        TARGET.write_text(text)
    elif TARGET.read_text() != text:
        sys.exit(f"{TARGET} is not what make_help.py makes of display.md; run: cmake --build --preset release --target generated")


if __name__ == "__main__":
    main()

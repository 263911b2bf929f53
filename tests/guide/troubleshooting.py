#!/usr/bin/env python3
"""client/guide/troubleshooting.md says what the programs say: each error number has an entry, each quoted message exists.

A message is quoted in backticks in the first column of a table; "..." stands for what differs from case to case.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDERS = ["client", "proto", "server", "terrain"]


def spoken():
    """All texts of the sources, strings that are split over lines put together."""
    parts = []
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in (".cpp", ".h", ".py"):
                continue
            text = path.read_text(encoding="utf-8")
            text = re.sub(r'"\s*\n?\s*f?"', "", text)  # of neighbours
            # Numbers and names that are put in stand between the words.
            parts.append(text.replace('\\"', '"'))
    return "\n".join(parts)


def main():
    page = (ROOT / "client" / "guide" / "troubleshooting.md").read_text()
    protocol = (ROOT / "proto" / "PROTOCOL.md").read_text()
    faults = []
    wanted = re.findall(r"^\| (\d+) \| ", protocol.split("## Errors")[1], re.M)
    told = re.findall(r"^\| (\d+) \| ", page, re.M)
    if len(wanted) < 20 or told != wanted:
        faults.append(f"error numbers: found {told}; PROTOCOL.md has {wanted}")
    words = spoken()
    quoted = re.findall(r"^\| `([^`]+)` \|", page, re.M)
    if len(quoted) < 20:
        faults.append(f"found {len(quoted)} quoted messages; allowed: 20 and more")
    for message in quoted:
        for piece in filter(None, (part.strip() for part in message.split("..."))):
            if piece not in words:
                faults.append(f'"{message}": the sources do not say "{piece}"')
    if faults:
        sys.exit("\n".join(faults))
    print(f"{len(told)} error numbers, {len(quoted)} messages")


if __name__ == "__main__":
    main()

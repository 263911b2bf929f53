#!/usr/bin/env python3
"""How many tests were skipped, and what they lack: from what ctest --output-junit wrote.

  tests/skipped.py FILE.xml
"""
import collections
import re
import sys
import xml.etree.ElementTree


def reason(output):
    """GoogleTest's message after "FILE:LINE: Skipped", or a script's line "skipped: ...", or its last words."""
    match = re.search(r"\.(?:cpp|h):\d+: Skipped\n(.+)", output) or re.search(r"^skipped: (.+)", output, re.MULTILINE)
    lines = output.strip().splitlines()
    return match[1].strip() if match else lines[-1].strip() if lines else "it does not say why"


def main(path):
    skipped = collections.defaultdict(list)
    for case in xml.etree.ElementTree.parse(path).iter("testcase"):
        if case.get("status") == "notrun":
            skipped[reason(case.findtext("system-out") or "")].append(case.get("name"))
    count = sum(map(len, skipped.values()))
    print(f"{count} test{'' if count == 1 else 's'} skipped" + (":" if count else ""))
    for why, names in sorted(skipped.items(), key=lambda each: -len(each[1])):
        print(f"  {len(names)}: {why[:200]} ({names[0].split('  #')[0]}{', ...' if len(names) > 1 else ''})")


if __name__ == "__main__":
    main(sys.argv[1]) if len(sys.argv) == 2 else sys.exit(__doc__)

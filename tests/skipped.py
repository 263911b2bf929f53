#!/usr/bin/env python3
"""How many tests were skipped, and what they lack: from what ctest --output-junit wrote.

  tests/skipped.py FILE.xml
"""
import collections
import re
import sys
import xml.etree.ElementTree


# What GoogleTest writes of a test that is skipped, in a suite whose others may have passed: why, and its name.
IN_SUITE = re.compile(r"\.(?:cpp|h):\d+: Skipped\n(.*)(?:\n(?!\[).*)*\n\[  SKIPPED \] (\S+)")


def reason(output):
    """A script's line "skipped: ...", or its last words."""
    match = re.search(r"^skipped: (.+)", output, re.MULTILINE)
    lines = output.strip().splitlines()
    return match[1].strip() if match else lines[-1].strip() if lines else "it does not say why"


def main(path):
    skipped = collections.defaultdict(list)
    for case in xml.etree.ElementTree.parse(path).iter("testcase"):
        output = case.findtext("system-out") or ""
        of_suite = IN_SUITE.findall(output)
        for why, name in of_suite:
            skipped[why.strip() or "it does not say why"].append(name.rstrip(","))
        if case.get("status") == "notrun" and not of_suite:
            skipped[reason(output)].append(case.get("name"))
    count = sum(map(len, skipped.values()))
    print(f"{count} test{'' if count == 1 else 's'} skipped" + (":" if count else ""))
    for why, names in sorted(skipped.items(), key=lambda each: -len(each[1])):
        print(f"  {len(names)}: {why[:200]} ({names[0].split('  #')[0]}{', ...' if len(names) > 1 else ''})")


if __name__ == "__main__":
    main(sys.argv[1]) if len(sys.argv) == 2 else sys.exit(__doc__)

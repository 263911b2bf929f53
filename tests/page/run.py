#!/usr/bin/python3
"""Runs the tests of a file or of one class in it: run.py NAME_test[.CLASS]. Exit code 77 where something that they need is missing."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import support  # noqa: E402


def main():
    lacking = support.missing()
    if lacking:
        print(f"skipped: {lacking} missing; deploy/install-deps.sh test installs it")
        return 77
    suite = unittest.defaultTestLoader.loadTestsFromName(sys.argv[1])
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    if result.testsRun == 0:
        print("no test ran")
        return 1
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())

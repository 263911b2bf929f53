#!/usr/bin/env python3
"""Runs the tests of a file or of one class in it: run.py NAME_test[.CLASS]. Exit code 77 where all of them were skipped, each with its reason."""
import importlib
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))


def main():
    try:
        importlib.import_module(sys.argv[1].split(".")[0])
    except ImportError as error:
        if error.name in ("numpy", "google", "google.protobuf") or "CRC-32C" in str(error):
            print(f"skipped: {error}; deploy/install-deps.sh test installs it")
            return 77
        raise
    suite = unittest.defaultTestLoader.loadTestsFromName(sys.argv[1])
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    if result.testsRun == 0:
        print("no test ran")
        return 1
    if not result.wasSuccessful():
        return 1
    return 77 if len(result.skipped) == result.testsRun else 0


if __name__ == "__main__":  # not where a worker imports this file
    sys.exit(main())

#!/usr/bin/env bash
# A rehearsal of an exercise: a DIS host flies two radars of one aircraft and a host of its own clock a third, with a pause, a
# reset, ten times the pace and back, while three stations turn knobs, two recordings run, an instructor sets bookmarks, and
# server and host are killed once.
#
#   tests/exercise.sh [--short] [--bin DIR]     ten minutes, or half a one; DIR: default build/release/bin
#
# Prints what it did, and fails when a pose or a setting was refused, when what was saved is not what is loaded, when the log
# done again gives other knobs, when a bookmark or a recording is missing, or (not --short; on a machine without other work)
# when a picture lags by more than 0.2 s.
set -euo pipefail
exec bash "$(dirname "${BASH_SOURCE[0]}")/python/run.sh" --program "$(dirname "${BASH_SOURCE[0]}")/exercise/rehearsal.py" "$@"

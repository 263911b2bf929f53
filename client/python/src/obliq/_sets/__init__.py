"""Data sets: jobs that render them, their files, parts and worlds, and how they are read."""

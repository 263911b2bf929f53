#!/usr/bin/env python3
"""A figure that is changed by hand, a marker that is gone, and figures that are too old are each found."""
import contextlib
import io
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import figures


class Documents(unittest.TestCase):
    def setUp(self):
        self.kept = {document: figures.load(document) for document in figures.KEPT}
        self.pages = {path: (figures.ROOT / path).read_text(encoding="utf-8") for path in figures.DOCUMENTS}

    def test_a_digit_changed_by_hand_is_found_in_every_block(self):
        for path, page in self.pages.items():
            for match in figures.BLOCK.finditer(page):
                text = match.group(2)
                for digit in ([*re.finditer(r"\d", text)] or [*re.finditer(r"[a-z]", text)])[::7]:
                    place = match.start(2) + digit.start()
                    other = page[:place] + ("0" if digit.group() != "0" else "1") + page[place + 1:]
                    with self.subTest(path=path, block=match.group(1), place=place):
                        self.assertTrue(figures.faults_of(path, other, self.kept))

    def test_a_block_without_its_marker_is_found(self):
        for path, page in self.pages.items():
            for name in figures.DOCUMENTS[path]:
                with self.subTest(path=path, block=name), self.assertRaisesRegex(SystemExit, "found the blocks"):
                    figures.faults_of(path, page.replace(f": {name}, written", f": {name}, once written"), self.kept)

    def test_a_table_beside_the_blocks_is_found(self):
        for path in figures.NO_OTHER_TABLES:
            self.assertTrue(figures.faults_of(path, self.pages[path] + "\n| scene | ms |\n|---|---|\n| hills | 12 |\n", self.kept))


@unittest.skipUnless(shutil.which("git"), "no git")
class Age(unittest.TestCase):
    """In a repository of its own, with one part whose figures are of its first commit."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        root = pathlib.Path(self.folder.name)
        for name, value in (("ROOT", root), ("KEPT", {"speed": root / "speed.json"}), ("PARTS", {"speed": [figures.PARTS["speed"][0]]})):
            self.addCleanup(setattr, figures, name, getattr(figures, name))
            setattr(figures, name, value)
        self.put("CMakeLists.txt", "project(obliq VERSION 0.3.1 LANGUAGES CXX)")
        self.put("speed.json", "{}")

    def put(self, name, text):
        path = figures.ROOT / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def git(self, *words):
        return subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b.example", *words], cwd=figures.ROOT, check=True,
                              capture_output=True, text=True).stdout.strip()

    def commit(self, name, text):
        self.put(name, text)
        self.git("add", "-A")
        self.git("commit", "-q", "-m", f"changes {name}")
        return self.git("rev-parse", "--short", "HEAD")

    def keep(self, commit, version="0.3.0"):
        self.put("speed.json", '{"qualities": {"where": {"version": "%s", "commit": "%s"}}}' % (version, commit))

    def released(self):
        """(exit code or words, what was printed)."""
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            try:
                figures.say_age(True)
            except SystemExit as end:
                return end.code, said.getvalue()
        return 0, said.getvalue()

    def test_figures_older_than_a_change_of_the_pipeline_are_refused(self):
        self.git("init", "-q")
        self.keep(self.commit("server/radar/render.cpp", "first"))
        self.commit("client/guide/guide.md", "of no account")
        self.assertEqual(self.released()[0], 0)
        for folder in figures.MEASURED:
            self.keep(self.git("rev-parse", "HEAD"))
            self.assertEqual(self.released()[0], 0)
            self.commit(f"{folder}/more.cpp", "changed")
            self.assertIn(f"changes {folder}/more.cpp", self.released()[0])
        self.keep("0123456")
        self.assertIn("not in this history", self.released()[0])
        self.keep(self.git("rev-parse", "HEAD") + "-changed")  # measured before it was committed
        self.assertIn("not in this history", self.released()[0])

    def test_figures_of_another_minor_version_are_refused(self):
        self.git("init", "-q")
        commit = self.commit("server/radar/render.cpp", "first")
        self.keep(commit, "0.2.9")
        self.assertIn("of version 0.2.9, not 0.3.1; allowed: version 0.3.1", self.released()[0])
        self.keep(commit, "0.3.9")
        self.assertEqual(self.released()[0], 0)

    def test_without_history_that_is_said(self):
        code, said = self.released()
        self.assertEqual(code, True)
        self.assertIn("no git history", said)


if __name__ == "__main__":
    unittest.main()

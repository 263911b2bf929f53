"""Types and style of the Python package, by mypy and ruff in an environment of their own; skipped where the registry does not
answer. And what needs neither: docstrings on all that is public. Import circles: tests/structure.py."""
import inspect
import pathlib
import subprocess
import sys
import unittest

import support
from support import BIN, obliq

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = support.ROOT / "client" / "python"
SOURCES = PACKAGE / "src" / "obliq"


def environment():
    """The folder of programs, made once; None where the registry does not answer."""
    wanted = (HERE / "types_requirements.txt").read_text()
    folder = BIN.parent / "python_types"
    kept = folder / "installed"
    if not kept.exists() or kept.read_text() != wanted:
        for words in ([sys.executable, "-m", "venv", "--clear", str(folder)],
                      [str(folder / "bin" / "python"), "-m", "pip", "install", "-q", "--disable-pip-version-check", "-r",
                       str(HERE / "types_requirements.txt")]):
            if subprocess.run(words, capture_output=True, check=False).returncode != 0:
                return None
        kept.write_text(wanted)
    return folder / "bin"


class Checked(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.programs = environment()
        if cls.programs is None:
            raise unittest.SkipTest("mypy and ruff are not here, and the package registry does not answer")

    def assert_clean(self, *words):
        done = subprocess.run([str(self.programs / words[0]), *map(str, words[1:])], capture_output=True, text=True, check=False,
                              cwd=PACKAGE / "src")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_package_is_typed_and_so_is_what_uses_it(self):
        self.assert_clean("mypy", "--config-file", PACKAGE / "pyproject.toml", "--strict", "--cache-dir",
                          self.programs.parent / "mypy_cache", "obliq", HERE / "typed_user.py")

    def test_the_package_and_its_examples_are_in_good_style(self):
        self.assert_clean("ruff", "check", "--no-cache", "--config", PACKAGE / "pyproject.toml", SOURCES, PACKAGE / "examples")


class Read(unittest.TestCase):
    def test_all_that_is_public_has_a_docstring(self):
        def lacking(thing, name):
            if not inspect.getdoc(thing):
                yield name
            if inspect.isclass(thing) and thing.__module__.startswith("obliq"):
                for key, member in vars(thing).items():
                    if not key.startswith("_") and (callable(member) or isinstance(member, (property, staticmethod, classmethod))):
                        yield from lacking(getattr(member, "__func__", member), f"{name}.{key}")

        found = []
        for module in (obliq, obliq.aio, obliq.errors):
            for name in getattr(module, "__all__", [name for name in vars(module) if not name.startswith("_")]):
                thing = getattr(module, name)
                if (inspect.isclass(thing) or callable(thing)) and getattr(thing, "__module__", "").startswith("obliq"):
                    found += lacking(thing, f"{module.__name__}.{name}")
        self.assertEqual(found, [])

    def test_help_tells_what_each_setting_means(self):
        for kind in (obliq.Settings, obliq.Pose):
            for name in kind.names():
                self.assertRegex(kind.__doc__, rf"(?m)^    {name}: \w.+")

    def test_every_public_name_is_there(self):
        for name in obliq.__all__:
            self.assertTrue(hasattr(obliq, name), name)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""Checks the page's types with TypeScript's compiler, by the types of messages that are made from obliq.proto.

  types.py             the page as it is
  types.py --planted   mistakes that it must find

The compiler is $OBLIQ_TSC, or that which deploy/install-deps.sh test puts into build/typescript. Exit code 77 without one.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HTTP = ROOT / "server" / "http"
# Each is a module of the page, and what the compiler says of it.
PLANTED = {
    "a field that the message has not": ('link.ask("SetState", { radr: "main" });', "'radr' does not exist"),
    "an enumerator that is none": ('link.ask("ClaimControl", { kinds: ["POSE"] });', "'\"POSE\"' is not assignable to type 'ClaimKind'"),
    "a message that is none": ('link.ask("GetRadars");', "'\"GetRadars\"' is not assignable"),
    "a field of another answer": ('link.ask("GetStatus").then(({ settings }) => settings);', "Property 'settings' does not exist on type 'Status'"),
    "64 bits as a number": ('link.on("FrameBegin", ({ body }) => Math.max(body.request_id));', "'string' is not assignable to parameter of type 'number'"),
    "a value without a type": ("export function open(door) { return door; }", "implicitly has an 'any' type"),
    "an event that nobody says": ('link.on("news", () => {});', "'\"news\"' is not assignable"),
}


def compiler():
    """The command; nothing: there is none here."""
    given = os.environ.get("OBLIQ_TSC")
    if given:
        return [given]
    installed = ROOT / "build" / "typescript" / "node_modules" / "typescript" / "bin" / "tsc"
    node = shutil.which("node")
    return [node, str(installed)] if node and installed.exists() else None


def faults(folder):
    """What the compiler complains of, a line each."""
    done = subprocess.run([*compiler(), "--project", str(folder / "tsconfig.json"), "--pretty", "false"], capture_output=True, text=True, cwd=folder)
    if done.returncode == 0:
        return ""
    return done.stdout + done.stderr or f"exit code {done.returncode}"


def check_planted():
    """The mistakes that are not found as they should be, in words."""
    missed = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copytree(HTTP / "page", folder / "page")
        for file in ("wire.d.ts", "tsconfig.json"):
            shutil.copy(HTTP / file, folder)
        for k, (code, _) in enumerate(PLANTED.values()):
            (folder / "page" / f"planted_{k}.js").write_text(f'import {{ Link }} from "./stream.js";\nexport const link = new Link();\n{code}\n')
        found = faults(folder).splitlines()
        for k, (what, (_, said)) in enumerate(PLANTED.items()):
            own = [line for line in found if line.startswith(f"page/planted_{k}.js")]
            if not any(said in line for line in own):
                missed.append(f"{what}: not found; the compiler says {own}")
        missed += [line for line in found if line[:1].strip() and not line.startswith("page/planted_")]
    return missed


def main():
    if not compiler():
        print("skipped: no node with TypeScript in build/typescript; deploy/install-deps.sh test installs it where npm is")
        return 77
    if "--planted" in sys.argv[1:]:
        missed = check_planted()
        print("\n".join(missed) or f"{len(PLANTED)} planted mistakes were found")
        return 1 if missed else 0
    found = faults(HTTP)
    print(found or "the page's types fit")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

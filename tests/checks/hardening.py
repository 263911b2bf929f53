#!/usr/bin/env python3
"""Programs and libraries are built as CMakeLists.txt (OBLIQ_HARDENING) says: read off the files with readelf.

  hardening.py FILE...      each fault as a line "FILE: found X; allowed: Y"
  hardening.py --self-test  what is compiled without each of the flags is found

-fstack-clash-protection leaves no mark that could be read. The linker keeps the IBT and SHSTK notes only where every object
has them, and Debian's start files have not: what is read is the landing pads (endbr64) themselves.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

LANDING_PAD = bytes.fromhex("f30f1efa")  # endbr64
LEAST_PADS = 20  # a program without -fcf-protection has those of the compiler's own library: fewer than ten


def readelf(*arguments):
    return subprocess.run(["readelf", "-W", *arguments], stdout=subprocess.PIPE, text=True, check=True).stdout


def faults(file):
    dynamic, segments, symbols = readelf("-d", file), readelf("-lh", file), readelf("--dyn-syms", file)

    def unless(fine, found, allowed):
        return [] if fine else [f"{file}: found {found}; allowed: {allowed}"]

    imported = set(re.findall(r" UND (\w+)", symbols))
    stack = re.search(r"GNU_STACK(?: +0x\w+){5} (.{3})", segments)
    found = unless(re.search(r"Type:\s+DYN", segments), "a fixed address", "-fPIE -pie, -shared")
    found += unless("GNU_RELRO" in segments, "no RELRO", "-z relro")
    found += unless(re.search(r"\((FLAGS|BIND_NOW)\).*BIND_NOW|FLAGS_1.*\bNOW\b", dynamic), "symbols bound late", "-z now")
    found += unless(stack and "E" not in stack[1], "an executable stack", "-z noexecstack")
    found += unless("__stack_chk_fail" in imported, "no stack protector", "-fstack-protector-strong")
    found += unless(any(re.fullmatch(r"__\w+_chk", name) for name in imported), "no checked libc call", "-D_FORTIFY_SOURCE=2")
    if "X86-64" in segments:
        pads = pathlib.Path(file).read_bytes().count(LANDING_PAD)
        found += unless(pads >= LEAST_PADS, f"{pads} landing pads", f"{LEAST_PADS} or more, -fcf-protection=full")
    return found


def self_test():
    functions = "".join(f"int f{k}(int x) {{ return x + {k}; }}\n" for k in range(2 * LEAST_PADS))
    program = functions + '''#include <cstdio>
#include <cstring>
int main(int argc, char** argv) {
  char text[16];
  std::strcpy(text, argv[argc - 1]);
  std::puts(text);
}
'''
    hardened = ["-D_FORTIFY_SOURCE=2", "-fstack-protector-strong", "-fcf-protection=full", "-fPIE", "-pie", "-Wl,-z,relro,-z,now"]
    without = {"a fixed address": ["-fno-pie", "-no-pie"], "no RELRO": ["-Wl,-z,norelro"], "symbols bound late": ["-Wl,-z,lazy"],
               "an executable stack": ["-Wl,-z,execstack"], "no stack protector": ["-fno-stack-protector"],
               "no checked libc call": ["-U_FORTIFY_SOURCE"], "landing pads": ["-fcf-protection=none"]}
    with tempfile.TemporaryDirectory() as folder:
        source, built = pathlib.Path(folder, "a.cpp"), pathlib.Path(folder, "a")
        source.write_text(program, encoding="utf-8")
        for expected, flags in {"": [], **without}.items():
            subprocess.run(["g++", "-O2", *hardened, *flags, str(source), "-o", str(built)], check=True)
            found = faults(str(built))
            right = expected in found[0] if len(found) == 1 else not found and not expected
            if not right:
                sys.exit(f"with {flags}: found {found}; allowed: {expected or 'none'}")
    print(f"{len(without)} kinds of fault are found, and none in what is hardened")


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        self_test()
    else:
        files = sys.argv[1:] or sys.exit(__doc__)
        all_faults = [fault for file in files for fault in faults(file)]
        print("\n".join(all_faults) or f"{len(files)} files are hardened")
        sys.exit(bool(all_faults))

#!/usr/bin/env python3
"""The libraries that programs are linked with, down to the last, as SPDX 2.3 (JSON): Debian's packages with their versions.

  deploy/sbom.py VERSION PROGRAM... >obliq.spdx.json
  deploy/sbom.py --check PROGRAM...     THIRD_PARTY.md has a row for each library that the programs name, and none for another;
                                        its licence is that of Debian's copyright file

Licences are those of THIRD_PARTY.md; of what those libraries need in turn, /usr/share/doc/PACKAGE/copyright tells.
SOURCE_DATE_EPOCH, where it is set, is the document's time. Without dpkg, files stand for packages.
"""
import datetime
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

TABLE = pathlib.Path(__file__).resolve().parent.parent / "THIRD_PARTY.md"
# What copyright files (DEP-5) spell otherwise than SPDX.
SPDX = {"expat": "MIT", "expat with embedded exception": "MIT", "bsd-3-clause~google": "BSD-3-Clause", "bsd-3-clause": "BSD-3-Clause",
        "bsd-2-clause": "BSD-2-Clause", "lgpl-2.1+": "LGPL-2.1-or-later", "libpng": "libpng-2.0", "openexr": "BSD-3-Clause",
        "bsd-3-clause or gpl-2": "BSD-3-Clause OR GPL-2.0-only"}


def output(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False).stdout


def rows():
    """{library without its number: licence}, of the rows that name libraries."""
    table = {}
    for licence, libraries in re.findall(r"^\|[^|]+\| ([^|]+) \| ([^|]+) \|", TABLE.read_text(encoding="utf-8"), re.MULTILINE):
        table.update({name: licence for name in re.findall(r"`(.+?)`", libraries)})
    return table


def row_of(table, soname):
    """libpng for libpng16.so.16; None where no row has it."""
    if soname.startswith("ld-linux"):  # the loader, which the C library brings
        soname = "libc.so.6"
    return next((name for name in table if re.fullmatch(re.escape(name) + r"[-\d_.]*\.so[\d.]*", soname)), None)


def linked(programs):
    """{soname: file} of all that the loader maps, and {file: the sonames that it names}."""
    where = {}
    for program in programs:
        where.update(re.findall(r"^\s*(\S+) => (/\S+)", output("ldd", program), re.MULTILINE))
    names = {file: re.findall(r"\(NEEDED\).*\[(.+)\]", output("readelf", "-dW", file)) for file in [*programs, *where.values()]}
    return where, names


def spellings(file):
    """dpkg knows a library with or without /usr before its path."""
    path = re.sub("^/usr", "", os.path.realpath(file))
    return [path, "/usr" + path]


def packages_of(files):
    """{file: (package, version)}"""
    owners, versions = {}, {}
    if shutil.which("dpkg-query"):
        asked = [spelling for file in files for spelling in spellings(file)]
        owners = {path: name for name, path in re.findall(r"^([^\s:]+).*: (\S+)$", output("dpkg-query", "-S", *asked), re.MULTILINE)}
        versions = dict(line.split() for line in output("dpkg-query", "-W", "-f", "${Package} ${Version}\n", *set(owners.values())).splitlines())
    found = {}
    for file in files:
        owner = next((owners[spelling] for spelling in spellings(file) if spelling in owners), pathlib.Path(file).name)
        found[file] = (owner, versions.get(owner))
    return found


def copyright_licence(package):
    """Of a copyright file's `Files: *`, in SPDX's words; None where it is written otherwise."""
    file = pathlib.Path("/usr/share/doc", package, "copyright")
    text = file.read_text(encoding="utf-8", errors="replace") if file.exists() else ""
    match = re.search(r"^Files: *\*\s*\n(?:(?!\n\n).)*?^License: *(\S.*?) *$", text, re.MULTILINE | re.DOTALL)
    return SPDX.get(match[1].lower(), match[1]) if match else None


def document(version, programs):
    table, (where, names) = rows(), linked(programs)
    package_of = packages_of(list(where.values()))
    packages, edges = {}, set()
    for soname, file in where.items():
        name, number = package_of[file]
        row = row_of(table, soname)
        entry = packages.setdefault(name, {"licence": set(), "version": number})
        entry["licence"] |= {table[row]} if row else set()
    for file, sonames in names.items():
        user = package_of[file][0] if file in package_of else "obliq"
        edges |= {(user, package_of[where[soname]][0]) for soname in sonames if soname in where}

    def reference(name):
        return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)

    def package(name, number, licence):
        found = {"SPDXID": reference(name), "name": name, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
                 "licenseConcluded": "NOASSERTION", "licenseDeclared": licence, "copyrightText": "NOASSERTION"}
        if number:
            found["versionInfo"] = number
        if number and name != "obliq":
            found["supplier"] = "Organization: Debian"
            found["externalRefs"] = [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                      "referenceLocator": f"pkg:deb/debian/{name}@{number.replace('+', '%2B').replace(':', '%3A')}"}]
        return found

    listed = [package("obliq", version, "Apache-2.0")]
    for name, entry in sorted(packages.items()):
        parts = sorted(entry["licence"])
        listed.append(package(name, entry["version"], " AND ".join(f"({part})" if len(parts) > 1 and " OR " in part else part for part in parts)
                              or "NOASSERTION"))
    relationships = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-obliq"}]
    relationships += [{"spdxElementId": reference(a), "relationshipType": "DYNAMIC_LINK" if a == "obliq" else "DEPENDS_ON",
                       "relatedSpdxElement": reference(b)} for a, b in sorted(edges) if a != b]
    digest = hashlib.sha256(json.dumps([listed, relationships]).encode()).hexdigest()[:16]
    when = os.environ.get("SOURCE_DATE_EPOCH")
    when = datetime.datetime.fromtimestamp(int(when), datetime.timezone.utc) if when else datetime.datetime.now(datetime.timezone.utc)
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"obliq-{version}",
            "documentNamespace": f"https://spdx.org/spdxdocs/obliq-{version.replace('+', '-')}-{digest}",
            "creationInfo": {"created": when.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: obliq-sbom"]},
            "packages": listed, "relationships": relationships}


def check(programs):
    table, (where, names) = rows(), linked(programs)
    direct = sorted({soname for program in programs for soname in names[program]})
    faults = [f"THIRD_PARTY.md has no row for {soname}" for soname in direct if row_of(table, soname) is None]
    used = {row_of(table, soname) for soname in where}
    faults += [f"THIRD_PARTY.md has a row for {name}, with which nothing is linked" for name in table if name not in used]
    compared = 0
    package_of = packages_of([where[soname] for soname in direct if soname in where])
    for soname in direct:
        row = row_of(table, soname)
        theirs = copyright_licence(package_of[where[soname]][0]) if soname in where else None
        if row is None or theirs is None:
            continue
        compared += 1
        if theirs != table[row]:
            faults.append(f"THIRD_PARTY.md, {row}: found {table[row]}; allowed: {theirs} (/usr/share/doc/{package_of[where[soname]][0]}/copyright)")
    print("\n".join(faults) or f"{len(direct)} libraries have a row; {compared} licences are those of Debian's copyright files")
    return bool(faults) or not compared and shutil.which("dpkg-query") is not None


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    if sys.argv[1] == "--check":
        sys.exit(check(sys.argv[2:]))
    json.dump(document(sys.argv[1], sys.argv[2:]), sys.stdout, indent=1)
    print()

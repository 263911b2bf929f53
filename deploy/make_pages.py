#!/usr/bin/env python3
"""Man pages, and completion for bash and zsh, from server/apps/COMMANDS.md, which is what the programs' own --help says.

  deploy/make_pages.py VERSION OUT        writes OUT/man/*.1, OUT/bash/obliq, OUT/bash/obliqd, OUT/zsh/_obliq, OUT/zsh/_obliqd
"""
import pathlib
import re
import sys

COMMANDS = pathlib.Path(__file__).resolve().parent.parent / "server/apps/COMMANDS.md"
LINE = re.compile(r"^  (-\S+|[A-Z][A-Z_]*)( [^ ].*?)?(?:\s{2,}(.*))?$")


class Page:
    """One section of COMMANDS.md: what it is for, its usage, and rows of (flag or argument, value, sentence) by heading."""

    def __init__(self, name, text):
        self.name = name
        about, _, rest = text.partition("\nUsage: ")
        self.about = about.strip()
        self.usage, _, rest = rest.partition("\n")
        self.parts, self.other = [], []
        for line in rest.splitlines():
            if re.match(r"^\w[\w -]*:$", line):
                self.parts.append((line[:-1], []))
            elif self.parts and (found := LINE.match(line)):
                self.parts[-1][1].append((found[1], (found[2] or "").strip(), found[3] or ""))
            elif self.parts and line.startswith("     ") and self.parts[-1][1]:
                flag, value, said = self.parts[-1][1].pop()
                self.parts[-1][1].append((flag, value, f"{said} {line.strip()}".strip()))
            elif line.strip():
                self.other.append(line.strip())

    def options(self):
        return [(flag.split(","), value, said) for _, rows in self.parts for flag, value, said in rows if flag.startswith("-")]


def roff(text):
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return r"\&" + text if text.startswith((".", "'")) else text


def man(page, names, version):
    title = page.name.replace(" ", "-")
    first = re.split(r"[.;:] ", page.about)[0].rstrip(".")
    lines = [f'.TH {title.upper()} 1 "" "obliq {version}" "User Commands"', ".SH NAME", f"{roff(title)} \\- {roff(first)}",
             ".SH SYNOPSIS", roff(page.usage), ".SH DESCRIPTION", roff(page.about)]
    for heading, rows in page.parts:
        lines += [f'.SH "{heading.upper()}"']
        for flag, value, said in rows:
            lines += [".TP", rf"\fB{roff(flag)}\fR {roff(value)}".rstrip(), roff(said or " ")]
    lines += ["." + "PP\n" + roff(line) for line in page.other]
    others = [f"\\fB{roff(name)}\\fR(1)" for name in names if name != title]
    return "\n".join([*lines, '.SH "SEE ALSO"', ",\n".join(others), ".PP", "The documents in /usr/share/doc/obliq."]) + "\n"


def overview(pages):
    about = "Radar ground maps of real terrain: azimuth x range bins of complex I&Q, and pictures of them."
    page = Page("obliq", f"{about}\nUsage: obliq COMMAND [OPTIONS]\n")
    page.parts = [("Options", [("-h,--help", "", "Print a help message and exit"), ("--version", "", "Print the version and exit")]),
                  ("Commands", [(p.name.split()[1], "", p.about) for p in pages if " " in p.name])]
    return page


BASH = """# Written by deploy/make_pages.py.
_obliq() {
  local word=${COMP_WORDS[COMP_CWORD]} options=
  case "${COMP_WORDS[1]-}" in
CASES
  esac
  if [[ $COMP_CWORD -eq 1 ]]; then options="COMMANDS --help --version"; fi
  mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
}
complete -o default -F _obliq obliq
"""


def words(page):
    return " ".join(flag for flags, _, _ in page.options() for flag in flags)


def zsh_row(flags, value, said):
    said = re.sub(r"['\[\]:\\]", "", said)
    names = " ".join(flags)
    every = f"({names})'{{{','.join(flags)}}}'" if len(flags) > 1 else flags[0]
    return f"    '{every}[{said}]{':value:_files' if value else ''}'"


def main():
    version, out = sys.argv[1], pathlib.Path(sys.argv[2])
    sections = re.findall(r"^## ([^\n]*)\n\n```text\n(.*?)\n```", COMMANDS.read_text(encoding="utf-8"), re.M | re.S)
    pages = [Page(name, text) for name, text in sections]
    commands = [page for page in pages if " " in page.name]
    names = ["obliq", *(page.name.replace(" ", "-") for page in pages)]
    for folder in ("man", "bash", "zsh"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    for page in [overview(pages), *pages]:
        (out / "man" / f"{page.name.replace(' ', '-')}.1").write_text(man(page, names, version), encoding="utf-8")
    cases = "\n".join(f'    {page.name.split()[1]}) options="{words(page)}" ;;' for page in commands)
    listed = " ".join(page.name.split()[1] for page in commands)
    (out / "bash/obliq").write_text(BASH.replace("CASES", cases).replace("COMMANDS", listed))
    daemon = next(page for page in pages if page.name == "obliqd")
    (out / "bash/obliqd").write_text(f'# Written by deploy/make_pages.py.\ncomplete -o default -W "{words(daemon)}" obliqd\n')
    described = "\n".join("    '" + page.name.split()[1] + ":" + re.sub(r"['\\]", "", page.about.split(". ")[0]) + "'" for page in commands)
    cases = "\n".join(f"  {page.name.split()[1]})\n    _arguments -s \\\n" + " \\\n".join(zsh_row(*row) for row in page.options())
                      + " \\\n    '*:file:_files' ;;" for page in commands)
    (out / "zsh/_obliq").write_text("#compdef obliq\n# Written by deploy/make_pages.py.\nlocal -a commands\nif (( CURRENT == 2 )); then\n"
                                    f"  commands=(\n{described}\n  )\n  _describe command commands\n  return\nfi\n"
                                    f"local command=$words[2]\nshift words\n(( CURRENT-- ))\ncase $command in\n{cases}\nesac\n")
    (out / "zsh/_obliqd").write_text("#compdef obliqd\n# Written by deploy/make_pages.py.\n_arguments -s \\\n"
                                     + " \\\n".join(zsh_row(*row) for row in daemon.options()) + " \\\n  '*:file:_files'\n")


if __name__ == "__main__":
    main()

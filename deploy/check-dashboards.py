#!/usr/bin/env python3
"""Checks that every metric which the dashboards, the alerts and their legends name is one that obliqd shows, and that each alert
has a severity and a section of RUNBOOK.md.

  curl -s http://127.0.0.1:7480/metrics | deploy/check-dashboards.py -    a running daemon's
  deploy/check-dashboards.py server/http/METRICS.md                        or their list

Prints what is named and not shown, and what is shown and nowhere on a dashboard; exit code 1 for the former.
"""
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
NOT_OURS = {"up"}  # the collector's own, as the labels below
COLLECTORS_LABELS = {"job", "instance"}
OURS = re.compile(r"\b(?:obliq|process|up)(?:_[a-z0-9_]+)?\b(?!\s*=)")


def shown(text):
    """Names of series in Prometheus' text format, and the labels that each has."""
    labels = {}
    for line in text.splitlines():
        match = re.match(r"([a-zA-Z_:][\w:]*)(?:\{(.*)\})? \S+", line)
        if match and not line.startswith("#"):
            labels.setdefault(match[1], set()).update(re.findall(r'(\w+)="', match[2] or ""))
    return labels


def listed(text):
    """The same from the table of METRICS.md."""
    labels = {}
    for names, kind, own_labels in re.findall(r"^\| (`[^|]*`) \| (\w+) \| ([^|]*)\|", text, re.MULTILINE):
        for name in re.findall(r"`(\w+)`", names):
            own = set(re.findall(r"`(\w+)`", own_labels))
            parts = {"_bucket": own | {"le"}, "_sum": own, "_count": own} if kind == "histogram" else {"": own}
            labels.update({name + part: with_part for part, with_part in parts.items()})
    return labels


def expressions():
    for path in sorted((HERE / "grafana/dashboards").glob("*.json")):
        board = json.loads(path.read_text(encoding="utf-8"))
        for variable in board["templating"]["list"]:
            yield f"{path.name}, variable {variable['name']}", variable["definition"]
        for panel in board["panels"]:
            for target in panel["targets"]:
                yield f"{path.name}, {panel['title']}", target["expr"]
    for number, line in enumerate((HERE / "prometheus/alerts.yml").read_text(encoding="utf-8").splitlines(), 1):
        if not re.match(r"\s*(-\s*alert|annotations|labels|summary|runbook_url|#|for|-?\s*name)", line):
            yield f"alerts.yml:{number}", line


def alert_faults(rules, runbook):
    """What an alert lacks to be routed and acted upon."""
    alerts = re.findall(r"- alert: (\w+)\n((?: {8}.*\n)+)", rules)
    faults = [f"alerts.yml, {name}: no severity: page or warning" for name, text in alerts
              if not re.search(r"^ *labels: {severity: (page|warning)}$", text, re.MULTILINE)]
    faults += [f"alerts.yml, {name}: no runbook_url that ends in RUNBOOK.md#{name.lower()}" for name, text in alerts
               if not re.search(rf"^ *runbook_url: \S+/RUNBOOK\.md#{name.lower()}$", text, re.MULTILINE)]
    names, sections = {name for name, _ in alerts}, set(re.findall(r"^## (\w+)$", runbook, re.MULTILINE))
    return faults + [f"{name}: in one of alerts.yml and RUNBOOK.md only" for name in sorted(names ^ sections)]


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    from_daemon = sys.argv[1] == "-"
    series = shown(sys.stdin.read()) if from_daemon else listed(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    named = set()
    faults = alert_faults(*((HERE / "prometheus" / name).read_text(encoding="utf-8") for name in ("alerts.yml", "RUNBOOK.md")))
    for where, expression in expressions():
        for match in OURS.finditer(re.sub(r'"[^"]*"', '""', expression)):
            name = match[0]
            named.add(name)
            if name in NOT_OURS:
                continue
            if name not in series:
                faults.append(f"{where}: no metric {name}")
                continue
            selector = re.match(r"\{([^}]*)\}", expression[expression.find(name) + len(name):])
            for label in re.findall(r"(\w+)\s*[=!]", selector[1] if selector else ""):
                if label not in series[name] | COLLECTORS_LABELS:
                    faults.append(f"{where}: {name} has no label {label}")
    nowhere = sorted(name for name in series if name not in named and not re.search(r"_(sum|count)$", name))
    print("\n".join(faults + [f"{len(named)} metrics named, {len(faults)} faults; obliqd's and on no dashboard: "
                              + (", ".join(nowhere) or "none")]))
    return 1 if faults or not series or not named else 0


if __name__ == "__main__":
    sys.exit(main())

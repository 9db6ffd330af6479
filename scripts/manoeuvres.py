#!/usr/bin/env python3
"""Writes docs/manoeuvres: a page with its plot for each manoeuvre that comes with ragtop, from `ragtop drive`.

    scripts/manoeuvres.py [car]

Runs build/release/ragtop on the hatchback, or the car that is named, at every level that the manoeuvre allows.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

TREE = Path(__file__).resolve().parent.parent
LEVELS = ["bicycle", "rays", "full"]
TOOL, PAGES = TREE / "build/release/ragtop", TREE / "docs/manoeuvres"


def withoutComments(text):
    return "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("//"))


def drive(car, name, level, folder):
    """Rows of values, and the plot."""
    rows, plot = folder / "rows.json", folder / "plot.svg"
    command = [TOOL, "drive", car, "--manoeuvre", name, "--level", str(level), "--json", rows, "--svg", plot]
    result = subprocess.run(command, capture_output=True, text=True, cwd=TREE)
    if result.returncode > 1:
        sys.exit(f"{name}: {result.stderr.strip()}")
    return json.loads(rows.read_text()), plot.read_text()


def figure(value):
    return f"{value:.5g}"


def tableRow(row):
    reference = figure(row["reference"]) if row.get("reference") is not None else ""
    error = f"{100 * row['error']:+.2f} %" if row.get("error") is not None else ""
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    cells = [row["level"], row["name"], figure(row["value"]) + unit, reference, error,
             "yes" if row["pass"] else "**no**"]
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def page(car, name, text, rows):
    plain = json.loads(withoutComments(text))
    return f"""# {name}

Written by `scripts/manoeuvres.py`: a {car}, 60 Hz. {plain["description"].capitalize()}.

```
ragtop drive {car} --manoeuvre {name} --svg {name}.svg
```

![{", ".join(plain["plot"])} over time]({name}.svg)

| Level | Value | Measured | Reference | Off | Passes |
|---|---|---|---|---|---|
{chr(10).join(tableRow(row) for row in rows)}

The manoeuvre ([what its words mean](../drive.md#a-manoeuvre-of-ones-own)):

```
{text.strip()}
```
"""


def main():
    car = sys.argv[1] if len(sys.argv) > 1 else "hatchback"
    PAGES.mkdir(exist_ok=True)
    names = []
    for source in sorted((TREE / "assets/data/manoeuvres").glob("*.json")):
        name, text = source.stem, source.read_text()
        least = json.loads(withoutComments(text)).get("leastLevel", "full")
        rows = []
        with tempfile.TemporaryDirectory() as folder:
            for level in range(LEVELS.index(least), 3):
                values, plot = drive(car, name, level, Path(folder))
                rows += values
        (PAGES / f"{name}.svg").write_text(plot)
        (PAGES / f"{name}.md").write_text(page(car, name, text, rows))
        names.append(name)
    links = "\n".join(f"- [{name}]({name}.md)" for name in names)
    (PAGES / "README.md").write_text(f"# Manoeuvres\n\nWhat [`ragtop drive`](../drive.md) measures.\n\n{links}\n")


main()

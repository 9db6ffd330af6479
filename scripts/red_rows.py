#!/usr/bin/env python3
"""Writes docs/measurements/red_rows.md and its picture: what each red row of the stability suite does as the step shrinks.

    scripts/red_rows.py [rows.json]

Needs python3-matplotlib. Runs build/release/ragtop_bench stability --red at each of RATES, a quarter of an hour, or reads
what such a run has written with --json.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

TREE = Path(__file__).resolve().parent.parent
BENCH, PAGE, PICTURE = (TREE / "build/release/ragtop_bench", TREE / "docs/measurements/red_rows.md",
                        TREE / "docs/measurements/red_rows.svg")
RATES = [30, 60, 120, 240, 480]
COLUMNS = 4


def run(rows):
    command = [BENCH, "stability", "--red", "--rates", ",".join(map(str, RATES)), "--json", rows, "--jobs", "2"]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode > 1 or not rows.exists():
        sys.exit(result.stderr.strip())


def read(rows):
    """{family/row: {rate: row}} of all rows of the cases."""
    curves = {}
    for row in json.loads(rows.read_text()):
        name, rate = f"{row['family']}/{row['case']}", 60
        for each in RATES:
            mark = f" @ 1/{each} s"
            if mark in name:
                name, rate = name.replace(mark, ""), each
        curves.setdefault(name, {})[rate] = row
    return curves


def measure():
    if len(sys.argv) > 1:
        return read(Path(sys.argv[1]))
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder) / "rows.json"
        run(rows)
        return read(rows)


def redNames():
    text = (TREE / "bench/stability/red_rows.h").read_text()
    block = text[text.index("kRedRows[]"):text.index("};", text.index("kRedRows[]"))]
    return [line.split('"')[1] for line in block.splitlines() if '"' in line]


def off(row):
    """How far a row is from where it should be; None where it is nowhere."""
    return None if row["value"] is None else abs(row["value"] - row["reference"])


def figure(value):
    return "nowhere" if value is None else f"{value:.3g}"


def table(names, curves):
    lines = ["| Row | Unit | Bound | " + " | ".join(f"1/{rate} s" for rate in RATES) + " |",
             "|---|---|---|" + "---|" * len(RATES)]
    for name in names:
        at = curves[name]
        cells = [name, at[60]["unit"], figure(at[60]["bound"])] + [figure(off(at[rate])) for rate in RATES]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def draw(names, curves):
    plt.rcParams.update({"font.size": 6, "svg.hashsalt": "ragtop", "svg.fonttype": "none"})
    rows = -(-len(names) // COLUMNS)
    figureOfAll, axes = plt.subplots(rows, COLUMNS, figsize=(11, 1.5 * rows), sharex=True, squeeze=False)
    for axis in axes.flat[len(names):]:
        axis.set_axis_off()
    for name, axis in zip(names, axes.flat):
        at = curves[name]
        points = [(1000 / rate, off(at[rate])) for rate in RATES if off(at[rate]) is not None]
        axis.plot(*zip(*points), "o-", markersize=2.5, linewidth=0.8)
        axis.axhline(at[60]["bound"], color="tab:red", linewidth=0.8, linestyle="--")
        axis.set_xscale("log")
        axis.set_ylim(0, 1.1 * max(at[60]["bound"], *(y for _, y in points)))
        family, rest = name.split("/", 1)
        axis.set_title(f"{family}: " + rest.replace(": ", "\n", 1) + f", {at[60]['unit']}", fontsize=5)
        axis.set_xticks([1000 / rate for rate in RATES], [f"{1000 / rate:.0f}" for rate in RATES])
        axis.minorticks_off()
    figureOfAll.supxlabel("step, ms")
    figureOfAll.tight_layout()
    figureOfAll.savefig(PICTURE, metadata={"Date": None})


def main():
    names, curves = redNames(), measure()
    gone = [name for name in names if name not in curves]
    if gone:
        sys.exit("not measured: " + ", ".join(gone))
    draw(names, curves)
    PAGE.write_text(f"""# Red rows by the step

Written by `scripts/red_rows.py`: how far each row that is known to fail ([why](../stability.md#what-falls-short)) is from
its reference, at steps of 1/30 to 1/480 s. The bound is that of 1/60 s.

![How far each red row is off over the step, with its bound](red_rows.svg)

{table(names, curves)}
""")


if __name__ == "__main__":
    main()

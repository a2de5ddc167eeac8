#!/usr/bin/env python3
"""kinds_table.py BENCH.json TABLE.md PLOT.svg: castray beside its plain paths and the peers, one row a scene, worst first.

Efficiency is 1 / (relMSE x seconds) at the greatest budget measured; a contender that failed or refused a scene has none.
"""

import json
import math
import sys
from pathlib import Path


def efficiencies(scene):
    """Contender's name -> (efficiency, its point at the greatest budget)."""
    last = {curve["name"]: curve["points"][-1] for curve in scene["curves"] if curve["points"]}
    return {name: point for name, point in last.items() if point["efficiency"] and point["efficiency"] > 0}


def row(scene):
    points = efficiencies(scene)
    own = points["castray"]
    ratios = {name: own["efficiency"] / point["efficiency"] for name, point in points.items() if name != "castray"}
    rivals = [ratio for name, ratio in ratios.items() if name != "plain"]
    return {"scene": scene["name"], "seconds": own["seconds"], "relmse": own["relmse"], "ratios": ratios,
            "worst": min(rivals or ratios.values())}


def markdown(rows, names):
    lines = ["| scene | seconds | relMSE | " + " | ".join(f"x {name}" for name in names) + " |",
             "| --- " * (3 + len(names)) + "|"]
    for entry in rows:
        cells = [f"{entry['ratios'][name]:.2g}" if name in entry["ratios"] else "-" for name in names]
        lines.append(f"| {entry['scene']} | {entry['seconds']:.2f} | {entry['relmse']:.2g} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def plot(rows, names):
    """A logarithmic dot plot: how many times more efficient castray is than each contender."""
    top, left, step, decades, width = 40, 190, 20, 5, 600  # 0.1 to 10 000
    colours = ["#5b6770", "#c8553d", "#2a7f9e", "#7a5195"]

    def x(ratio):
        return left + width * (math.log10(min(max(ratio, 0.1), 1e4)) + 1) / decades

    height = top + step * len(rows) + 30
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + width + 30} {height}" '
             'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="#fff"/>']
    for power in range(-1, 5):
        place = x(10.0**power)
        parts.append(f'<line x1="{place}" y1="{top - 6}" x2="{place}" y2="{height - 24}" '
                     f'stroke="{"#444" if power == 0 else "#ddd"}"/>')
        parts.append(f'<text x="{place}" y="{height - 8}" text-anchor="middle">{10.0**power:g}x</text>')
    for number, name in enumerate(names):
        parts.append(f'<circle cx="{left + 130 * number}" cy="16" r="4" fill="{colours[number]}"/>'
                     f'<text x="{left + 130 * number + 9}" y="20">over {name}</text>')
    for number, entry in enumerate(rows):
        y = top + step * number + 8
        parts.append(f'<text x="{left - 12}" y="{y + 4}" text-anchor="end">{entry["scene"]}</text>')
        parts += [f'<circle cx="{x(entry["ratios"][name]):.1f}" cy="{y}" r="4" fill="{colours[index]}"/>'
                  for index, name in enumerate(names) if name in entry["ratios"]]
    return "\n".join(parts + ["</svg>\n"])


def main():
    source, table, picture = sys.argv[1:]
    scenes = json.loads(Path(source).read_text(encoding="utf-8"))["scenes"]
    names = [curve["name"] for curve in scenes[0]["curves"] if curve["name"] != "castray"]
    rows = sorted(map(row, scenes), key=lambda entry: entry["worst"])
    Path(table).write_text(markdown(rows, names), encoding="utf-8")
    Path(picture).write_text(plot(rows, names), encoding="utf-8")


if __name__ == "__main__":
    main()

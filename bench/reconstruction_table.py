#!/usr/bin/env python3
"""reconstruction_table.py scenes BENCH.json | sizes BENCH.json...: tables in Markdown of what `castray bench` measured.

Each BENCH.json has the configurations default, means and differences; each of `sizes` has one scene at one size and budget.
"""

import json
import sys
from pathlib import Path

TARGET = 1e-4  # relMSE


def points(scene):
    """Configuration -> budget in samples -> point."""
    return {curve["name"]: {point["spp"]: point for point in curve["points"]} for curve in scene["curves"]}


def line(cells):
    return "| " + " | ".join(cells) + " |"


def table(head, rows):
    return "\n".join([line(head), "|" + " --- |" * len(head), *map(line, rows)])


def ratios(of, over):
    """Error, time and efficiency of a point, over those of another."""
    return [f"{of[key] / over[key]:.2f}" for key in ("relmse", "seconds", "efficiency")]


def scenes(report):
    rows = []
    for scene in report["scenes"]:
        by_name = points(scene)
        for spp, means in by_name["means"].items():
            default, differences = by_name["default"][spp], by_name["differences"][spp]
            rows.append([scene["name"], str(spp), f"{means['relmse']:.2g}", f"{means['seconds']:.3f}",
                         *ratios(differences, means), *ratios(default, means)])
    return table(["scene", "samples", "relMSE of means", "seconds", "differences: error", "time", "efficiency",
                  "default: error", "time", "efficiency"], rows)


def sizes(reports):
    rows = []
    for report in reports:
        scene = report["scenes"][0]
        for name, by_spp in points(scene).items():
            curve = next(curve for curve in scene["curves"] if curve["name"] == name)
            for spp, point in by_spp.items():
                rows.append([f"{scene['width']}x{scene['height']}", str(spp), name, f"{point['relmse']:.2g}", f"{point['seconds']:.3f}",
                             f"{curve['equal_time']['flip']:.4f}", f"{point['seconds'] * point['relmse'] / TARGET:.3g}"])
    return table(["size", "samples", "image", "relMSE", "seconds", "FLIP at equal time", f"seconds to {TARGET:.0e}"], rows)


def main():
    reports = [json.loads(Path(file).read_text()) for file in sys.argv[2:]]
    print(scenes(reports[0]) if sys.argv[1] == "scenes" else sizes(reports))


if __name__ == "__main__":
    main()

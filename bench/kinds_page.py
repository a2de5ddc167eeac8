#!/usr/bin/env python3
"""kinds_page.py TABLE.json PICTURES.json SCENES: makes docs/kinds.md, and moves the pictures that it shows to docs/kinds.

TABLE.json and PICTURES.json are written by `castray bench`, the pictures beside PICTURES.json by its --pictures; SCENES has
the scene files, whose first comment says what they show.
"""

import json
import sys
from pathlib import Path

from kinds_table import markdown, row

HEAD = """# Many kinds of scenes

castray beside its own plain paths and other renderers on the scenes of [scenes/kinds](../scenes/kinds): what each shows, how
many times as efficient castray is, 1 / (relMSE x seconds), and the best of them beside it at equal time, so that the pictures differ in noise alone. The worst
scene comes first. `docs/make-kinds` makes this page.
References are means of shared paths where a render shares, as plain ones are too noisy in cove, corridor and window_room
([benchmarks](benchmarks.md#what-is-measured)).

"""


def sentence(scenes, name):
    file = Path(scenes) / f"{name}.json"
    first = file.read_text(encoding="utf-8").splitlines()[0] if file.exists() else ""
    return first[3:] if first.startswith("// ") else "The box with a generated mesh of 20 000 triangles in it."


def times(ratios):
    return ", ".join(f"{ratio:.2g} times {'its plain paths' if name == 'plain' else name}" for name, ratio in ratios.items())


def pictures(scene, folder):
    """castray and the best of the others at equal time, and what both should look like."""
    shown = [curve for curve in scene["curves"] if curve["name"] != "plain" and curve.get("equal_time")]
    shown = shown[:1] + sorted(shown[1:], key=lambda curve: curve["equal_time"]["relmse"])[:1]
    heads = [f"{curve['name']}, {curve['equal_time']['spp']} spp" for curve in shown] + ["reference"]
    files = [f"{folder}/{scene['name']}.{name}.png" for name in [curve["name"] for curve in shown] + ["reference"]]
    images = [f'<img src="{file}" width="256" alt="">' for file in files]
    return files, "\n".join(f"| {' | '.join(cells)} |" for cells in (heads, ["---"] * len(heads), images))


def main():
    table, shown, scenes = map(Path, sys.argv[1:])
    page = Path(__file__).parent.parent / "docs" / "kinds.md"
    report = json.loads(table.read_text(encoding="utf-8"))
    by_name = {scene["name"]: scene for scene in json.loads(shown.read_text(encoding="utf-8"))["scenes"]}
    rows = sorted(map(row, report["scenes"]), key=lambda entry: entry["worst"])
    names = [curve["name"] for curve in report["scenes"][0]["curves"] if curve["name"] != "castray"]
    first = report["scenes"][0]
    seeds = "one seed" if report["seeds"] == 1 else f"medians of {report['seeds']} seeds"
    spp = first["curves"][0]["points"][-1]["spp"]
    text = HEAD + (f"{first['width']}x{first['height']}, {spp} spp, {report['machine']}, {report['threads']} threads, {seeds}.\n\n"
                   "![How many times as efficient](kinds/kinds.svg)\n\n" + markdown(rows, names))
    for entry in rows:
        name = entry["scene"]
        files, line = pictures(by_name[name], "kinds")
        for file in files:
            (page.parent / file).write_bytes((shown.parent / Path(file).name).read_bytes())
        text += f"\n## {name}\n\n{sentence(scenes, name)} castray is {times(entry['ratios'])}.\n\n{line}\n"
    page.write_text(text, encoding="utf-8")


main()

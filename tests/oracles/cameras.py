#!/usr/bin/env python3
"""The Cornell box through a thin lens, by parallel rays, and with a shifted image, against Mitsuba.

cameras.py CASTRAY renders the scenes of tests/golden/cameras anew with Mitsuba, and holds against that the block means
stored there and what castray renders, by z-test. cameras.py --write [VARIANT] makes the folder; castray's tests read it.
"""
import json

import details
import mitsuba as mi
from suite import ROOT, SIDE, Suite

FOLDER = ROOT / "tests" / "golden" / "cameras"
POSITION, LOOK_AT = [278, 273, -800], [278, 273, 0]
BOX = json.loads("".join(line for line in open(ROOT / "scenes" / "cornell_box.json") if not line.startswith("//")))

# Keys of castray's camera, and of Mitsuba's sensor.
CASES = {
    "lens": ({"lens": {"radius": 60, "focus_distance": 1000}},
             {"type": "thinlens", "fov": 40, "fov_axis": "y", "aperture_radius": 60, "focus_distance": 1000}),
    "orthographic": ({"type": "orthographic", "height": 500}, {"type": "orthographic"}),
    "shift": ({"shift": [0.2, -0.1]},
              {"type": "perspective", "fov": 40, "fov_axis": "y", "principal_point_offset_x": 0.2,
               "principal_point_offset_y": 0.1}),
}


def write_scene(name):
    scene = {**BOX, "camera": {"position": POSITION, "look_at": LOOK_AT, **CASES[name][0]}, "image": {"width": SIDE, "height": SIDE}}
    del scene["$schema"], scene["render"]
    scene["meshes"] = [{**mesh, "obj": "../../" + mesh["obj"]} for mesh in BOX["meshes"]]
    (FOLDER / f"{name}.json").write_text(json.dumps(scene, indent=1) + "\n")


def mitsuba_scene(name, view):
    sensor = dict(CASES[name][1])
    to_world = mi.ScalarTransform4f().look_at(origin=POSITION, target=LOOK_AT, up=[0, 1, 0])
    if sensor["type"] == "orthographic":
        to_world = to_world.scale([250, 250, 1])
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": -1},
             "sensor": view.sensor(**sensor, to_world=to_world)}
    for i, mesh in enumerate(BOX["meshes"]):
        material = BOX["materials"][mesh["material"]]
        shape = {"type": "obj", "filename": str(ROOT / "scenes" / mesh["obj"]), "face_normals": True,
                 "bsdf": details.plain(material["kd"])}
        if "ke" in material:
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": material["ke"]}}
        scene[f"mesh{i}"] = shape
    return mi.load_dict(scene)


SUITE = Suite(FOLDER, list(CASES), mitsuba_scene, write_scene)

if __name__ == "__main__":
    SUITE.main()

#!/usr/bin/env python3
"""An image of the environment, lights without size, a lamp with an image, and instances, against Mitsuba.

lights.py CASTRAY renders the scenes of tests/golden/lights anew with Mitsuba, and holds against that the block means
stored there and what castray renders, by z-test. lights.py --write [VARIANT [NAME...]] makes the folder, or these scenes of
it; castray's tests read it.
"""
import json

import details
import mitsuba as mi
import numpy as np
from suite import ROOT, SIDE, Suite

FOLDER = ROOT / "tests" / "golden" / "lights"
POSITION, LOOK_AT, FOV = [0, 3.5, 4.5], [0, 0.3, 0.2], 35  # nothing but the floor behind the cubes
HALF = 6  # of the floor
CARD, CUBE = "../details/card.obj", "../../../models/shapes/cube.obj"
FLOOR, RED = [0.6, 0.55, 0.5], [0.6, 0.2, 0.1]
TEXELS = 32, 16  # of the environment
FINER = 32  # where Mitsuba interpolates
AT = {"point": [1.0, 2.5, 1.5], "spot": [1.0, 3.0, 1.0], "target": [0.0, 0.3, 0.0], "sun": [-1.0, -2.0, -1.0]}
WHITE, WARM = [3.0, 3.0, 3.0], [8.0, 6.0, 5.0]
DIM = 0.1  # of a sky beside lights without size: without it some blocks get light by rare paths alone, whose spread says little
CUTOFF, EDGE = 20.0, 1e-3  # of the spot, in degrees: between these Mitsuba's falls off by another law
PLACES = [([-0.9, 0.4, 0.2], 20, 0.4), ([0.4, 0.55, -0.6], 50, 0.55), ([0.9, 0.25, 0.7], 75, 0.25)]  # centre, turn, half a side


def rgb(value):
    return {"type": "rgb", "value": value}


def steps(place):
    centre, turn, scale = place
    return [{"scale": scale}, {"rotate": [0, 1, 0, turn]}, {"translate": centre}]


def to_world(place):
    centre, turn, scale = place
    return mi.ScalarTransform4f().translate(centre).rotate([0, 1, 0], turn).scale(scale)


def rows(place):
    return np.array(to_world(place).matrix, float)[:3].ravel().tolist()


def environment():
    """A dim gradient with a bright patch, by rule."""
    width, height = TEXELS
    y, x = np.mgrid[:height, :width]
    image = np.dstack([0.1 + y / height, 0.2 + 0.5 * y / height, 0.3 + 0.1 * np.sin(2 * np.pi * x / width)]) / 2
    image[3, 9] = [60, 50, 40]
    return image.astype(np.float32)


def interpolated_environment():
    """The same for Mitsuba, which interpolates between points in FINER steps of a texel: at a texel's edge is the mean of both
    sides. The first column is on the image's edge, the first and the last row are the poles."""
    width, height = TEXELS
    columns, rows = np.arange(FINER * width), np.arange(FINER * height + 1)

    def sides(points, texels, bound):
        return bound((points - 1) // FINER, texels), bound(points // FINER, texels)

    image = environment()
    image = sum(image[:, side] for side in sides(columns, width, np.mod)) / 2
    return sum(image[side] for side in sides(rows, height, lambda row, n: np.clip(row, 0, n - 1))) / 2


def lamp(emitter):
    t = mi.ScalarTransform4f().translate([0.5, 3.0, 0.5]).rotate([1, 0, 0], 90)
    return {"lamp": {"type": "obj", "filename": str(FOLDER / CARD), "face_normals": True, "to_world": t,
                     "bsdf": details.plain([0, 0, 0]), "emitter": {"type": "area", "radiance": emitter}}}


def lamp_of(ke):
    return {"materials": {"lamp": {"type": "diffuse", "kd": 0, "ke": ke}},
            "meshes": [{"obj": CARD, "material": "lamp", "transform": [{"rotate": [1, 0, 0, 90]}, {"translate": [0.5, 3.0, 0.5]}]}]}


def environment_map():
    t = mi.ScalarTransform4f().rotate([0, 1, 0], 40)
    return {"sky": {"type": "envmap", "bitmap": mi.Bitmap(interpolated_environment()), "scale": 0.5, "to_world": t}}


def without_size(ours, theirs):
    """A light, beside a dim sky."""
    return ({"lights": [ours], "environment": {"radiance": DIM}},
            lambda: {"light": theirs(), "sky": {"type": "constant", "radiance": rgb(DIM)}})


# What castray's scene has besides floor and cube, and Mitsuba's.
CASES = {
    "environment": ({"environment": {"image": "environment.exr", "scale": 0.5, "rotation": 40}}, environment_map),
    "point": without_size({"type": "point", "position": AT["point"], "intensity": WARM},
                          lambda: {"type": "point", "position": AT["point"], "intensity": rgb(WARM)}),
    "spot": without_size({"type": "spot", "position": AT["spot"], "look_at": AT["target"], "intensity": WARM,
                          "outer_angle": CUTOFF, "inner_angle": CUTOFF - EDGE},
                         lambda: {"type": "spot", "intensity": rgb(WARM), "cutoff_angle": CUTOFF, "beam_width": CUTOFF - EDGE,
                                  "to_world": mi.ScalarTransform4f().look_at(origin=AT["spot"], target=AT["target"],
                                                                             up=[0, 1, 0])}),
    "directional": without_size({"type": "directional", "direction": AT["sun"], "irradiance": WHITE},
                                lambda: {"type": "directional", "direction": AT["sun"], "irradiance": rgb(WHITE)}),
    "emission": (lamp_of({"image": "../details/colours.png", "factor": 4}),
                 lambda: lamp(details.scaled(details.bitmap("colours.png"), 4))),
    "instances": ({**lamp_of(WARM), "objects": {"cube": [{"obj": CUBE, "material": "cube"}]}}, lambda: lamp(rgb(WARM))),
}


def write_scene(name):
    more = dict(CASES[name][0])
    cubes = [] if "objects" in more else [{"obj": CUBE, "material": "cube", "transform": steps(place)} for place in PLACES]
    if "objects" in more:
        more["instances"] = [{"object": "cube", "transforms": [rows(place) for place in PLACES]}]
        more["instancing"] = "keep"
    scene = {"camera": {"position": POSITION, "look_at": LOOK_AT, "fov": FOV}, "image": {"width": SIDE, "height": SIDE}, **more,
             "materials": {"floor": {"type": "diffuse", "kd": FLOOR}, "cube": {"type": "diffuse", "kd": RED}, **more.get("materials", {})},
             "meshes": [{"obj": CARD, "material": "floor", "transform": [{"scale": HALF}, {"rotate": [1, 0, 0, -90]}]},
                        *cubes, *more.get("meshes", [])]}
    (FOLDER / f"{name}.json").write_text(json.dumps(scene, indent=1) + "\n")


def cubes(name):
    cube = {"type": "obj", "filename": str(FOLDER / CUBE), "face_normals": True, "bsdf": details.plain(RED)}
    if name != "instances":
        return {f"cube{i}": {**cube, "to_world": to_world(place)} for i, place in enumerate(PLACES)}
    return {"group": {"type": "shapegroup", "id": "group", "cube": cube},
            **{f"cube{i}": {"type": "instance", "group": {"type": "ref", "id": "group"}, "to_world": to_world(place)}
               for i, place in enumerate(PLACES)}}


def mitsuba_scene(name, view):
    t = mi.ScalarTransform4f
    return mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": -1},
        "sensor": view.sensor(type="perspective", fov=FOV, fov_axis="y",
                              to_world=t().look_at(origin=POSITION, target=LOOK_AT, up=[0, 1, 0])),
        "floor": {"type": "obj", "filename": str(FOLDER / CARD), "face_normals": True, "bsdf": details.plain(FLOOR),
                  "to_world": t().rotate([1, 0, 0], -90).scale(HALF)},
        **cubes(name), **CASES[name][1]()})


def write_environment():
    mi.Bitmap(environment()).write(str(FOLDER / "environment.exr"))


SUITE = Suite(FOLDER, list(CASES), mitsuba_scene, write_scene, write_environment)

if __name__ == "__main__":
    SUITE.main()

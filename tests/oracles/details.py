#!/usr/bin/env python3
"""Images on materials against Mitsuba: colours, holes, normals, heights, metals; of scene files and of MTL.

details.py CASTRAY renders the scenes of tests/golden/details anew with Mitsuba, and holds against that the block means
stored there and what castray renders, by z-test: scene files and MTL, shared and plain paths, each instruction set.
details.py --write [VARIANT [NAME...]] makes the folder, or these scenes of it; castray's tests read it.
"""
import json
import math

import mitsuba as mi
import numpy as np
from PIL import Image
from suite import ROOT, SIDE, Suite

FOLDER = ROOT / "tests" / "golden" / "details"
SKY, LAMP = [0.3, 0.35, 0.4], [4.0, 3.5, 3.0]
ABSORPTION = [0.2, 0.6, 1.0]  # of the glass, which is a block instead of a card

# Mitsuba dims what bent normals reflect at grazing angles (Conty Estevez et al. 2019) unless told not to; castray does not.
UNSHADOWED = {"use_shadowing_function": False, "flip_invalid_normals": False}

PAIR_PLACES = ((-0.7, 0), (0.7, 180))  # x, and degrees around y: each shows another side

# Where the viewer is behind a bent normal, castray does not bend it, Mitsuba shows black. The camera never is, but the floor
# may be: it is black beside such cards.
BLACK_FLOOR = ("normals", "heights")

# The card: a material of castray's, the same as MTL, and the same in Mitsuba.
CASES = {
    "colours": (
        {"type": "diffuse", "kd": {"image": "colours.png", "scale": [2, 3], "offset": [0.3, 0.1], "factor": [0.9, 0.9, 0.9]}},
        "Kd .9 .9 .9\nmap_Kd -s 2 3 1 -o .3 .1 0 colours.png\n",
        lambda: twosided({"type": "diffuse",
                          "reflectance": scaled(bitmap("colours.png", scale=(2, 3), offset=(0.3, 0.1)), 0.9)})),
    "holes": (
        {"type": "diffuse", "kd": [0.6, 0.3, 0.1], "coverage": {"image": "holes.png"}},
        "Kd .6 .3 .1\nillum 1\nmap_d holes.png\n",
        lambda: {"type": "mask", "opacity": bitmap("holes.png", raw=True), "bsdf": plain([0.6, 0.3, 0.1])}),
    "normals": (
        {"type": "diffuse", "kd": [0.7, 0.7, 0.7], "normal_map": {"image": "normals.png"}},
        "Kd .7 .7 .7\nnorm normals.png\n",
        lambda: twosided({"type": "normalmap", **UNSHADOWED, "normalmap": bitmap("normals.png", raw=True), "bsdf": plain([0.7, 0.7, 0.7])})),
    "heights": (
        {"type": "diffuse", "kd": [0.7, 0.7, 0.7], "bump_map": {"image": "heights.png", "gain": 0.15}},
        "Kd .7 .7 .7\nmap_Bump -bm .15 heights.png\n",
        lambda: twosided({"type": "bumpmap", **UNSHADOWED, "texture": bitmap("heights.png", raw=True), "scale": 0.15,
                          "bsdf": plain([0.7, 0.7, 0.7])})),
    # Narrow lobes, where separable and correlated masking agree.
    "metal": (
        {"type": "principled", "kd": {"image": "colours.png"}, "metallic": 1, "roughness": 0.25},
        "map_Kd colours.png\nPr .25\nmap_Pm -mm 1 0 holes.png\n",
        lambda: twosided({"type": "principled", "base_color": bitmap("colours.png"), "metallic": 1.0, "roughness": 0.25})),
    "mirror": (
        {"type": "conductor", "reflectance": {"image": "colours.png"}, "roughness": 0.3},
        "map_Kd colours.png\nPr .3\nPm 1\n",
        lambda: twosided({"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": 0.09,
                          "specular_reflectance": bitmap("colours.png")})),
    "index": (
        {"type": "conductor", "reflectance": {"eta": [0.2, 0.9, 2.5], "k": [3.4, 1.5, 0.8]}, "roughness": 0.5},
        None,
        lambda: twosided({"type": "roughconductor", "distribution": "ggx", "alpha": 0.25,
                          "eta": {"type": "rgb", "value": [0.2, 0.9, 2.5]}, "k": {"type": "rgb", "value": [3.4, 1.5, 0.8]}})),
    "brushed": (
        {"type": "conductor", "reflectance": [0.9, 0.7, 0.5], "alpha": 0.09, "anisotropy": 0.75, "anisotropy_rotation": 90},
        None,
        lambda: twosided({"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha_u": 0.045, "alpha_v": 0.18,
                          "specular_reflectance": {"type": "rgb", "value": [0.9, 0.7, 0.5]}})),
    "layers_brushed": (
        {"type": "principled", "kd": [0.9, 0.7, 0.5], "metallic": 1, "roughness": 0.3, "anisotropy": 0.72},
        None,
        lambda: twosided({"type": "principled", "base_color": {"type": "rgb", "value": [0.9, 0.7, 0.5]}, "metallic": 1.0,
                          "roughness": 0.3, "anisotropic": 0.8})),
    "layers_brushed_image": (
        {"type": "principled", "kd": [0.9, 0.7, 0.5], "metallic": 1, "roughness": 0.3,
         "anisotropy": {"image": "heights.png", "factor": 0.9}},
        None,
        lambda: twosided({"type": "principled", "base_color": {"type": "rgb", "value": [0.9, 0.7, 0.5]}, "metallic": 1.0,
                          "roughness": 0.3, "anisotropic": bitmap("heights.png", raw=True)})),
    "pair": (
        {"type": "two_sided", "front": {"type": "diffuse", "kd": {"image": "colours.png"}},
         "back": {"type": "conductor", "reflectance": {"eta": [0.2, 0.9, 2.5], "k": [3.4, 1.5, 0.8]}, "roughness": 0.5}},
        None,
        lambda: {"type": "twosided", "front": {"type": "diffuse", "reflectance": bitmap("colours.png")},
                 "back": CASES["index"][2]()["bsdf"]}),
    "glass": (
        {"type": "dielectric", "ior": 1.5, "alpha": 0.3, "absorption": ABSORPTION},
        None,
        lambda: {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.3, "int_ior": 1.5, "ext_ior": 1.0}),
    "pane": (
        {"type": "dielectric", "ior": 1.5, "thin": True, "transmittance": [0.9, 0.6, 0.3]},
        None,
        lambda: {"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1.0,
                 "specular_transmittance": {"type": "rgb", "value": [0.9, 0.6, 0.3]}}),
}


CARD = """# A square with texture coordinates.
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 2/2 3/3 4/4
"""


def write_images():
    """Of 16x16 texels; values by rule."""
    y, x = np.mgrid[:16, :16]
    colours = np.dstack([(37 * x + 11 * y) % 200 + 30, (91 * y + 5 * x) % 180 + 40, (53 * x * y) % 190 + 20])
    holes = np.where((x // 4 + y // 4) % 2 == 0, 255, (x * 16) % 256)
    tilt = np.dstack([np.sin(x * math.pi / 4), np.cos(y * math.pi / 4), np.full(x.shape, 2.5)])
    normals = np.round((tilt / np.linalg.norm(tilt, axis=2, keepdims=True) + 1) / 2 * 255)
    heights = np.round(127.5 + 100 * np.sin(x * math.pi / 4) * np.sin(y * math.pi / 8))
    for name, image in (("colours", colours), ("holes", holes), ("normals", normals), ("heights", heights)):
        Image.fromarray(image.astype(np.uint8)).save(FOLDER / f"{name}.png", optimize=True)


def write_scene(name):
    material, mtl, _ = CASES[name]
    write_json(name, {"obj": "card.obj", "material": "card"}, {"card": material})
    if mtl is None:
        return
    (FOLDER / f"{name}.mtl").write_text(f"newmtl card\n{mtl}")
    (FOLDER / f"{name}.obj").write_text(f"mtllib {name}.mtl\nusemtl card\n{CARD}")
    write_json(f"{name}_mtl", {"obj": f"{name}.obj"}, {})


def write_json(name, card, materials):
    scene = {
        "camera": {"position": [0, 1.5, 4.5], "look_at": [0, 0.8, 0], "up": [0, 1, 0], "fov": 35},
        "image": {"width": SIDE, "height": SIDE},
        "environment": {"radiance": SKY},
        "materials": {**materials, "floor": {"type": "diffuse", "kd": floor(name)},
                      "lamp": {"type": "diffuse", "kd": [0, 0, 0], "ke": LAMP}},
        "meshes": [
            *cards(name, card),
            {"obj": "card.obj", "material": "floor",
             "transform": [{"scale": 3}, {"rotate": [1, 0, 0, -90]}]},
            {"obj": "card.obj", "material": "lamp",
             "transform": [{"rotate": [1, 0, 0, 90]}, {"translate": [0.5, 3.2, 1]}]}]}
    (FOLDER / f"{name}.json").write_text(json.dumps(scene, indent=1) + "\n")


def cards(name, card):
    if name == "glass":
        return [{**card, "obj": "../../../models/shapes/cube.obj",
                 "transform": [{"scale": 0.6}, {"rotate": [0, 1, 0, 30]}, {"translate": [0, 0.8, 0]}]}]
    if name == "pair":
        return [{**card, "transform": [{"scale": 0.6}, {"rotate": [0, 1, 0, turn]}, {"rotate": [1, 0, 0, -25]},
                                       {"translate": [x, 1, 0]}]} for x, turn in PAIR_PLACES]
    return [{**card, "transform": [{"rotate": [1, 0, 0, -25]}, {"translate": [0, 1, 0]}]}]


def floor(name):
    return [0.0 if name.removesuffix("_mtl") in BLACK_FLOOR else 0.5] * 3


def bitmap(name, raw=False, scale=(1, 1), offset=(0, 0)):
    # Mitsuba's v runs downwards: s v + o upwards is s v' + (1 - s - o) downwards.
    to_uv = mi.ScalarTransform4f().translate([offset[0], 1 - scale[1] - offset[1], 0]).scale([scale[0], scale[1], 1])
    return {"type": "bitmap", "filename": str(FOLDER / name), "raw": raw, "to_uv": to_uv}


def plain(colour):
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": colour}}}


def twosided(bsdf):
    nested = bsdf.get("bsdf")
    if nested:
        bsdf = {**bsdf, "bsdf": nested["bsdf"]}
    return {"type": "twosided", "bsdf": bsdf}


def scaled(texture, factor):
    """The factor is applied to the texels: Mitsuba has no product of a constant and an image."""
    texels = np.asarray(mi.Bitmap(texture.pop("filename")).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32,
                                                                   srgb_gamma=False))
    return {**texture, "bitmap": mi.Bitmap((texels * factor).astype(np.float32)), "raw": True}


def mitsuba_scene(name, view):
    t = mi.ScalarTransform4f

    def shape(bsdf, to_world, filename=FOLDER / "card.obj", **more):
        return {"type": "obj", "filename": str(filename), "face_normals": True, "to_world": to_world, "bsdf": bsdf, **more}

    def card():
        if name == "pair":
            return {f"card {turn}": shape(CASES[name][2](), t().translate([x, 1, 0]).rotate([1, 0, 0], -25)
                                       .rotate([0, 1, 0], turn).scale(0.6)) for x, turn in PAIR_PLACES}
        if name != "glass":
            return {"card": shape(CASES[name][2](), t().translate([0, 1, 0]).rotate([1, 0, 0], -25))}
        medium = {"type": "homogeneous", "albedo": 0.0, "sigma_t": rgb(ABSORPTION)}
        return {"card": shape(CASES[name][2](), t().translate([0, 0.8, 0]).rotate([0, 1, 0], 30).scale(0.6),
                              ROOT / "models/shapes/cube.obj", interior=medium)}

    rgb = lambda value: {"type": "rgb", "value": value}
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpathmis" if name == "glass" else "path", "max_depth": -1},
        "sensor": view.sensor(type="perspective", fov=35, fov_axis="y",
                              to_world=t().look_at(origin=[0, 1.5, 4.5], target=[0, 0.8, 0], up=[0, 1, 0])),
        "sky": {"type": "constant", "radiance": rgb(SKY)},
        **card(),
        "floor": shape(plain(floor(name)), t().rotate([1, 0, 0], -90).scale(3)),
        "lamp": shape(plain([0, 0, 0]), t().translate([0.5, 3.2, 1]).rotate([1, 0, 0], 90),
                      emitter={"type": "area", "radiance": rgb(LAMP)})})


def write_common():
    (FOLDER / "card.obj").write_text(CARD)
    write_images()


SUITE = Suite(FOLDER, list(CASES), mitsuba_scene, write_scene, write_common)

if __name__ == "__main__":
    SUITE.main()

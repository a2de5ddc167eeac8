#!/usr/bin/env python3
"""Images on materials against Mitsuba: colours, holes, normals, heights, metals; of scene files and of MTL.

details.py CASTRAY renders the scenes of tests/golden/details anew with Mitsuba, and holds against that the block means
stored there and what castray renders, by z-test: scene files and MTL, shared and plain paths, each instruction set.
details.py --write [VARIANT [NAME...]] makes the folder, or these scenes of it; castray's tests read it.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "tests" / "golden" / "details"
SIDE, BLOCK = 64, 4  # pixels
SAMPLER = "independent"
FALSE_ALARM = 1e-3  # of a whole run
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
        lambda: diffuse(bitmap("colours.png", scale=(2, 3), offset=(0.3, 0.1)), 0.9)),
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


def diffuse(reflectance, factor):
    """The factor is applied to the texels: Mitsuba has no product of a constant and an image."""
    texels = np.asarray(mi.Bitmap(reflectance.pop("filename")).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32,
                                                                       srgb_gamma=False))
    reflectance.update(bitmap=mi.Bitmap((texels * factor).astype(np.float32)), raw=True)
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}


def mitsuba_scene(name):
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
        "sensor": {"type": "perspective", "fov": 35, "fov_axis": "y",
                   "to_world": t().look_at(origin=[0, 1.5, 4.5], target=[0, 0.8, 0], up=[0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}},
                   "sampler": {"type": SAMPLER}},
        "sky": {"type": "constant", "radiance": rgb(SKY)},
        **card(),
        "floor": shape(plain(floor(name)), t().rotate([1, 0, 0], -90).scale(3)),
        "lamp": shape(plain([0, 0, 0]), t().translate([0.5, 3.2, 1]).rotate([1, 0, 0], 90),
                      emitter={"type": "area", "radiance": rgb(LAMP)})})


def block_means(image):
    n = SIDE // BLOCK
    return np.asarray(image, np.float64)[..., :3].reshape(n, BLOCK, n, BLOCK, 3).mean((1, 3))


class Estimate:
    """Mean of independent renders' blocks, and its variance."""

    def __init__(self, renders):
        renders = np.array(renders)
        self.mean = renders.mean(0)
        self.variance = renders.var(0, ddof=1) / len(renders)


def by_mitsuba(name, spp, seeds, first_seed):
    scene = mitsuba_scene(name)
    return Estimate([block_means(mi.render(scene, spp=spp, seed=first_seed + s)) for s in range(seeds)])


def by_castray(castray, name, flags, spp, seeds):
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "image.pfm"
        renders = []
        for seed in range(seeds):
            subprocess.run([castray, "render", FOLDER / f"{name}.json", "-q", "--spp", str(spp), "--seed", str(seed + 1),
                            "-o", output, *flags], check=True)
            renders.append(block_means(read_pfm(output)))
        return Estimate(renders)


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) < 0
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1]


def write_pfm(path, image):
    with open(path, "wb") as file:
        file.write(f"PF\n{image.shape[1]} {image.shape[0]}\n-1.0\n".encode())
        file.write(image[::-1].astype("<f4").tobytes())


def stored(name):
    estimate = Estimate.__new__(Estimate)
    estimate.mean, estimate.variance = (read_pfm(FOLDER / f"{name}_{what}.pfm") for what in ("mean", "variance"))
    return estimate


def check(title, a, b, tests):
    """Every block; 32 renders or more on each side, so that scores are normal but for their tails."""
    variance = a.variance + b.variance
    noisy = variance > 0
    z = np.abs(a.mean - b.mean)[noisy] / np.sqrt(variance[noisy])
    if not np.allclose(a.mean[~noisy], b.mean[~noisy]):
        print(f"{title}: blocks without noise differ")
        return False
    limit = math.sqrt(2) * inverse_erfc(FALSE_ALARM / (tests * z.size))
    limit *= 1 + limit**2 / (4 * 31)  # Student's t with 31 degrees of freedom
    print(f"{title}: largest z {z.max():.2f} (limit {limit:.2f}), rms {math.sqrt((z**2).mean()):.3f}")
    return z.max() < limit


def inverse_erfc(p):
    low, high = 0.0, 10.0
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if math.erfc(middle) > p else (low, middle)
    return low


def write_estimate(name):
    estimate = by_mitsuba(name, spp=256, seeds=32, first_seed=1000)
    write_pfm(FOLDER / f"{name}_mean.pfm", estimate.mean)
    write_pfm(FOLDER / f"{name}_variance.pfm", estimate.variance)


def write(variant="scalar_rgb", *names):
    mi.set_variant(variant)
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / "card.obj").write_text(CARD)
    write_images()
    for name in names or CASES:
        write_scene(name)
        write_estimate(name)


def check_all(castray):
    mi.set_variant("scalar_rgb")
    ways = ways_of(castray)
    scenes = {name: [s for s in (name, f"{name}_mtl") if (FOLDER / f"{s}.json").exists()] for name in CASES}
    tests = len(CASES) + len(ways) * sum(map(len, scenes.values()))
    good = True
    for name in CASES:
        anew = by_mitsuba(name, spp=16, seeds=32, first_seed=1)
        good &= check(f"{name}, as stored", stored(name), anew, tests)
        for scene in scenes[name]:
            for way, flags in ways.items():
                good &= check(f"{scene}, {way}", by_castray(castray, scene, flags, spp=16, seeds=32), anew, tests)
    return good


def ways_of(castray):
    """Flags, by what they ask for; without --accel small scenes are in a list, but those with images on surfaces in a tree."""
    reuse = {"shared": ["--reuse", "8x8:64"], "plain": ["--reuse", "off"]}
    sets = [isa for isa in ("scalar", "sse4", "avx2", "avx512") if runs(castray, isa)]
    built_of = {isa: ["--isa", isa] for isa in sets} | {"tree": ["--accel", "bvh"]}
    return {f"{built}, {way}": more + flags for built, more in built_of.items() for way, flags in reuse.items()}


def runs(castray, isa):
    """Whether castray has this instruction set, and the processor too."""
    scene = FOLDER / f"{next(iter(CASES))}.json"
    command = [castray, "render", scene, "-q", "--spp", "1", "--size", "8x8", "--isa", isa, "-o", "-"]
    return subprocess.run(command, capture_output=True).returncode == 0


if __name__ == "__main__":
    if sys.argv[1] == "--write":
        write(*sys.argv[2:])
    else:
        sys.exit(0 if check_all(sys.argv[1]) else 1)

#!/usr/bin/env python3
"""castray's passes of what the camera sees against Mitsuba's `aov` integrator.

passes.py CASTRAY renders the Cornell boxes of tests/golden/cameras, through a lens and by parallel rays, with both, and
holds the block means of albedo, normal, position, depth and objects against each other by z-test.
"""
import functools
import json
import pathlib
import subprocess
import sys
import tempfile

import cameras
import mitsuba as mi
import numpy as np
from suite import BLOCK, ROOT, SIDE, View

SPP, SEEDS = 16, 24
# Of Student's t with 46 degrees of freedom: 1e-7 two-sided, 1e-3 for the 5632 values of a run.
GREATEST_Z = 6.3
ROUNDING = 2e-5  # of the greatest value of a channel: where all samples of a block agree, there is no noise
CHANNELS = ["albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "depth", "object"]
AOVS = "albedo:albedo,N:sh_normal,P:position,depth:depth,id:shape_index"


def block_means(channels):
    n = SIDE // BLOCK
    return np.moveaxis(np.asarray(channels, np.float64), -1, 0).reshape(-1, n, BLOCK, n, BLOCK).mean((2, 4))


def by_mitsuba(scene, forward, seed):
    """Depth along the view, as castray has it, is found from the position, both being means."""
    integrator = mi.load_dict({"type": "aov", "aovs": AOVS})
    values = np.array(mi.render(scene, integrator=integrator, spp=SPP, seed=seed), np.float64)
    values[..., CHANNELS.index("depth")] = (values[..., 6:9] - cameras.POSITION) @ forward
    return block_means(values)


def by_castray(castray, name, ids, seed):
    """And the share of each block that is covered."""
    with tempfile.TemporaryDirectory() as folder:
        output = str(pathlib.Path(folder) / "image.exr")
        subprocess.run([castray, "render", cameras.FOLDER / f"{name}.json", "-q", "--spp", str(SPP), "--seed", str(seed),
                        "--passes", "albedo,normal,position,depth,object", "-o", output], check=True)
        bitmap = mi.Bitmap(output)
    channels = {field.name: np.array(bitmap)[..., i] for i, field in enumerate(bitmap.struct_())}
    ranks = [(channels[f"CryptoObject0{level}.{id}"], channels[f"CryptoObject0{level}.{share}"])
             for level in range(3) for id, share in ("RG", "BA")]
    coverage = sum(share for _, share in ranks)
    channels["object"] = sum(share * np.vectorize(lambda id: ids.get(float(id), 0))(id) for id, share in ranks)
    channels["depth"] = channels["Z"] * coverage
    for axis in "XYZ":
        channels[f"P.{axis}"] = channels[f"P.{axis}"] * coverage
    return block_means(np.dstack([channels[name] for name in CHANNELS] + [coverage]))


def object_ids(castray, name, scene):
    """Mitsuba's index of each object, by castray's id of it as a float."""
    with tempfile.TemporaryDirectory() as folder:
        output = str(pathlib.Path(folder) / "image.exr")
        subprocess.run([castray, "render", cameras.FOLDER / f"{name}.json", "-q", "--spp", "1", "--size", "4x4",
                        "--passes", "object", "-o", output], check=True)
        manifest = json.loads(mi.Bitmap(output).metadata()["cryptomatte/3ae39a5/manifest"])
    as_float = lambda digits: float(np.array([int(digits, 16)], np.uint32).view(np.float32)[0])
    ids = {}
    for i, shape in enumerate(scene.shapes(), start=1):
        file = ROOT / "scenes" / cameras.BOX["meshes"][int(shape.id().removeprefix("mesh"))]["obj"]
        names = [line.split()[1] for line in open(file) if line.startswith(("o ", "g "))] or [file.stem]
        ids.update({as_float(manifest[name]): i for name in names})
    return ids


def check(castray, name):
    scene = cameras.mitsuba_scene(name, View())
    forward = np.subtract(cameras.LOOK_AT, cameras.POSITION) / np.linalg.norm(np.subtract(cameras.LOOK_AT, cameras.POSITION))
    ids = object_ids(castray, name, scene)
    ours = np.array([by_castray(castray, name, ids, seed) for seed in range(1, SEEDS + 1)])
    theirs = np.array([by_mitsuba(scene, forward, seed) for seed in range(1, SEEDS + 1)])
    covered = ours[:, -1].min(0) == 1
    ok = True
    for i, channel in enumerate(CHANNELS):
        a, b = ours[:, i], theirs[:, i]
        noise = np.sqrt((a.var(0, ddof=1) + b.var(0, ddof=1)) / SEEDS) + ROUNDING * max(np.abs(b).max(), 1e-3)
        z = np.abs(a.mean(0) - b.mean(0)) / noise
        if channel == "depth":  # Mitsuba's position of a miss is 0, which is no depth
            z, a, b = z[covered], a[:, covered], b[:, covered]
        print(f"{name:13} {channel:9} {z.size} blocks, greatest z {z.max():.2f}, "
              f"mean of castray {a.mean():.6g}, of Mitsuba {b.mean():.6g}")
        ok &= z.max() < GREATEST_Z
    return ok


if __name__ == "__main__":
    mi.set_variant("scalar_rgb")
    mi.load_dict = functools.partial(mi.load_dict, optimize=False)  # else shapes of one material are merged
    results = [check(sys.argv[1], name) for name in ("lens", "orthographic")]
    sys.exit(0 if all(results) else 1)

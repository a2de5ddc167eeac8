"""Whether a peer renders castray's scenes as castray's reference images show them: the mean of every block of 16x16
pixels, over some seeds, against the mean of both halves of the reference, in per cent and in standard errors.

check.py NAME FOLDER_OF_REFERENCES SCENE...; exits 1 where an image's mean is off by more than 1 %.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SEEDS = 4
LIMIT = 0.01


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) < 0
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1].astype(float)


def blocks(image):
    height, width, _ = image.shape
    return image.reshape(height // 16, 16, width // 16, 16, 3).mean(axis=(1, 3))


def check(name, references, scene):
    halves = [read_pfm(references / f"{scene.stem}_{half}.pfm") for half in "AB"]
    height, width, _ = halves[0].shape
    images = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(SEEDS):
            out = f"{folder}/image.pfm"
            subprocess.run([Path(__file__).parent / "run", name, scene, "--spp", "64", "--seed", str(seed),
                            "--size", f"{width}x{height}", "--out", out], check=True, capture_output=True)
            images.append(read_pfm(out))
    reference = (halves[0] + halves[1]) / 2
    off = np.mean(images) / reference.mean() - 1
    variance = np.var([blocks(image) for image in images], axis=0, ddof=1) / SEEDS
    variance += (blocks(halves[0]) - blocks(halves[1])) ** 2 / 4
    t = (blocks(np.mean(images, axis=0)) - blocks(reference)) / np.sqrt(variance)
    print(f"{name} {scene.stem}: mean off by {100 * off:+.3f} %, rms of the blocks' t {np.sqrt((t**2).mean()):.2f}")
    return abs(off) <= LIMIT


def main():
    name, references, *scenes = sys.argv[1:]
    agreed = [check(name, Path(references), Path(scene)) for scene in scenes]
    sys.exit(0 if all(agreed) else 1)


main()

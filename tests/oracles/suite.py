"""Scenes that castray and Mitsuba have in common: renders by both, their blocks' means, and z-tests between them."""
import dataclasses
import math
import pathlib
import subprocess
import sys
import tempfile
import typing

import mitsuba as mi
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SIDE, BLOCK = 64, 4  # pixels
FALSE_ALARM = 1e-3  # of a whole run


@dataclasses.dataclass
class View:
    """How Mitsuba renders a scene: pixels across and down, and sampler."""

    side: int = SIDE
    sampler: str = "independent"

    def sensor(self, **keys):
        film = {"type": "hdrfilm", "width": self.side, "height": self.side, "rfilter": {"type": "box"}}
        return {**keys, "film": film, "sampler": {"type": self.sampler}}


class Estimate:
    """Mean of independent renders' blocks, and its variance."""

    def __init__(self, renders):
        renders = np.array(renders)
        self.mean = renders.mean(0)
        self.variance = renders.var(0, ddof=1) / len(renders)


@dataclasses.dataclass
class Suite:
    """A folder of scene files, the function that makes Mitsuba's scene of a name and a View, and those that make the files."""

    folder: pathlib.Path
    names: list
    mitsuba_scene: typing.Callable
    write_scene: typing.Callable  # the scene file of a name
    write_common: typing.Callable = lambda: None  # what several of them use

    def by_mitsuba(self, name, spp, seeds, first_seed):
        scene = self.mitsuba_scene(name, View())
        return Estimate([block_means(mi.render(scene, spp=spp, seed=first_seed + s)) for s in range(seeds)])

    def by_castray(self, castray, name, flags, spp, seeds):
        with tempfile.TemporaryDirectory() as folder:
            output = pathlib.Path(folder) / "image.pfm"
            renders = []
            for seed in range(seeds):
                subprocess.run([castray, "render", self.folder / f"{name}.json", "-q", "--spp", str(spp), "--seed", str(seed + 1),
                                "-o", output, *flags], check=True)
                renders.append(block_means(read_pfm(output)))
            return Estimate(renders)

    def stored(self, name):
        estimate = Estimate.__new__(Estimate)
        estimate.mean, estimate.variance = (read_pfm(self.folder / f"{name}_{what}.pfm") for what in ("mean", "variance"))
        return estimate

    def write_estimate(self, name):
        estimate = self.by_mitsuba(name, spp=256, seeds=32, first_seed=1000)
        write_pfm(self.folder / f"{name}_mean.pfm", estimate.mean)
        write_pfm(self.folder / f"{name}_variance.pfm", estimate.variance)

    def main(self):
        """CASTRAY, or --write [VARIANT [NAME...]]."""
        if sys.argv[1] == "--write":
            self.write(*sys.argv[2:])
        else:
            sys.exit(0 if self.check_all(sys.argv[1]) else 1)

    def write(self, variant="scalar_rgb", *names):
        mi.set_variant(variant)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.write_common()
        for name in names or self.names:
            self.write_scene(name)
            self.write_estimate(name)

    def check_all(self, castray):
        mi.set_variant("scalar_rgb")
        ways = self.ways_of(castray)
        scenes = {name: [s for s in (name, f"{name}_mtl") if (self.folder / f"{s}.json").exists()] for name in self.names}
        tests = len(self.names) + len(ways) * sum(map(len, scenes.values()))
        good = True
        for name in self.names:
            anew = self.by_mitsuba(name, spp=16, seeds=32, first_seed=1)
            good &= check(f"{name}, as stored", self.stored(name), anew, tests)
            for scene in scenes[name]:
                for way, flags in ways.items():
                    good &= check(f"{scene}, {way}", self.by_castray(castray, scene, flags, spp=16, seeds=32), anew, tests)
        return good

    def ways_of(self, castray):
        """Flags, by what they ask for; without --accel small scenes are in a list, but those with images on surfaces in a tree."""
        reuse = {"shared": ["--reuse", "8x8:64"], "plain": ["--reuse", "off"]}
        sets = [isa for isa in ("scalar", "sse4", "avx2", "avx512") if self.runs(castray, isa)]
        built_of = {isa: ["--isa", isa] for isa in sets} | {"tree": ["--accel", "bvh"]}
        return {f"{built}, {way}": more + flags for built, more in built_of.items() for way, flags in reuse.items()}

    def runs(self, castray, isa):
        """Whether castray has this instruction set, and the processor too."""
        scene = self.folder / f"{self.names[0]}.json"
        command = [castray, "render", scene, "-q", "--spp", "1", "--size", "8x8", "--isa", isa, "-o", "-"]
        return subprocess.run(command, capture_output=True).returncode == 0


def block_means(image):
    n = SIDE // BLOCK
    return np.asarray(image, np.float64)[..., :3].reshape(n, BLOCK, n, BLOCK, 3).mean((1, 3))


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

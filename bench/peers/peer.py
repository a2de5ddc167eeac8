"""What the adapters have in common: the command line, and what they write."""

import argparse
import os
import sys

import numpy as np

from castray_scene import read_scene


def parse(description, add_options=lambda parser: None):
    """The arguments, and the scene with --size applied."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scene", help="castray scene .json")
    parser.add_argument("--spp", type=int, required=True, help="samples per pixel")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", required=True, help="image to write, .pfm: linear radiance")
    parser.add_argument("--size", help="WxH pixels; default: the scene's")
    add_options(parser)
    arguments = parser.parse_args()
    scene = read_scene(arguments.scene)
    if arguments.size:
        scene.width, scene.height = map(int, arguments.size.lower().split("x"))
    return arguments, scene


def write_pfm(name, pixels):
    """Writes pixels (height, width, 3; top row first)."""
    partial = f"{name}.{os.getpid()}.tmp"
    with open(partial, "wb") as file:
        height, width, _ = pixels.shape
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.write(np.ascontiguousarray(pixels[::-1], dtype="<f4").tobytes())
    os.replace(partial, name)


def finish(arguments, pixels, seconds):
    """Writes the image and says how long the render alone took."""
    write_pfm(arguments.out, pixels)
    print(f"seconds: {seconds:.6f}")
    sys.stdout.flush()

#!/usr/bin/env python3
"""Image files against independent libraries: OpenEXR's own module, OpenCV and Pillow.

images.py CASTRAY reads with them what castray writes, and checks that tests/golden/images, files of theirs that the unit
tests read, hold what they should. images.py --write makes those files.
"""
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np
import OpenEXR
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "tests" / "golden" / "images"
WIDTH, HEIGHT = 21, 13


def radiance():
    """Multiples of 1/32, which halves hold."""
    y, x, c = np.ogrid[:HEIGHT, :WIDTH, :3]
    return (((7 * x + 11 * y + 5 * c) % 97) / 32).astype(np.float32)


def encoded(bits):
    y, x, c = np.ogrid[:HEIGHT, :WIDTH, :3]
    return ((257 * x + 4099 * y + 17 * c) % 2**bits).astype(np.uint16 if bits == 16 else np.uint8)


def write_exr(name, header, channels):
    OpenEXR.File({"owner": "OpenEXR", **header}, channels).write(str(FOLDER / name))


def write_golden():
    FOLDER.mkdir(parents=True, exist_ok=True)
    tiles = OpenEXR.TileDescription()
    tiles.xSize, tiles.ySize = 8, 4
    rgb, half = radiance(), radiance().astype(np.float16)
    alpha = np.ones((HEIGHT, WIDTH), np.float16)
    write_exr("half.exr", {"compression": OpenEXR.ZIP_COMPRESSION}, {"RGBA": np.dstack([half, alpha])})
    write_exr("half_tiled.exr", {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.tiledimage, "tiles": tiles},
              {"RGB": half})
    write_exr("float_tiled.exr", {"compression": OpenEXR.RLE_COMPRESSION, "type": OpenEXR.tiledimage, "tiles": tiles},
              {"RGB": rgb})
    variances = {f"variance.{name}": np.ascontiguousarray(rgb[..., c] / 4) for c, name in enumerate("RGB")}
    write_exr("float.exr", {"compression": OpenEXR.NO_COMPRESSION, "varianceFreedom": 15.0}, {"RGB": rgb, **variances})
    for name, image in [("8.png", encoded(8)), ("16.png", encoded(16)), ("8.ppm", encoded(8)), ("16.ppm", encoded(16)),
                        ("float.pfm", rgb), ("float.hdr", rgb)]:
        assert cv2.imwrite(str(FOLDER / name), image[..., ::-1])
    palette = Image.fromarray(encoded(8)[..., 0] % 4, "P")
    palette.putpalette([0, 0, 0, 255, 0, 0, 0, 255, 0, 10, 20, 30])
    palette.save(FOLDER / "palette.png")


def read_cv(path):
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert image is not None, path
    return image[..., ::-1]


def read_exr(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels.copy() for name, channel in file.channels().items()}
        return np.dstack([channels[c] for c in "RGB"]), channels, dict(file.header())


def check_golden():
    for name, kind in [("half.exr", np.float16), ("half_tiled.exr", np.float16), ("float_tiled.exr", np.float32),
                       ("float.exr", np.float32)]:
        image, _, header = read_exr(FOLDER / name)
        assert image.dtype == kind and (image == radiance()).all(), name
        assert ("tiles" in header) == ("tiled" in name), name
    for name in ["8.png", "16.png", "8.ppm", "16.ppm"]:
        assert (read_cv(FOLDER / name) == encoded(int(name.split(".", maxsplit=1)[0]))).all(), name
    assert (read_cv(FOLDER / "float.pfm") == radiance()).all()
    assert np.abs(read_cv(FOLDER / "float.hdr") - radiance()).max() <= 3.1 / 128


def srgb(radiance_values):
    v = np.clip(radiance_values.astype(np.float64), 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


def check_metadata(found):
    assert found["castray:scene"] == "cornell_box" and found["castray:spp"] == "16" and found["castray:seed"] == "5"
    assert "hash=" in found["castray:options"] and float(found["castray:seconds"]) > 0 and found["castray:version"]


def check_written(castray, folder):
    render = [castray, "render", ROOT / "scenes" / "cornell_box.json", "-q", "--size", "37x23", "--spp", "16", "--seed",
              "5", "--replicates", "4", "--metadata", "time"]
    outputs = [x for name in ["a.ppm", "a.png", "a.pfm", "a.hdr", "a.exr", "a.film"] for x in ["-o", name]]
    subprocess.run([*render, *outputs], cwd=folder, check=True)
    subprocess.run([castray, "convert", "a.film", "--bits", "16", "-o", "b.ppm", "-o", "b.png", "-o", "b.exr"], cwd=folder,
                   check=True)
    image = read_cv(folder / "a.pfm")
    assert image.shape == (23, 37, 3) and image.dtype == np.float32 and image.max() > 10
    exr, channels, header = read_exr(folder / "a.exr")
    assert exr.dtype == np.float32 and (exr == image).all()
    assert header["varianceFreedom"] == 3 and all((channels[f"variance.{c}"] >= 0).all() for c in "RGB")
    check_metadata(header)
    halves, _, header = read_exr(folder / "b.exr")
    assert halves.dtype == np.float16 and (halves == image.astype(np.float16)).all()
    assert header["castray:scene"] == "cornell_box" and header["castray:spp"] == "16"
    hdr = read_cv(folder / "a.hdr")
    assert (np.abs(hdr - image) <= image.max(axis=2, keepdims=True) / 128).all()
    for name, top in [("a.png", 255), ("a.ppm", 255), ("b.png", 65535), ("b.ppm", 65535)]:
        found = read_cv(folder / name)
        assert found.dtype == (np.uint8 if top == 255 else np.uint16)
        assert np.abs(found - top * srgb(image)).max() <= 0.5 + 1e-4 * top / 255, name
    check_metadata(Image.open(folder / "a.png").text)


def main():
    if sys.argv[1] == "--write":
        write_golden()
    check_golden()
    if sys.argv[1] != "--write":
        with tempfile.TemporaryDirectory() as folder:
            check_written(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(folder))
    print("images agree")
    return 0


if __name__ == "__main__":
    sys.exit(main())

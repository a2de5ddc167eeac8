#!/usr/bin/env python3
"""Error metrics of generated pairs of images, by numpy, scikit-image and flip-evaluator.

Without arguments: checks that tests/golden/metrics holds what these libraries say now. With --write: makes it anew.
"""
import argparse
import json
import math
import pathlib
import sys

import flip_evaluator
import numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "golden" / "metrics"
PIXELS_PER_DEGREE = 67.02


def pairs():
    """Name -> (image, reference): linear radiance, float32, top row first."""
    rng = np.random.default_rng(7)

    def constant(height, width, rgb):
        return np.broadcast_to(np.array(rgb, np.float32), (height, width, 3)).copy()

    def edges(height, width, shift):
        x = np.arange(width)[None, :, None] + shift
        y = np.arange(height)[:, None, None]
        return ((x // 7 + y // 5) % 2 * np.array([0.9, 0.6, 0.2])).astype(np.float32)

    def noise(height, width, scale):
        return (rng.random((height, width, 3)) * scale).astype(np.float32)

    def hdr(height, width):
        ramp = np.exp2(np.linspace(-8, 6, width))[None, :, None] * np.linspace(0.5, 1, height)[:, None, None]
        return (ramp * np.array([1.0, 0.8, 0.5])).astype(np.float32)

    smooth = hdr(23, 31)
    found = {
        "constants": (constant(16, 16, [0.2, 0.5, 0.7]), constant(16, 16, [0.25, 0.5, 0.6])),
        "equal": (edges(20, 20, 0), edges(20, 20, 0)),
        "edges": (edges(24, 33, 1), edges(24, 33, 0)),
        "noise": (noise(25, 19, 1), noise(25, 19, 1)),
        "hdr": (smooth * (1 + 0.3 * noise(23, 31, 1)), smooth),
        "clipped": (noise(17, 17, 3), constant(17, 17, [1, 1, 1])),
        "one_pixel": (constant(1, 1, [0.3, 0.1, 0.9]), constant(1, 1, [0.2, 0.4, 0.8])),
        "one_row": (noise(1, 29, 1), noise(1, 29, 1)),
        "small": (noise(7, 10, 2), noise(7, 10, 2)),
        "black": (noise(13, 15, 0.1), constant(13, 15, [0, 0, 0])),
    }
    return {name: (a.astype(np.float32), b.astype(np.float32)) for name, (a, b) in found.items()}


def shown(radiance):
    v = np.clip(radiance.astype(np.float64), 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


def ssim_of_cut_windows(a, b):
    """Every window by itself, straight from the definition, for images that scikit-image finds too small."""
    height, width, _ = a.shape
    rows = range(5, height - 5) if height > 10 else range(height)
    columns = range(5, width - 5) if width > 10 else range(width)
    values = []
    for y in rows:
        for x in columns:
            ys, xs = np.mgrid[max(0, y - 5) : min(height, y + 6), max(0, x - 5) : min(width, x + 6)]
            w = np.exp(-((ys - y) ** 2 + (xs - x) ** 2) / (2 * 1.5**2))[..., None]
            w /= w.sum()
            p, q = a[ys, xs], b[ys, xs]
            mp, mq = (w * p).sum((0, 1)), (w * q).sum((0, 1))
            vp, vq = (w * (p - mp) ** 2).sum((0, 1)), (w * (q - mq) ** 2).sum((0, 1))
            cov = (w * (p - mp) * (q - mq)).sum((0, 1))
            values.append((2 * mp * mq + 1e-4) * (2 * cov + 9e-4) / ((mp**2 + mq**2 + 1e-4) * (vp + vq + 9e-4)))
    return float(np.mean(values))


def ssim(a, b):
    if min(a.shape[:2]) < 11:
        return ssim_of_cut_windows(a, b)
    return float(
        structural_similarity(
            a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1, channel_axis=2
        )
    )


def flip(test, reference, dynamic_range):
    parameters = {"ppd": PIXELS_PER_DEGREE}
    return float(
        flip_evaluator.evaluate(
            reference.astype(np.float32),
            test.astype(np.float32),
            dynamic_range,
            inputsRGB=dynamic_range == "LDR",
            applyMagma=False,
            parameters=parameters,
        )[1]
    )


def metrics(x, r):
    x, r = x.astype(np.float64), r.astype(np.float64)
    difference = x - r
    error = np.abs(difference)
    mse = float((difference**2).mean())
    peak = float(r.max()) if r.max() > 0 else 1.0
    return {
        "mse": mse,
        "rmse": math.sqrt(mse),
        "relmse": float((difference**2 / (r**2 + 0.01)).mean()),
        "mae": float(error.mean()),
        "psnr": float(peak_signal_noise_ratio(r, x, data_range=peak)) if mse > 0 else None,
        "max_error": float(error.max()),
        "percent_beyond_0.05": float(100 * (error > 0.05).any(axis=2).mean()),
        "bias_rgb": [float(v) for v in difference.mean((0, 1))],
        "ssim": ssim(shown(x), shown(r)),
        "flip": flip(shown(x), shown(r), "LDR"),
        # flip-evaluator refuses references of one luminance only, which give no range of exposures
        "flip_hdr": flip(x, r, "HDR") if np.unique(r @ [0.2126, 0.7152, 0.0722]).size > 1 else None,
    }


def write_pfm(path, image):
    height, width, _ = image.shape
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + image[::-1].astype("<f4").tobytes())


def differs(a, b):
    if isinstance(a, list):
        return any(differs(p, q) for p, q in zip(a, b, strict=True))
    return a != b if a is None or b is None else not math.isclose(a, b, rel_tol=1e-5, abs_tol=1e-7)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    write = parser.parse_args().write
    expected = {name: metrics(*pair) for name, pair in pairs().items()}
    if write:
        FOLDER.mkdir(parents=True, exist_ok=True)
        for name, (image, reference) in pairs().items():
            write_pfm(FOLDER / f"{name}_image.pfm", image)
            write_pfm(FOLDER / f"{name}_reference.pfm", reference)
        (FOLDER / "expected.json").write_text(json.dumps(expected, indent=1) + "\n")
        return 0
    stored = json.loads((FOLDER / "expected.json").read_text())
    wrong = [f"{n}.{m}" for n in expected for m in expected[n] if differs(expected[n][m], stored[n][m])]
    print("differing from tests/golden/metrics:", wrong or "nothing")
    return 1 if wrong or stored.keys() != expected.keys() else 0


if __name__ == "__main__":
    sys.exit(main())

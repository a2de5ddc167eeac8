"""Renders a castray scene with Mitsuba 3."""

import os
import tempfile
import time
from pathlib import Path

import numpy as np

import peer


def options(parser):
    parser.add_argument("--variant", default="llvm_ad_rgb", help="llvm_ad_rgb, scalar_rgb")
    parser.add_argument("--sampler", default="auto",
                        help="independent, stratified, multijitter, orthogonal, ldsampler; auto: the best as measured, "
                        "ldsampler for scenes with conductors, else multijitter")
    parser.add_argument("--replicates", type=int, default=1,
                        help="the mean of so many renders, and beside it the .variance.pfm of that mean")


def bsdf(material):
    def two_sided(inner):
        return {"type": "twosided", "inner": inner}

    def rgb(value):
        return {"type": "rgb", "value": list(value)}

    if material.type == "diffuse":
        return two_sided({"type": "diffuse", "reflectance": rgb(material.kd)})
    if material.type == "conductor":
        mirror = {"material": "none", "specular_reflectance": rgb(material.reflectance)}
        if material.alpha == 0:
            return two_sided({"type": "conductor", **mirror})
        return two_sided({"type": "roughconductor", "distribution": "ggx", "alpha": material.alpha, **mirror})
    if material.alpha == 0:
        return {"type": "dielectric", "int_ior": material.ior, "ext_ior": 1.0}
    return {"type": "roughdielectric", "distribution": "ggx", "alpha": material.alpha, "int_ior": material.ior,
            "ext_ior": 1.0}


def write_ply(path, mesh):
    """Binary PLY; corners are shared only where there are no normals."""
    positions, triangles, names = mesh.positions, mesh.triangles, ["x", "y", "z"]
    if mesh.normals is not None:
        positions = np.hstack([positions[triangles].reshape(-1, 3), mesh.normals.reshape(-1, 3)])
        triangles = np.arange(len(positions), dtype=np.uint32).reshape(-1, 3)
        names += ["nx", "ny", "nz"]
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    with open(path, "wb") as file:
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(positions)}"]
        header += [f"property float {name}" for name in names]
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header\n"]
        file.write("\n".join(header).encode())
        file.write(positions.astype("<f4").tobytes())
        file.write(faces.tobytes())


def scene_dictionary(mi, scene, arguments, folder):
    glossy = any(mesh.material.type == "conductor" for mesh in scene.meshes)
    sampler = arguments.sampler if arguments.sampler != "auto" else "ldsampler" if glossy else "multijitter"
    camera = scene.camera
    result = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1},
        "sensor": {
            "type": "perspective", "fov": camera.fov, "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(origin=camera.position.tolist(), target=camera.look_at.tolist(),
                                                       up=camera.up.tolist()),
            "film": {"type": "hdrfilm", "width": scene.width, "height": scene.height, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": sampler, "sample_count": arguments.spp},
        },
    }
    radiance = scene.environment.radiance
    if max(radiance) > 0:
        result["environment"] = {"type": "constant", "radiance": {"type": "rgb", "value": radiance}}
    for number, mesh in enumerate(scene.meshes):
        file = Path(folder, f"{number}.ply")
        write_ply(file, mesh)
        shape = {"type": "ply", "filename": str(file), "face_normals": mesh.normals is None,
                 "bsdf": bsdf(mesh.material)}
        if mesh.material.emits:
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": list(mesh.material.ke)}}
        result[f"mesh{number}"] = shape
    return result


def replicated(render, arguments):
    """The mean of the renders, the variance of that mean and the seconds of all renders. Pixels of a block of 8x8 all have
    the variance of the block's mean times the number of its pixels, as castray's have: it is less noisy than their own."""
    images, seconds = map(np.array, zip(*[render(arguments.seed + i) for i in range(arguments.replicates)]))
    mean, variance = images.mean(axis=0), np.empty_like(images[0])
    height, width, _ = mean.shape
    for y in range(0, height, 8):
        for x in range(0, width, 8):
            block = images[:, y:y + 8, x:x + 8]
            pixels = block.shape[1] * block.shape[2]
            variance[y:y + 8, x:x + 8] = block.mean(axis=(1, 2)).var(axis=0, ddof=1) * pixels / arguments.replicates
    return mean, variance, seconds.sum()


def main():
    arguments, scene = peer.parse(__doc__, options)
    scene.refuse("mitsuba")
    if arguments.variant.startswith("llvm"):
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1")
    import mitsuba as mi
    mi.set_variant(arguments.variant)
    mi.set_log_level(mi.LogLevel.Error)  # its warnings, of rounded sample counts, go to stdout
    with tempfile.TemporaryDirectory() as folder:
        loaded = mi.load_dict(scene_dictionary(mi, scene, arguments, folder))

    def render(seed):
        start = time.perf_counter()
        pixels = np.array(mi.render(loaded, seed=seed, spp=arguments.spp))
        return pixels, time.perf_counter() - start

    if arguments.variant.startswith("llvm"):
        render(arguments.seed + 1)  # compiles the kernels, which is not counted
    if arguments.replicates == 1:
        peer.finish(arguments, *render(arguments.seed))
    else:
        mean, variance, seconds = replicated(render, arguments)
        peer.write_pfm(arguments.out.removesuffix(".pfm") + ".variance.pfm", variance)
        peer.finish(arguments, mean, seconds)


main()

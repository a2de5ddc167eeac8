"""Renders a castray scene with Blender's Cycles on the CPU, without any of its biased shortcuts."""

import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

import peer
from cycles_scene import add_camera, add_light, add_mesh, set_environment

EQUALS = ("lenses", "orthographic cameras", "panorama cameras", "shifted images", "images of the environment", "point lights",
          "spot lights", "directional lights", "instances", "pairs", "principled metal", "two-sided emission",
          "metals by index", "absorption", "coverage", "images")


def options(parser):
    parser.add_argument("--light-tree", choices=["on", "off", "auto"], default="auto",
                        help="auto: on for more than two emitting triangles")
    parser.add_argument("--guiding", choices=["on", "off", "auto"], default="auto",
                        help="path guiding; auto: on for scenes with conductors, where it pays")
    parser.add_argument("--clock", choices=["wall", "processor"], default="wall",
                        help="what the seconds are: by Cycles' own clock, or of the processor, beyond those of one sample")
    parser.add_argument("--sequence", default="TABULATED_SOBOL", help="TABULATED_SOBOL, BLUE_NOISE")


def set_up(scene, arguments):
    target = bpy.context.scene
    target.render.engine = "CYCLES"
    target.render.resolution_x, target.render.resolution_y = scene.width, scene.height
    target.render.resolution_percentage = 100
    target.render.use_compositing = target.render.use_sequencer = False
    target.view_settings.view_transform = "Raw"
    target.display_settings.display_device = "sRGB"
    target.render.image_settings.file_format = "OPEN_EXR"
    target.render.image_settings.color_depth = "32"
    cycles = target.cycles
    cycles.device = "CPU"
    cycles.seed = arguments.seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sampling_pattern = arguments.sequence
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    for kind in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, f"{kind}_bounces", 128)
    cycles.transparent_max_bounces = 128
    cycles.use_light_tree = scene.emitting_triangles > 2 if arguments.light_tree == "auto" else arguments.light_tree == "on"
    conductors = any(mesh.material.type == "conductor" for mesh in scene.meshes)
    cycles.use_guiding = conductors if arguments.guiding == "auto" else arguments.guiding == "on"


def render_seconds(file):
    """What Cycles itself says in the EXR's header: without synchronisation of the scene."""
    header = Path(file).read_bytes()[:65536]
    place = header.index(b".render_time\0")
    value = header[place:].split(b"string\0", 1)[1]
    text = value[4:4 + int.from_bytes(value[:4], "little")].decode()
    seconds = 0.0
    for part in text.split(":"):
        seconds = 60 * seconds + float(part)
    return seconds


def render(spp):
    """The processor's seconds."""
    start = time.process_time()
    bpy.context.scene.cycles.samples = spp
    bpy.ops.render.render(write_still=True)
    return time.process_time() - start


def rendered_seconds(arguments, file):
    """Writes the image; synchronisation of the scene and the tree are in neither clock."""
    if arguments.clock == "wall":
        render(arguments.spp)
        return render_seconds(file)
    render(1)  # reads what the next ones have in memory
    first = render(1)
    return (render(arguments.spp) - first) * arguments.spp / (arguments.spp - 1)


def main():
    arguments, scene = peer.parse(__doc__, options)
    scene.refuse("cycles", EQUALS)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shaders = {}
    for mesh in scene.meshes:
        add_mesh(mesh, shaders)
    for light in scene.lights:
        add_light(light)
    add_camera(scene)
    set_environment(scene.environment)
    set_up(scene, arguments)
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/image.exr"
        bpy.context.scene.render.filepath = file
        seconds = rendered_seconds(arguments, file)
        image = bpy.data.images.load(file)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(scene.width * scene.height * 4, np.float32)
        image.pixels.foreach_get(pixels)
    peer.finish(arguments, pixels.reshape(scene.height, scene.width, 4)[::-1, :, :3], seconds)


main()

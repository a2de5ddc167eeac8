"""Renders a castray scene with Blender's Cycles on the CPU, without any of its biased shortcuts."""

import tempfile
from pathlib import Path

import bpy
import mathutils
import numpy as np

import peer


def options(parser):
    parser.add_argument("--light-tree", choices=["on", "off", "auto"], default="auto",
                        help="auto: on for more than two emitting triangles")
    parser.add_argument("--guiding", choices=["on", "off", "auto"], default="auto",
                        help="path guiding; auto: on for scenes with conductors, where it pays")
    parser.add_argument("--sequence", default="TABULATED_SOBOL", help="TABULATED_SOBOL, BLUE_NOISE")


def shader(source, front_only=True):
    """A Blender material equal to castray's."""
    material = bpy.data.materials.new(source.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    if source.type == "diffuse":
        surface = nodes.new("ShaderNodeBsdfDiffuse")
        surface.inputs["Color"].default_value = (*source.kd, 1)
        surface.inputs["Roughness"].default_value = 0
    elif source.type == "conductor":
        surface = nodes.new("ShaderNodeBsdfAnisotropic")
        surface.distribution = "GGX"
        surface.inputs["Color"].default_value = (*source.reflectance, 1)
        surface.inputs["Roughness"].default_value = source.alpha ** 0.5
    else:
        surface = nodes.new("ShaderNodeBsdfGlass")
        surface.distribution = "GGX"
        surface.inputs["Color"].default_value = (1, 1, 1, 1)
        surface.inputs["Roughness"].default_value = source.alpha ** 0.5
        surface.inputs["IOR"].default_value = source.ior
    if not source.emits:
        links.new(surface.outputs[0], output.inputs["Surface"])
        return material
    strength = max(source.ke)
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (*(component / strength for component in source.ke), 1)
    front = nodes.new("ShaderNodeMath")  # strength * (1 - backfacing)
    front.operation = "MULTIPLY_ADD"
    front.inputs[1].default_value, front.inputs[2].default_value = -strength, strength
    total = nodes.new("ShaderNodeAddShader")
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], front.inputs[0])
    links.new(front.outputs[0], emission.inputs["Strength"])
    links.new(surface.outputs[0], total.inputs[0])
    links.new(emission.outputs[0], total.inputs[1])
    links.new(total.outputs[0], output.inputs["Surface"])
    material.cycles.emission_sampling = "FRONT"
    return material


def add_mesh(mesh, shaders):
    data = bpy.data.meshes.new(mesh.material.name)
    count = len(mesh.triangles)
    data.vertices.add(len(mesh.positions))
    data.vertices.foreach_set("co", mesh.positions.astype(np.float32).ravel())
    data.loops.add(3 * count)
    data.loops.foreach_set("vertex_index", np.ascontiguousarray(mesh.triangles).astype(np.int32).ravel())
    data.polygons.add(count)
    data.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    data.update()
    data.shade_flat()
    if mesh.normals is not None:
        data.shade_smooth()
        data.normals_split_custom_set(mesh.normals.reshape(-1, 3))
    if mesh.material.name not in shaders:
        shaders[mesh.material.name] = shader(mesh.material)
    data.materials.append(shaders[mesh.material.name])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(mesh.material.name, data))


def add_camera(scene):
    forward = mathutils.Vector(scene.look_at - scene.position).normalized()
    right = forward.cross(mathutils.Vector(scene.up)).normalized()
    columns = (right, right.cross(forward), -forward, mathutils.Vector(scene.position))
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "VERTICAL", np.radians(scene.fov)
    data.clip_start, data.clip_end = 1e-3, 1e6
    camera = bpy.data.objects.new("camera", data)
    camera.matrix_world = mathutils.Matrix([[*(column[row] for column in columns)] for row in range(3)] + [[0, 0, 0, 1]])
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


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
    cycles.samples, cycles.seed = arguments.spp, arguments.seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sampling_pattern = arguments.sequence
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    for kind in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, f"{kind}_bounces", 128)
    cycles.use_light_tree = scene.lights > 2 if arguments.light_tree == "auto" else arguments.light_tree == "on"
    conductors = any(mesh.material.type == "conductor" for mesh in scene.meshes)
    cycles.use_guiding = conductors if arguments.guiding == "auto" else arguments.guiding == "on"
    target.world = bpy.data.worlds.new("world")
    target.world.use_nodes = True
    background = target.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*scene.environment, 1)


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


def main():
    arguments, scene = peer.parse(__doc__, options)
    scene.refuse("cycles", types=("microfacet",))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shaders = {}
    for mesh in scene.meshes:
        add_mesh(mesh, shaders)
    add_camera(scene)
    set_up(scene, arguments)
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/image.exr"
        bpy.context.scene.render.filepath = file
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(file)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(scene.width * scene.height * 4, np.float32)
        image.pixels.foreach_get(pixels)
        seconds = render_seconds(file)
    peer.finish(arguments, pixels.reshape(scene.height, scene.width, 4)[::-1, :, :3], seconds)


main()

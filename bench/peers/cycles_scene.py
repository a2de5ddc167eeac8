"""A castray scene in Blender: meshes, camera, lights and environment."""

import bpy
import mathutils
import numpy as np

from cycles_shaders import Shader


def add(name, data, matrix=None):
    thing = bpy.data.objects.new(name, data)
    if matrix is not None:
        thing.matrix_world = mathutils.Matrix(matrix)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def facing(position, forward, up):
    """The matrix of what looks along -z, with y upwards."""
    forward = mathutils.Vector(forward).normalized()
    right = forward.cross(mathutils.Vector(up)).normalized()
    columns = (right, right.cross(forward), -forward, mathutils.Vector(position))
    return [[*(column[row] for column in columns)] for row in range(3)] + [[0, 0, 0, 1]]


def add_mesh(mesh, shaders):
    data = bpy.data.meshes.new(mesh.material.name)
    count = len(mesh.triangles)
    data.vertices.add(len(mesh.positions))
    data.vertices.foreach_set("co", mesh.positions.astype(np.float32).ravel())
    data.loops.add(3 * count)
    data.loops.foreach_set("vertex_index", np.ascontiguousarray(mesh.triangles).astype(np.int32).ravel())
    data.polygons.add(count)
    data.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    if mesh.uvs is not None:
        data.uv_layers.new().data.foreach_set("uv", np.ascontiguousarray(mesh.uvs, np.float32).ravel())
    data.update()
    data.shade_flat()
    if mesh.normals is not None:
        data.shade_smooth()
        data.normals_split_custom_set(mesh.normals.reshape(-1, 3))
    if mesh.material.name not in shaders:
        shaders[mesh.material.name] = Shader(mesh.material).material
    data.materials.append(shaders[mesh.material.name])
    for place in mesh.places or [None]:  # Cycles has one tree for objects that share their mesh
        add(mesh.material.name, data, place)


def add_camera(scene):
    source, data = scene.camera, bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.clip_start, data.clip_end = 1e-3, 1e6
    if source.type == "orthographic":
        data.type, data.ortho_scale = "ORTHO", source.height
        data.clip_start = 0
    elif source.type == "panorama":
        data.type, data.panorama_type = "PANO", "EQUIRECTANGULAR"
    else:
        data.angle = np.radians(source.fov)
    data.shift_x, data.shift_y = source.shift[0] * scene.width / scene.height, source.shift[1]
    if source.lens:
        data.dof.use_dof, data.dof.focus_distance = True, source.lens.focus_distance
        data.dof.aperture_fstop = 1e-3 * data.lens / (2 * source.lens.radius)
        data.dof.aperture_blades = source.lens.blades
    bpy.context.scene.camera = add("camera", data, facing(source.position, source.look_at - source.position, source.up))


def add_light(entry):
    kind = {"point": "POINT", "spot": "SPOT", "directional": "SUN"}[entry["type"]]
    data = bpy.data.lights.new(entry["type"], kind)
    power = np.broadcast_to(entry.get("intensity", entry.get("irradiance")), 3).astype(float)
    strength = power.max()
    data.color = power / strength
    position = np.array(entry.get("position", [0, 0, 0]), float)
    forward = entry.get("direction", [0, -1, 0])
    if kind == "SUN":
        data.energy, data.angle = strength, 0
    else:
        data.energy, data.shadow_soft_size = 4 * np.pi * strength, 0
    if kind == "SPOT":
        data.spot_size, data.spot_blend = 2 * np.radians(entry.get("outer_angle", 45)), 0
        if "look_at" in entry:
            forward = np.array(entry["look_at"], float) - position
    up = [1, 0, 0] if abs(forward[1]) > 0.9 * np.linalg.norm(forward) else [0, 1, 0]
    add(entry["type"], data, facing(position, forward, up))


def set_environment(environment):
    world = bpy.context.scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    color = nodes["Background"].inputs["Color"]
    color.default_value = (*environment.radiance, 1)
    if not environment.file:
        return
    # castray's +z, +x, +y are the x, y, z of Cycles' latitude and longitude.
    turn = nodes.new("ShaderNodeVectorRotate")
    turn.rotation_type = "Y_AXIS"
    turn.inputs["Angle"].default_value = -np.radians(environment.rotation)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], turn.inputs["Vector"])
    split, joined = nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeCombineXYZ")
    links.new(turn.outputs[0], split.inputs[0])
    for place, axis in enumerate("ZXY"):
        links.new(split.outputs[axis], joined.inputs[place])
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(str(environment.file))
    texture.image.colorspace_settings.name = "Non-Color"
    texture.interpolation = "Closest"
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 2048  # by itself it takes the image's
    links.new(joined.outputs[0], texture.inputs[0])
    scaled = nodes.new("ShaderNodeVectorMath")
    scaled.operation, scaled.inputs[1].default_value = "MULTIPLY", environment.scale
    links.new(texture.outputs[0], scaled.inputs[0])
    links.new(scaled.outputs[0], color)

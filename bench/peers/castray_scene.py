"""Reads castray's scene files into plain arrays, for the adapters of the peer renderers."""

import json
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tinyobjloader

from castray_materials import Material, grey, json_material, mtl_material, no_equal, no_equal_of


@dataclass
class Mesh:
    """Triangles of one material; `normals` and `uvs`, if any, are one per corner: (triangles, 3, 3) and (triangles, 3, 2).
    `places` are the matrices of its copies, if it is an instance's."""

    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None
    uvs: np.ndarray | None
    material: Material
    places: list | None = None


@dataclass
class Lens:
    radius: float
    focus_distance: float
    blades: int
    rotation: float  # degrees


@dataclass
class Camera:
    """`type` and units as in docs/scenes.md; `fov` is vertical, in degrees."""

    position: np.ndarray
    look_at: np.ndarray
    up: np.ndarray
    type: str = "perspective"
    fov: float = 40
    height: float = 0
    shift: tuple = (0, 0)
    lens: Lens | None = None


@dataclass
class Environment:
    """A radiance, or an image of it."""

    radiance: list
    file: Path | None = None
    scale: list = field(default_factory=lambda: [1, 1, 1])
    rotation: float = 0  # degrees


@dataclass
class Scene:
    camera: Camera
    width: int
    height: int
    environment: Environment
    meshes: list
    lights: list  # without size: the scene file's entries

    @property
    def emitting_triangles(self):
        return sum(len(mesh.triangles) for mesh in self.meshes if mesh.material.emits)

    def features(self):
        """What not every renderer has, by name."""
        if self.camera.type != "perspective":
            yield f"{self.camera.type} cameras"
        if self.camera.lens:
            yield "lenses"
        if any(self.camera.shift):
            yield "shifted images"
        if self.environment.file:
            yield "images of the environment"
        for light in self.lights:
            yield f"{light['type']} lights"
        for mesh in self.meshes:
            if mesh.places:
                yield "instances"
            yield from mesh.material.features()

    def refuse(self, peer, equals=()):
        """Stops where the peer has no equal of what the scene asks for; `equals` are the features that it has."""
        for feature in self.features():
            if feature not in equals:
                no_equal(f"{peer}: no equal of {feature}")


def read_commented_json(path):
    text = Path(path).read_text(encoding="utf-8-sig")
    without = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda m: m[1] or " ", text, flags=re.S)
    return json.loads(without)


def matrix_of_rows(numbers):
    return np.vstack([np.reshape(numbers, (3, 4)), [0, 0, 0, 1]])


def transform_matrix(steps):
    """The product of the steps, the first applied first."""
    matrix = np.eye(4)
    for step in steps:
        (kind, value), = step.items()
        one = np.eye(4)
        if kind == "scale":
            one[:3, :3] *= np.broadcast_to(value, 3)
        elif kind == "translate":
            one[:3, 3] = value
        elif kind == "rotate":
            x, y, z = np.asarray(value[:3]) / np.linalg.norm(value[:3])
            angle = math.radians(value[3])
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            one[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
        else:
            one = matrix_of_rows(value)
        matrix = one @ matrix
    return matrix


def read_obj(path, matrix, material, use_normals):
    """The OBJ's meshes, one a material."""
    reader = tinyobjloader.ObjReader()
    config = tinyobjloader.ObjReaderConfig()
    config.triangulate = True
    if not reader.ParseFromFile(str(path), config):
        raise SystemExit(f"{path}: {reader.Error()}")
    attributes = reader.GetAttrib()
    positions = np.array(attributes.vertices, np.float64).reshape(-1, 3)
    positions = positions @ matrix[:3, :3].T + matrix[:3, 3]
    normals = np.array(attributes.normals, np.float64).reshape(-1, 3)
    texture_points = np.array(attributes.texcoords, np.float64).reshape(-1, 2)
    meshes = [shape.mesh for shape in reader.GetShapes()]

    def corners(read):  # as lists: the binding's numpy views have broken strides
        return np.concatenate([np.array(read(mesh), np.int64) for mesh in meshes])

    def of_corners(values, indices):
        indices = indices.reshape(-1, 3)
        return values[indices] if len(values) and (indices >= 0).all() else None

    triangles = corners(lambda mesh: mesh.vertex_indices()).reshape(-1, 3).astype(np.uint32)
    corner_normals = of_corners(normals, corners(lambda mesh: mesh.normal_indices())) if use_normals else None
    uvs = of_corners(texture_points, corners(lambda mesh: mesh.texcoord_indices()))
    owners = corners(lambda mesh: mesh.material_ids)
    if corner_normals is not None:
        corner_normals = corner_normals @ np.linalg.inv(matrix[:3, :3])
        corner_normals /= np.linalg.norm(corner_normals, axis=2, keepdims=True)
    if np.linalg.det(matrix[:3, :3]) < 0:
        triangles, corner_normals, uvs = (
            values if values is None else values[:, ::-1] for values in (triangles, corner_normals, uvs))
    if material:
        return [Mesh(positions, triangles, corner_normals, uvs, material)]
    sources = reader.GetMaterials()
    by_material = []
    for owner in np.unique(owners):
        chosen = owners == owner
        mapped = mtl_material(sources[owner]) if owner >= 0 else Material(name="default")
        chosen_normals, chosen_uvs = (values if values is None else values[chosen] for values in (corner_normals, uvs))
        by_material.append(Mesh(positions, triangles[chosen], chosen_normals, chosen_uvs, mapped))
    return by_material


def read_meshes(entries, materials, folder):
    meshes = []
    for entry in entries:
        no_equal_of("mesh", entry, ["obj", "material", "transform", "normals"])
        material = materials[entry["material"]] if "material" in entry else None
        meshes += read_obj(folder / entry["obj"], transform_matrix(entry.get("transform", [])), material,
                           entry.get("normals", "file") == "file")
    return meshes


def read_instances(source, materials, folder):
    meshes = []
    for entry in source.get("instances", []):
        no_equal_of("instance", entry, ["object", "transform", "transforms"])
        after = transform_matrix(entry.get("transform", []))
        places = [after @ matrix_of_rows(rows) for rows in entry.get("transforms", [np.eye(4)[:3]])]
        for mesh in read_meshes(source["objects"][entry["object"]], materials, folder):
            mesh.places = places
            meshes.append(mesh)
    return meshes


def read_camera(entry):
    no_equal_of("camera", entry, ["type", "position", "look_at", "up", "fov", "height", "shift", "lens"])
    position, look_at = np.array(entry["position"], float), np.array(entry["look_at"], float)
    camera = Camera(position, look_at, np.array(entry.get("up", [0, 1, 0]), float), entry.get("type", "perspective"),
                    entry.get("fov", 40), entry.get("height", 0), tuple(entry.get("shift", (0, 0))))
    if "lens" in entry:
        lens = entry["lens"]
        no_equal_of("lens", lens, ["radius", "f_number", "sensor_height", "focus_distance", "blades", "rotation"])
        focal_length = lens.get("sensor_height", 0) / (2 * math.tan(math.radians(camera.fov) / 2))
        radius = lens["radius"] if "radius" in lens else focal_length / (2 * lens["f_number"])
        distance = lens.get("focus_distance", np.linalg.norm(look_at - position))
        camera.lens = Lens(radius, distance, lens.get("blades", 0), lens.get("rotation", 0))
    return camera


def read_environment(entry, folder):
    no_equal_of("environment", entry, ["radiance", "image", "scale", "rotation"])
    file = folder / entry["image"] if "image" in entry else None
    return Environment(grey(entry.get("radiance", 0)), file, grey(entry.get("scale", 1)), entry.get("rotation", 0))


def read_scene(path):
    path = Path(path)
    source = read_commented_json(path)
    no_equal_of("scene", source, ["$schema", "camera", "image", "materials", "meshes", "objects", "instances", "lights",
                                  "environment", "instancing", "render"])
    described = source.get("materials", {})
    materials = {name: json_material(name, entry, path.parent, described) for name, entry in described.items()}
    meshes = read_meshes(source.get("meshes", []), materials, path.parent) + read_instances(source, materials, path.parent)
    image = source.get("image", {})
    return Scene(camera=read_camera(source["camera"]), width=image.get("width", 784), height=image.get("height", 784),
                 environment=read_environment(source.get("environment", {}), path.parent), meshes=meshes,
                 lights=source.get("lights", []))

"""Reads castray's scene files into plain arrays, for the adapters of the peer renderers."""

import json
import math
import re
import sys
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np
import tinyobjloader


@dataclass
class Material:
    """Colours are linear RGB; `ke` is emitted radiance."""

    name: str
    type: str = "diffuse"
    kd: list = field(default_factory=lambda: [0.5, 0.5, 0.5])
    ks: list = field(default_factory=lambda: [0.0, 0.0, 0.0])
    reflectance: list = field(default_factory=lambda: [0.8, 0.8, 0.8])
    ke: list = field(default_factory=lambda: [0.0, 0.0, 0.0])
    alpha: float = 0.0
    ior: float = 1.5
    two_sided_emission: bool = False

    @property
    def emits(self):
        return max(self.ke) > 0


@dataclass
class Mesh:
    """Triangles of one material; `normals`, if any, are one per corner: (triangles, 3, 3)."""

    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None
    material: Material


@dataclass
class Scene:
    position: np.ndarray
    look_at: np.ndarray
    up: np.ndarray
    fov: float  # vertical, degrees
    width: int
    height: int
    environment: list
    meshes: list

    @property
    def lights(self):
        """The number of emitting triangles."""
        return sum(len(mesh.triangles) for mesh in self.meshes if mesh.material.emits)

    def refuse(self, peer, types=()):
        """Stops, with the exit code that tells `castray bench` so, where the peer has no equal of what the scene asks for."""
        for mesh in self.meshes:
            material = mesh.material
            if material.type in types:
                no_equal(f"{peer}: material '{material.name}': no equal of '{material.type}'")
            if material.emits and material.two_sided_emission:
                no_equal(f"{peer}: material '{material.name}': no equal of two-sided emission")


def no_equal(message):
    print(message, file=sys.stderr)
    raise SystemExit(77)


def read_commented_json(path):
    text = Path(path).read_text(encoding="utf-8-sig")
    without = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda m: m[1] or " ", text, flags=re.S)
    return json.loads(without)


def no_equal_of(what, entry, known):
    """Stops where the entry asks for something that is not exported to peers."""
    for key in entry:
        if key not in known:
            no_equal(f"{what}: no equal of '{key}'")


def json_material(name, entry):
    names = [known.name for known in fields(Material)]
    no_equal_of(f"material '{name}'", entry, names + ["roughness"])
    if entry.get("type", "diffuse") not in ("diffuse", "conductor", "dielectric", "microfacet"):
        no_equal(f"material '{name}': no equal of '{entry['type']}'")
    values = {"name": name}
    for key, value in entry.items():
        if isinstance(value, dict) or (isinstance(value, str) and key != "type"):
            no_equal(f"material '{name}': no equal of this {key}")
        grey = key in ("kd", "ks", "reflectance", "ke") and not isinstance(value, list)
        values[key] = [value] * 3 if grey else value
    roughness = values.pop("roughness", None)
    material = Material(**values)
    if roughness is not None:
        material.alpha = roughness ** 2
    return material


def mtl_material(source):
    """The mapping that `castray info` prints, without textures."""
    if source.diffuse_texname:
        raise SystemExit(f"material '{source.name}': textures are not exported to peers")
    material = Material(name=source.name, kd=list(source.diffuse), ke=list(source.emission))
    glossy_alpha = math.sqrt(2 / (source.shininess + 2))
    if source.illum in (3, 5) or source.metallic == 1:
        material.type, material.reflectance, material.alpha = "conductor", list(source.specular), glossy_alpha
    elif source.illum in (4, 6, 7, 9) and source.ior > 1:
        material.type, material.ior = "dielectric", source.ior
    elif max(source.specular) > 0:
        material.type, material.ks, material.alpha = "microfacet", list(source.specular), glossy_alpha
    return material


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
            raise SystemExit(f"transform '{kind}' is not exported to peers")
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
    meshes = [shape.mesh for shape in reader.GetShapes()]

    def corners(read):  # as lists: the binding's numpy views have broken strides
        return np.concatenate([np.array(read(mesh), np.int64) for mesh in meshes])

    triangles = corners(lambda mesh: mesh.vertex_indices()).reshape(-1, 3).astype(np.uint32)
    normal_indices = corners(lambda mesh: mesh.normal_indices()).reshape(-1, 3)
    owners = corners(lambda mesh: mesh.material_ids)
    if np.linalg.det(matrix[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    corner_normals = None
    if use_normals and len(normals) and (normal_indices >= 0).all():
        corner_normals = normals[normal_indices] @ np.linalg.inv(matrix[:3, :3])
        corner_normals /= np.linalg.norm(corner_normals, axis=2, keepdims=True)
        if np.linalg.det(matrix[:3, :3]) < 0:
            corner_normals = corner_normals[:, ::-1]
    if material:
        return [Mesh(positions, triangles, corner_normals, material)]
    sources = reader.GetMaterials()
    by_material = []
    for owner in np.unique(owners):
        chosen = owners == owner
        mapped = mtl_material(sources[owner]) if owner >= 0 else Material(name="default")
        chosen_normals = corner_normals[chosen] if corner_normals is not None else None
        by_material.append(Mesh(positions, triangles[chosen], chosen_normals, mapped))
    return by_material


def read_scene(path):
    path = Path(path)
    source = read_commented_json(path)
    no_equal_of("scene", source, ["$schema", "camera", "image", "materials", "meshes", "environment", "render"])
    no_equal_of("camera", source["camera"], ["position", "look_at", "up", "fov"])
    no_equal_of("environment", source.get("environment", {}), ["radiance"])
    materials = {name: json_material(name, entry) for name, entry in source.get("materials", {}).items()}
    meshes = []
    for entry in source["meshes"]:
        material = materials[entry["material"]] if "material" in entry else None
        meshes += read_obj(path.parent / entry["obj"], transform_matrix(entry.get("transform", [])), material,
                           entry.get("normals", "file") == "file")
    camera = source["camera"]
    image = source.get("image", {})
    return Scene(position=np.array(camera["position"], float), look_at=np.array(camera["look_at"], float),
                 up=np.array(camera.get("up", [0, 1, 0]), float), fov=camera["fov"],
                 width=image.get("width", 784), height=image.get("height", 784),
                 environment=source.get("environment", {}).get("radiance", [0, 0, 0]), meshes=meshes)

"""Materials of castray's scene files and of MTL, as plain values, for the adapters of the peer renderers."""

import math
import sys
from dataclasses import dataclass, field, fields
from pathlib import Path

COLOURS = ("kd", "ks", "reflectance", "ke")


@dataclass
class Image:
    """factor (base + gain texel(scale (u,v) + offset)); `linear` texels hold no sRGB curve."""

    file: Path
    linear: bool
    scale: list = field(default_factory=lambda: [1, 1])
    offset: list = field(default_factory=lambda: [0, 0])
    factor: list = field(default_factory=lambda: [1, 1, 1])
    base: float = 0.0
    gain: float = 1.0
    clamp: bool = False


@dataclass
class Material:
    """Colours are linear RGB or an Image; `ke` is emitted radiance. A `reflectance` may be {"eta": [...], "k": [...]}."""

    name: str
    type: str = "diffuse"
    kd: list = field(default_factory=lambda: [0.5, 0.5, 0.5])
    ks: list = field(default_factory=lambda: [0.0, 0.0, 0.0])
    reflectance: list = field(default_factory=lambda: [0.8, 0.8, 0.8])
    ke: list = field(default_factory=lambda: [0.0, 0.0, 0.0])
    roughness: float = 0.0
    metallic: float = 0.0
    ior: float = 1.5
    absorption: list = field(default_factory=lambda: [0.0, 0.0, 0.0])
    coverage: float = 1.0
    normal_map: Image | None = None
    bump_map: Image | None = None
    front: "Material | None" = None
    back: "Material | None" = None
    two_sided_emission: bool = False

    @property
    def alpha(self):
        return self.roughness ** 2

    @property
    def emits(self):
        """Of a pair, whether its front does."""
        shining = self.front or self
        return isinstance(shining.ke, Image) or max(shining.ke) > 0

    def features(self):
        """What not every renderer has, by name."""
        for side in filter(None, (self.front, self.back)):
            yield "pairs"
            yield from side.features()
        if self.back and self.back.emits:
            yield "backs that emit"
        if self.type not in ("diffuse", "conductor", "dielectric", "two_sided"):
            yield self.type if self.metallic != 1 else f"{self.type} metal"
        if self.emits and self.two_sided_emission:
            yield "two-sided emission"
        if isinstance(self.reflectance, dict):
            yield "metals by index"
        if max(self.absorption) > 0:
            yield "absorption"
        if self.coverage != 1:
            yield "coverage"
        for known in fields(self):
            if isinstance(getattr(self, known.name), Image):
                yield "images"


def no_equal(message):
    """The exit code tells `castray bench` that the peer has no equal of the scene."""
    print(message, file=sys.stderr)
    raise SystemExit(77)


def no_equal_of(what, entry, known):
    """Stops where the entry asks for something that is not exported to peers."""
    for key in entry:
        if key not in known:
            no_equal(f"{what}: no equal of '{key}'")


def grey(value):
    return value if isinstance(value, (list, dict, Image)) else [value] * 3


def image_of(what, key, entry, folder):
    no_equal_of(f"{what}: image of '{key}'", entry, [known.name for known in fields(Image)] + ["image", "color_space"])
    values = {name: value for name, value in entry.items() if name not in ("image", "color_space")}
    if "factor" in values:
        values["factor"] = grey(values["factor"])
    space = entry.get("color_space", "srgb" if key in COLOURS else "linear")
    return Image(file=folder / entry["image"], linear=space == "linear", **values)




def parameter(what, key, value, folder):
    if isinstance(value, dict) and "image" in value:
        if key == "alpha":
            no_equal(f"{what}: no equal of an image as 'alpha'")
        return image_of(what, key, value, folder)
    metal = key == "reflectance" and isinstance(value, dict) and set(value) == {"eta", "k"}
    if isinstance(value, str) or (isinstance(value, dict) and not metal):
        no_equal(f"{what}: no equal of this {key}")
    return grey(value) if key in COLOURS + ("absorption",) else value


def json_material(name, entry, folder, others):
    """`others`, by name, may be sides of a pair."""
    what = f"material '{name}'"
    known = [known.name for known in fields(Material)] + ["alpha"]
    no_equal_of(what, entry, known)
    kind = entry.get("type", "diffuse")
    if kind not in ("diffuse", "conductor", "dielectric", "microfacet", "principled", "two_sided"):
        no_equal(f"{what}: no equal of '{kind}'")
    values = {"name": name, "type": kind}
    for key, value in entry.items():
        if key in ("front", "back"):
            side = others[value] if isinstance(value, str) else value
            values[key] = json_material(f"{name}, {key}", side, folder, others)
        elif key == "alpha":
            values["roughness"] = math.sqrt(parameter(what, key, value, folder))
        elif key != "type":
            values[key] = parameter(what, key, value, folder)
    return Material(**values)


def mtl_material(source):
    """The mapping that `castray info` prints, without textures."""
    if source.diffuse_texname:
        no_equal(f"material '{source.name}': images of MTL are not exported to peers")
    material = Material(name=source.name, kd=list(source.diffuse), ke=list(source.emission))
    glossy_roughness = (2 / (source.shininess + 2)) ** 0.25
    if source.illum in (3, 5) or source.metallic == 1:
        material.type, material.reflectance, material.roughness = "conductor", list(source.specular), glossy_roughness
    elif source.illum in (4, 6, 7, 9) and source.ior > 1:
        material.type, material.ior = "dielectric", source.ior
    elif max(source.specular) > 0:
        material.type, material.ks, material.roughness = "microfacet", list(source.specular), glossy_roughness
    return material

"""Blender materials that are equal to castray's."""

import bpy
import numpy as np

from castray_materials import Image, no_equal


def linear_image(image):
    """The image in floats: between texels of 8 bits Cycles interpolates what sRGB's curve has made of radiance."""
    source = bpy.data.images.load(str(image.file))
    source.colorspace_settings.name = "Non-Color"
    texels = np.empty(len(source.pixels), np.float32)
    source.pixels.foreach_get(texels)
    if not image.linear:
        colors = texels.reshape(-1, 4)[:, :3]
        colors[:] = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    result = bpy.data.images.new(source.name, *source.size, alpha=True, float_buffer=True, is_data=True)
    result.pixels.foreach_set(texels)
    result.update()
    return result


class Shader:
    """The nodes of one material."""

    def __init__(self, source):
        self.material = bpy.data.materials.new(source.name)
        self.material.use_nodes = True
        self.material.cycles.use_bump_map_correction = False
        self.nodes, self.links = self.material.node_tree.nodes, self.material.node_tree.links
        self.nodes.clear()
        output = self.nodes.new("ShaderNodeOutputMaterial")
        surface = self.covered(source, self.surface(source))
        self.links.new(surface, output.inputs["Surface"])
        if max(source.absorption) > 0:
            self.links.new(self.absorption(source.absorption), output.inputs["Volume"])
        if source.emits and not source.two_sided_emission:
            self.material.cycles.emission_sampling = "FRONT"

    def node(self, kind, values=(), **properties):
        """A node with its inputs, by name or number: sockets, images or constants."""
        node = self.nodes.new(f"ShaderNode{kind}")
        for name, value in properties.items():
            setattr(node, name, value)
        for key, value in dict(values).items():
            socket = node.inputs[key]
            if isinstance(value, Image):
                value = self.image(value)
            if isinstance(value, bpy.types.NodeSocket):
                self.links.new(value, socket)
            elif isinstance(value, (list, tuple)) and len(socket.default_value) == 4:
                socket.default_value = (*value, 1)
            else:
                socket.default_value = value
        return node

    def image(self, image):
        uv = self.nodes.new("ShaderNodeUVMap").outputs[0]
        for operation, vector in (("MULTIPLY", image.scale), ("ADD", image.offset)):
            uv = self.node("VectorMath", {0: uv, 1: (*vector, 0)}, operation=operation).outputs[0]
        texture = self.node("TexImage", {"Vector": uv}, image=linear_image(image), interpolation="Linear",
                            extension="EXTEND" if image.clamp else "REPEAT")
        factor = [image.factor] * 3 if isinstance(image.factor, (int, float)) else image.factor
        scaled = {0: texture.outputs["Color"], 1: [f * image.gain for f in factor], 2: [f * image.base for f in factor]}
        return self.node("VectorMath", scaled, operation="MULTIPLY_ADD").outputs[0]

    def surface(self, source):
        """Reflection, refraction and emission."""
        if source.type == "two_sided":
            sides = [self.surface(side) for side in (source.front, source.back)]
            return self.node("MixShader", {0: self.backfacing(), 1: sides[0], 2: sides[1]}).outputs[0]
        lobe = self.lobe(source)
        if source.normal_map or source.bump_map:
            self.links.new(self.normal(source), lobe.inputs["Normal"])
        if not source.emits:
            return lobe.outputs[0]
        return self.node("AddShader", {0: lobe.outputs[0], 1: self.emission(source)}).outputs[0]

    def lobe(self, source):
        if source.type == "diffuse":
            return self.node("BsdfDiffuse", {"Color": source.kd, "Roughness": 0})
        if source.type == "dielectric":
            return self.node("BsdfGlass", {"Color": [1, 1, 1], "Roughness": source.roughness, "IOR": source.ior},
                             distribution="GGX")
        if source.type == "principled":  # all metal
            return self.node("BsdfPrincipled", {"Base Color": source.kd, "Metallic": 1, "Roughness": source.roughness},
                             distribution="GGX")
        if isinstance(source.reflectance, dict):
            index = {"IOR": source.reflectance["eta"], "Extinction": source.reflectance["k"]}
            return self.node("BsdfMetallic", {**index, "Roughness": source.roughness}, distribution="GGX",
                             fresnel_type="PHYSICAL_CONDUCTOR")
        return self.node("BsdfAnisotropic", {"Color": source.reflectance, "Roughness": source.roughness},
                         distribution="GGX")

    def normal(self, source):
        if source.bump_map:
            height = self.image(source.bump_map)
            return self.node("Bump", {"Height": height, "Strength": 1, "Distance": 1}).outputs[0]
        if source.normal_map.gain != 1:
            no_equal("cycles: no equal of a normal map's gain")
        return self.node("NormalMap", {"Color": source.normal_map}).outputs[0]

    def emission(self, source):
        strength = 1.0 if isinstance(source.ke, Image) else max(source.ke)
        color = source.ke if isinstance(source.ke, Image) else [component / strength for component in source.ke]
        if not source.two_sided_emission:  # strength * (1 - backfacing)
            strength = self.node("Math", {0: self.backfacing(), 1: -strength, 2: strength},
                                 operation="MULTIPLY_ADD").outputs[0]
        return self.node("Emission", {"Color": color, "Strength": strength}).outputs[0]

    def covered(self, source, surface):
        if source.coverage == 1:
            return surface
        hole = self.nodes.new("ShaderNodeBsdfTransparent").outputs[0]
        return self.node("MixShader", {0: source.coverage, 1: hole, 2: surface}).outputs[0]

    def absorption(self, per_length):
        """Cycles absorbs density (1 - colour)."""
        density = max(per_length)
        color = [1 - component / density for component in per_length]
        return self.node("VolumeAbsorption", {"Color": color, "Density": density}).outputs[0]

    def backfacing(self):
        return self.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]

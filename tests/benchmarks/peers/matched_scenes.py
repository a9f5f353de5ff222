# SPDX-License-Identifier: Apache-2.0
"""Small scenes that mean the same to two renderers, written as glTF. Each function returns (file, view options)."""

import json
import math
import pathlib

import numpy as np


class Builder:
    def __init__(self):
        self.data = bytearray()
        self.document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                         "materials": [], "buffers": [], "bufferViews": [], "accessors": []}

    def material(self, color, metallic=0.0, roughness=1.0, emission=None, extensions=None):
        value = {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": metallic,
                                          "roughnessFactor": roughness}}
        if emission:
            strength = max(emission)
            value["emissiveFactor"] = [e / strength for e in emission]
            self._uses("KHR_materials_emissive_strength")
            value["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        for name, content in (extensions or {}).items():
            self._uses(name)
            value.setdefault("extensions", {})[name] = content
        self.document["materials"].append(value)
        return len(self.document["materials"]) - 1

    def mesh(self, positions, triangles, material, normals=None):
        attributes = {"POSITION": self._accessor(np.asarray(positions, np.float32), 5126, "VEC3", True)}
        if normals is not None:
            attributes["NORMAL"] = self._accessor(np.asarray(normals, np.float32), 5126, "VEC3", False)
        indices = self._accessor(np.asarray(triangles, np.uint32).reshape(-1), 5125, "SCALAR", False)
        self.document["meshes"].append(
            {"primitives": [{"attributes": attributes, "indices": indices, "material": material}]})
        self.node({"mesh": len(self.document["meshes"]) - 1})

    def quad(self, corners, material):
        """Front side: where the corners run counterclockwise."""
        self.mesh(corners, [(0, 1, 2), (0, 2, 3)], material)

    def box(self, low, high, turn_deg, center, material):
        x0, y0, z0 = low
        x1, y1, z1 = high
        corners = np.array([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)], float)
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
        corners = corners @ np.array([(c, 0, -s), (0, 1, 0), (s, 0, c)]) + np.array(center)
        for a, b, d, e in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
            self.quad([corners[a], corners[b], corners[d], corners[e]], material)

    def closed_box(self, low, high, turn_deg, center, material):
        """One mesh of 12 triangles that face outwards: a body."""
        corners = np.array([(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
        middle = corners.mean(0)
        triangles = []
        for a, b, d, e in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
            outwards = np.cross(corners[b] - corners[a], corners[d] - corners[a]) @ (corners[a] - middle) > 0
            triangles += [(a, b, d), (a, d, e)] if outwards else [(a, d, b), (a, e, d)]
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
        self.mesh(corners @ np.array([(c, 0, -s), (0, 1, 0), (s, 0, c)]) + np.array(center), triangles, material)

    def sphere(self, center, radius, material, rings=48):
        u, v = np.meshgrid(np.linspace(0, 2 * math.pi, 2 * rings + 1), np.linspace(0, math.pi, rings + 1))
        normals = np.stack([np.sin(v) * np.cos(u), np.cos(v), np.sin(v) * np.sin(u)], -1).reshape(-1, 3)
        row = 2 * rings + 1
        triangles = []
        for j in range(rings):
            for i in range(2 * rings):
                a, b = j * row + i, (j + 1) * row + i
                if j > 0:
                    triangles.append((a, a + 1, b))
                if j < rings - 1:
                    triangles.append((a + 1, b + 1, b))
        self.mesh(np.array(center) + radius * normals, triangles, material, normals)

    def light(self, kind, color, intensity, position=(0, 0, 0), toward=(0, -1, 0)):
        self._uses("KHR_lights_punctual")
        lights = self.document.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": kind, "color": list(color), "intensity": intensity})
        # Lights look along -z: the shortest turn from there.
        d = np.array(toward, float) / np.linalg.norm(toward)
        q = np.array([*np.cross((0, 0, -1), d), 1 + d @ (0, 0, -1)])
        q = q / np.linalg.norm(q) if np.linalg.norm(q) > 1e-9 else np.array([1.0, 0, 0, 0])
        self.node({"translation": list(position), "rotation": q.tolist(),
                   "extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}})

    def node(self, node):
        self.document["nodes"].append(node)
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]) - 1)

    def write(self, path):
        path.with_suffix(".bin").write_bytes(self.data)
        self.document["buffers"] = [{"uri": path.with_suffix(".bin").name, "byteLength": len(self.data)}]
        path.write_text(json.dumps(self.document))
        return str(path)

    def _uses(self, extension):
        used = self.document.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def _accessor(self, values, component, kind, bounds):
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        accessor = {"bufferView": len(self.document["bufferViews"]) - 1, "componentType": component,
                    "count": len(values), "type": kind}
        if bounds:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        self.data += values.tobytes()
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1


def without_normal_maps(path, folder):
    """A copy of a glTF file whose materials have no normal maps: mitsuba_render.py's matte surfaces know none."""
    source = pathlib.Path(path).resolve()
    document = json.loads(source.read_text())
    for material in document["materials"]:
        material.pop("normalTexture", None)
    for entry in document["buffers"] + document["images"]:
        top = pathlib.PurePath(entry["uri"]).parts[0]
        if not (folder / top).exists():
            (folder / top).symlink_to(source.parent / top)
    copy = folder / f"plain_{source.name}"
    copy.write_text(json.dumps(document))
    return str(copy)


def room(b, white, red, green):
    """A box of 2 x 2 x 2 m about the origin, open towards +z."""
    b.quad([(-1, -1, 1), (1, -1, 1), (1, -1, -1), (-1, -1, -1)], white)
    b.quad([(-1, 1, -1), (1, 1, -1), (1, 1, 1), (-1, 1, 1)], white)
    b.quad([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)], white)
    b.quad([(-1, -1, 1), (-1, -1, -1), (-1, 1, -1), (-1, 1, 1)], red)
    b.quad([(1, -1, -1), (1, -1, 1), (1, 1, 1), (1, 1, -1)], green)


ROOM_VIEW = ["--eye=0,0,3.8", "--target=0,0,0", "--yfov=40", "--env=none"]


def cornell(folder):
    b = Builder()
    white, red = b.material((0.73, 0.73, 0.73)), b.material((0.65, 0.05, 0.05))
    green, glow = b.material((0.12, 0.45, 0.15)), b.material((0.5, 0.5, 0.5), emission=(17, 12, 4))
    room(b, white, red, green)
    b.box((-0.3, 0, -0.3), (0.3, 1.2, 0.3), 18, (-0.35, -1, -0.35), white)
    b.box((-0.3, 0, -0.3), (0.3, 0.6, 0.3), -17, (0.35, -1, 0.35), white)
    b.quad([(-0.25, 0.99, -0.25), (0.25, 0.99, -0.25), (0.25, 0.99, 0.25), (-0.25, 0.99, 0.25)], glow)
    return b.write(folder / "cornell.gltf"), ROOM_VIEW


def punctual(folder):
    b = Builder()
    white, red, green = b.material((0.73, 0.73, 0.73)), b.material((0.65, 0.05, 0.05)), b.material((0.12, 0.45, 0.15))
    room(b, white, red, green)
    b.box((-0.3, 0, -0.3), (0.3, 0.9, 0.3), 25, (0.2, -1, -0.2), white)
    b.light("point", (1, 0.8, 0.6), 2.0, (-0.5, 0.4, 0.3))
    b.light("directional", (0.6, 0.7, 1), 1.5, toward=(-0.4, -0.5, -1))
    return b.write(folder / "punctual.gltf"), ROOM_VIEW


def balls(folder, env, metallic):
    """Five balls from smooth to rough on a floor."""
    b = Builder()
    b.quad([(-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)], b.material((0.5, 0.5, 0.5)))
    for i, roughness in enumerate((0.1, 0.25, 0.5, 0.75, 1.0)):
        tint = (0.95, 0.64, 0.54) if metallic else (0.2, 0.4, 0.6)
        b.sphere((1.1 * (i - 2), 0.5, 0), 0.5, b.material(tint, metallic, roughness))
    name = "conductors" if metallic else "dielectrics"
    return b.write(folder / f"{name}.gltf"), ["--eye=0,2,6", "--target=0,0.4,0", "--yfov=35", f"--env={env}"]


def ball_on_floor(folder, env, metallic, roughness):
    """A coarse ball: a few kB."""
    b = Builder()
    b.quad([(-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)], b.material((0.5, 0.5, 0.5)))
    tint = (0.95, 0.64, 0.54) if metallic else (0.2, 0.4, 0.6)
    b.sphere((0, 0.6, 0), 0.6, b.material(tint, metallic, roughness), rings=8)
    name = "conductor" if metallic else "dielectric"
    return b.write(folder / f"{name}.gltf"), ["--eye=0,1.2,2.6", "--target=0,0.5,0", "--yfov=38", f"--env={env}"]


def one_ball(folder, metallic, roughness, tint):
    """A ball in even light: each of its pixels shows a directional albedo."""
    b = Builder()
    b.sphere((0, 0, 0), 1, b.material(tint, metallic, roughness), rings=128)
    name = f"ball_{metallic}_{roughness}.gltf"
    return b.write(folder / name), ["--eye=0,0,8", "--target=0,0,0", "--yfov=16", "--env=constant:1,1,1"]


def glass(b, roughness=0.0, ior=1.5, color=None, distance=None):
    volume = {"thicknessFactor": 1}
    if color is not None:
        volume |= {"attenuationColor": list(color), "attenuationDistance": distance}
    return b.material((1, 1, 1), 0.0, roughness, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": volume,
        "KHR_materials_ior": {"ior": ior}})


def glass_balls(folder, env, roughness):
    """Three bodies of glass on a floor: clear, of a low index, and one that absorbs."""
    b = Builder()
    b.quad([(-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)], b.material((0.5, 0.5, 0.5)))
    b.sphere((-1.1, 0.52, 0), 0.5, glass(b, roughness))
    b.sphere((0, 0.52, 0.2), 0.5, glass(b, roughness, ior=1.25))
    b.sphere((1.1, 0.52, 0), 0.5, glass(b, roughness, color=(0.9, 0.5, 0.2), distance=0.5))
    name = "rough_glass" if roughness else "glass"
    return b.write(folder / f"{name}.gltf"), ["--eye=0,1.6,4", "--target=0,0.5,0", "--yfov=38", f"--env={env}"]


def slab(folder, env):
    """A thick pane that absorbs, standing askew above a floor, a red block behind it."""
    b = Builder()
    b.quad([(-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)], b.material((0.5, 0.5, 0.5)))
    b.box((-0.3, 0, -0.3), (0.3, 0.7, 0.3), 20, (-0.4, 0, -1.1), b.material((0.65, 0.1, 0.1)))
    pane = glass(b, color=(0.25, 0.7, 0.6), distance=0.3)
    b.closed_box((-0.8, 0.05, -0.15), (0.8, 1.2, 0.15), 25, (0, 0, 0), pane)
    return b.write(folder / "slab.gltf"), ["--eye=0,1.3,3.2", "--target=0,0.5,0", "--yfov=38", f"--env={env}"]


SLAB_IOR, SLAB_DEPTH, SLAB_COLOR, SLAB_DISTANCE = 1.5, 0.4, (0.3, 0.6, 0.9), 0.5


def slab_in_front_of_light(folder):
    """An absorbing pane seen straight on, an even light behind it: the closed form is slab_transmittance."""
    b = Builder()
    pane = glass(b, ior=SLAB_IOR, color=SLAB_COLOR, distance=SLAB_DISTANCE)
    b.closed_box((-2, -2, -SLAB_DEPTH / 2), (2, 2, SLAB_DEPTH / 2), 0, (0, 0, 0), pane)
    # Metallic, since a black dielectric would still reflect a little of what the pane throws back.
    light = b.material((0, 0, 0), 1.0, emission=(1, 1, 1))
    b.quad([(-2, -2, -1), (2, -2, -1), (2, 2, -1), (-2, 2, -1)], light)
    return b.write(folder / "slab_light.gltf"), ["--eye=0,0,10", "--target=0,0,0", "--yfov=1", "--env=none"]


def slab_transmittance(bounces):
    """(1 - R)^2 a sum of (R a)^(2 k), a = exp(-sigma d), as far as paths of so many scattering events reach."""
    r = ((SLAB_IOR - 1) / (SLAB_IOR + 1)) ** 2
    a = np.array(SLAB_COLOR) ** (SLAB_DEPTH / SLAB_DISTANCE)
    return sum((1 - r) ** 2 * a * (r * a) ** (2 * k) for k in range((bounces - 2) // 2 + 1))

# SPDX-License-Identifier: Apache-2.0
"""Scenes of a wanted size, written as glTF: so many triangles, unique or instanced, or so many lights."""

import json
import math

import numpy as np

FLOAT, UINT = 5126, 5125
# What 10^3 triangles of one rock stand for when instances are counted.
TRIANGLES_A_ROCK = 1000


class Writer:
    """Accessors streamed into one .bin, so that 10^8 triangles need no second copy."""

    def __init__(self, path):
        self.path = path
        self.file = open(path.with_suffix(".bin"), "wb")
        self.size = 0
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "materials": [], "bufferViews": [], "accessors": []}

    def accessor(self, values, component, kind, bounds=False):
        values = np.ascontiguousarray(values)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": self.size, "byteLength": values.nbytes})
        accessor = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component,
                    "count": values.size if kind == "SCALAR" else len(values), "type": kind}
        if bounds:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        values.tofile(self.file)
        self.size += values.nbytes
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def material(self, color, emission=None):
        material = {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0}}
        if emission is not None:
            material["emissiveFactor"] = [1, 1, 1]
            material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": emission}}
            self.json["extensionsUsed"] = ["KHR_materials_emissive_strength"]
        self.json["materials"].append(material)
        return len(self.json["materials"]) - 1

    def mesh(self, positions, triangles, material):
        self.json["meshes"].append({"primitives": [{
            "attributes": {"POSITION": self.accessor(positions.astype(np.float32), FLOAT, "VEC3", True)},
            "indices": self.accessor(triangles.astype(np.uint32).reshape(-1), UINT, "SCALAR"), "material": material}]})
        return len(self.json["meshes"]) - 1

    def node(self, node):
        self.json["nodes"].append(node)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def close(self):
        self.file.close()
        self.json["buffers"] = [{"uri": self.path.with_suffix(".bin").name, "byteLength": self.size}]
        self.path.write_text(json.dumps(self.json))
        return self.path


def grid(rows, columns, size_m, height):
    """A height field over the xz plane about the origin, two triangles a cell; height(x, z) in metres."""
    x = np.linspace(-size_m / 2, size_m / 2, columns + 1)
    z = np.linspace(-size_m / 2, size_m / 2, rows + 1)
    xx, zz = np.meshgrid(x, z)
    positions = np.stack([xx, height(xx, zz), zz], -1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(rows, dtype=np.uint32)[:, None] * np.uint32(columns + 1) +
              np.arange(columns, dtype=np.uint32)).reshape(-1)
    below = corner + np.uint32(columns + 1)
    triangles = np.empty((len(corner), 2, 3), np.uint32)
    triangles[:, 0] = np.stack([corner, below, corner + 1], -1)
    triangles[:, 1] = np.stack([corner + 1, below, below + 1], -1)
    return positions, triangles.reshape(-1, 3)


def hills(x, z):
    """Detail at every scale that a grid may resolve: octaves down to centimetres on 100 m."""
    y = np.zeros_like(x)
    for k in range(12):
        f = 0.06 * 2**k
        a, b = math.cos(1.7 * k), math.sin(1.7 * k)
        y += 4.0 * 0.5**k * np.sin(f * (a * x + b * z) + k) * np.cos(f * (b * x - a * z) + 2 * k)
    return y


def unique(path, triangles):
    """One height field of 100 m with that many triangles, none of them shared."""
    w = Writer(path)
    rows = max(1, round(math.sqrt(triangles / 2)))
    columns = max(1, round(triangles / 2 / rows))
    w.node({"mesh": w.mesh(*grid(rows, columns, 100, hills), w.material((0.5, 0.5, 0.5)))})
    return w.close()


def instanced(path, triangles):
    """The same triangles as turned copies of one rock on 100 m of ground."""
    w = Writer(path)
    side = round(math.sqrt(TRIANGLES_A_ROCK / 2))
    positions, faces = grid(side, side, 2, lambda x, z: np.zeros_like(x))
    # The grid wrapped round a bumpy ball of 1 m.
    u, v = (positions[:, 0] + 1) * math.pi, (positions[:, 2] + 1) * math.pi / 2
    radius = 1 + 0.2 * np.sin(5 * v) * np.sin(4 * u)
    ball = np.stack([np.sin(v) * np.cos(u), np.cos(v), np.sin(v) * np.sin(u)], -1) * radius[:, None]
    rock = w.mesh(ball, faces, w.material((0.5, 0.5, 0.5)))
    count = max(1, round(triangles / len(faces)))
    random = np.random.default_rng(1)
    place = random.uniform(-50, 50, (count, 3)).astype(np.float32)
    place[:, 1] = hills(place[:, 0], place[:, 2])
    turn = random.normal(size=(count, 4))
    turn = (turn / np.linalg.norm(turn, axis=1, keepdims=True)).astype(np.float32)
    scale = np.repeat(random.uniform(0.5, 1.5, (count, 1)), 3, 1).astype(np.float32) * min(1, 30 / math.sqrt(count))
    attributes = {"TRANSLATION": w.accessor(place, FLOAT, "VEC3"), "ROTATION": w.accessor(turn, FLOAT, "VEC4"),
                  "SCALE": w.accessor(scale, FLOAT, "VEC3")}
    w.json.setdefault("extensionsUsed", []).append("EXT_mesh_gpu_instancing")
    w.node({"mesh": rock, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}})
    w.node({"mesh": w.mesh(*grid(20, 20, 100, hills), w.material((0.4, 0.4, 0.4)))})
    return w.close()


def lights(path, count):
    """Ground of 100 m under that many small emissive triangles, all of them together of the same power."""
    w = Writer(path)
    w.node({"mesh": w.mesh(*grid(100, 100, 100, hills), w.material((0.5, 0.5, 0.5)))})
    random = np.random.default_rng(2)
    place = random.uniform(-40, 40, (count, 3))
    place[:, 1] = hills(place[:, 0], place[:, 2]) + random.uniform(0.5, 5, count)
    corner = random.normal(size=(count, 3, 3))
    corner *= 0.3 / np.linalg.norm(corner, axis=2, keepdims=True) / max(1.0, count / 100) ** 0.5
    positions = (place[:, None, :] + corner).reshape(-1, 3)
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum()
    glow = w.material((0, 0, 0), emission=20000 / area)
    w.json["materials"][glow]["doubleSided"] = True
    w.node({"mesh": w.mesh(positions, np.arange(3 * count).reshape(-1, 3), glow)})
    return w.close()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a glTF scene of 60 blocks on a square of 40 m under any number of small shining triangles.

  lamp_city.py OUT.gltf --lamps 10000

The lamps have 16 materials of different strength, so that a program that chooses among lights by their power has something
to choose. All of them together have about the same power whatever their number.
"""

import argparse
import json
import pathlib

import numpy as np

MATERIALS = 16


def box(low, high):
    """(corners, triangles) of a box, facing outwards."""
    corners = np.array([[high[a] if c >> a & 1 else low[a] for a in range(3)] for c in range(8)], np.float32)
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.uint32)


def together(parts):
    """One mesh of many (positions, triangles)."""
    firsts = np.cumsum([0] + [len(positions) for positions, _ in parts])
    return (np.concatenate([positions for positions, _ in parts]),
            np.concatenate([triangles + first for (_, triangles), first in zip(parts, firsts)]).astype(np.uint32))


def blocks(random):
    parts = [box((-20, -0.1, -20), (20, 0, 20))]
    for _ in range(60):
        at = np.array([random.uniform(-19, 19), 0, random.uniform(-19, 19)])
        parts.append(box(at, at + [random.uniform(0.5, 2), random.uniform(0.5, 4), random.uniform(0.5, 2)]))
    return together(parts)


def lamps(random, count):
    """Triangles with corners within 10 cm of a point 0.3 to 6 m above the ground."""
    at = random.uniform((-20, 0.3, -20), (20, 6, 20), (count, 3))
    sides = random.uniform(-0.1, 0.1, (2, count, 3))
    corners = np.stack([at, at + sides[0], at + sides[1]], 1).astype(np.float32)
    return corners.reshape(-1, 3), np.arange(3 * count, dtype=np.uint32).reshape(-1, 3)


class Document:
    """A glTF file with its data in one .bin beside it."""

    def __init__(self):
        self.data = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                     "extensionsUsed": ["KHR_materials_emissive_strength"], "meshes": [{"primitives": []}], "materials": [],
                     "accessors": [], "bufferViews": []}

    def accessor(self, values, component, kind, **more):
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        self.json["accessors"].append({"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component,
                                       "count": len(values), "type": kind, **more})
        self.data += values.tobytes()
        return len(self.json["accessors"]) - 1

    def add(self, mesh, material):
        positions, triangles = mesh
        least, most = positions.min(0).tolist(), positions.max(0).tolist()
        self.json["meshes"][0]["primitives"].append({
            "attributes": {"POSITION": self.accessor(positions, 5126, "VEC3", min=least, max=most)},
            "indices": self.accessor(triangles.reshape(-1), 5125, "SCALAR"), "material": len(self.json["materials"])})
        self.json["materials"].append(material)

    def write(self, path):
        path.with_suffix(".bin").write_bytes(self.data)
        self.json["buffers"] = [{"uri": path.with_suffix(".bin").name, "byteLength": len(self.data)}]
        path.write_text(json.dumps(self.json))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--lamps", type=int, default=10000)
    options = parser.parse_args()

    random = np.random.default_rng(1)
    gray = {"baseColorFactor": [0.6, 0.6, 0.6, 1], "metallicFactor": 0, "roughnessFactor": 0.7}
    document = Document()
    document.add(blocks(random), {"pbrMetallicRoughness": gray, "doubleSided": True})
    for i in range(MATERIALS):
        count = options.lamps * (i + 1) // MATERIALS - options.lamps * i // MATERIALS
        strength = 120000 / options.lamps * 100 ** random.uniform(-0.5, 0.5)
        document.add(lamps(random, count), {
            "pbrMetallicRoughness": gray, "doubleSided": True, "emissiveFactor": random.uniform(0.5, 1, 3).tolist(),
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}})
    document.write(options.output)


if __name__ == "__main__":
    main()

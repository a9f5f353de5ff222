#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks a .gltf with one .bin beside it against what glTF 2.0 asks for. Exit code 1 and one line a problem.

    check_scene.py SCENE.gltf

Buffer ranges and alignment, accessor bounds, indices, unit normals and quaternions, winding against normals, node tree
without cycles or shared children, animation inputs, image files, declared extensions. Standard library only; not a full
validator, but what a generator gets wrong.
"""
import json
import math
import os
import struct
import sys

_WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_COMPONENT = {5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}


class Checker:
    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        with open(path, encoding="utf-8") as file:
            self.gltf = json.load(file)
        with open(os.path.join(self.folder, self.gltf["buffers"][0]["uri"]), "rb") as file:
            self.data = file.read()
        self.problems = []

    def expect(self, true, text):
        if not true:
            self.problems.append(text)
        return true

    def read(self, index):
        accessor = self.gltf["accessors"][index]
        view = self.gltf["bufferViews"][accessor["bufferView"]]
        width = _WIDTH[accessor["type"]]
        code, size = _COMPONENT[accessor["componentType"]]
        offset = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        place = f"accessors[{index}]"
        self.expect(offset % size == 0, f"{place}: offset {offset} is not aligned")
        need = accessor["count"] * width * size
        self.expect(need <= view["byteLength"], f"{place}: runs past its bufferView")
        if not self.expect(offset + need <= len(self.data), f"{place}: runs past the buffer"):
            return []
        flat = struct.unpack_from(f"<{accessor['count'] * width}{code}", self.data, offset)
        self.expect(all(map(math.isfinite, flat)), f"{place}: not finite")
        for name, choose in (("min", min), ("max", max)):
            if name in accessor:
                actual = [choose(flat[c::width]) for c in range(width)]
                self.expect(actual == accessor[name], f"{place}: {name} says {accessor[name]}, data {actual}")
        return [flat[k : k + width] for k in range(0, len(flat), width)]

    def check_primitive(self, place, primitive):
        attributes = {name: self.read(index) for name, index in primitive["attributes"].items()}
        points, normals = attributes["POSITION"], attributes["NORMAL"]
        self.expect("min" in self.gltf["accessors"][primitive["attributes"]["POSITION"]], f"{place}: POSITION has no bounds")
        for name, rows in attributes.items():
            self.expect(len(rows) == len(points), f"{place}: {name} has {len(rows)} rows, POSITION {len(points)}")
        for row in normals:
            if not self.expect(abs(math.dist((0, 0, 0), row) - 1) < 1e-4, f"{place}: normal {row} is not a unit vector"):
                break
        indices = [row[0] for row in self.read(primitive["indices"])]
        self.expect(len(indices) % 3 == 0, f"{place}: {len(indices)} indices")
        if not self.expect(max(indices) < len(points), f"{place}: index {max(indices)} of {len(points)}"):
            return 0
        self.expect(primitive["material"] < len(self.gltf["materials"]), f"{place}: material out of range")
        turned = flat = 0
        for k in range(0, len(indices), 3):
            corners = indices[k : k + 3]
            a, b, c = (points[i] for i in corners)
            u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
            cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            flat += math.dist((0, 0, 0), cross) < 1e-12
            turned += sum(sum(cross[i] * normals[j][i] for i in range(3)) for j in corners) < 0
        self.expect(not turned, f"{place}: {turned} triangles wind against their normals")
        self.expect(not flat, f"{place}: {flat} triangles of no area")
        return len(indices) // 3

    def check_nodes(self):
        seen = set()

        def visit(index, above):
            self.expect(index not in above, f"nodes[{index}]: is its own ancestor")
            if not self.expect(index not in seen, f"nodes[{index}]: has two parents"):
                return
            seen.add(index)
            node = self.gltf["nodes"][index]
            if "rotation" in node:
                norm = math.sqrt(sum(c * c for c in node["rotation"]))
                self.expect(abs(norm - 1) < 1e-4, f"nodes[{index}]: rotation of length {norm}")
            for name, array in (("mesh", "meshes"), ("camera", "cameras")):
                if name in node:
                    self.expect(node[name] < len(self.gltf[array]), f"nodes[{index}]: no {name} {node[name]}")
            for attribute in node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {}).values():
                self.read(attribute)
            for child in node.get("children", []):
                visit(child, above | {index})

        for root in self.gltf["scenes"][self.gltf["scene"]]["nodes"]:
            visit(root, set())
        self.expect(len(seen) == len(self.gltf["nodes"]), f"{len(self.gltf['nodes']) - len(seen)} nodes are not in the scene")

    def check_animations(self):
        for a, animation in enumerate(self.gltf.get("animations", [])):
            for s, sampler in enumerate(animation["samplers"]):
                place = f"animations[{a}].samplers[{s}]"
                times = [row[0] for row in self.read(sampler["input"])]
                self.expect(all(p < q for p, q in zip(times, times[1:])), f"{place}: times do not grow")
                self.expect("min" in self.gltf["accessors"][sampler["input"]], f"{place}: input has no bounds")
                per_key = 3 if sampler["interpolation"] == "CUBICSPLINE" else 1
                rows = self.read(sampler["output"])
                self.expect(len(rows) == per_key * len(times), f"{place}: {len(rows)} values for {len(times)} keys")
                if len(rows[0]) == 4 and per_key == 1:
                    worst = max(abs(math.sqrt(sum(c * c for c in row)) - 1) for row in rows)
                    self.expect(worst < 1e-5, f"{place}: rotations are off unit length by {worst}")

    def check_extensions(self):
        used = set(self.gltf.get("extensionsUsed", []))
        found = set()

        def walk(value):
            if isinstance(value, dict):
                found.update(value.get("extensions", {}))
                for inner in value.values():
                    walk(inner)
            elif isinstance(value, list):
                for inner in value:
                    walk(inner)

        walk(self.gltf)
        self.expect(found == used, f"extensionsUsed {sorted(used)}, in the file {sorted(found)}")
        self.expect(set(self.gltf.get("extensionsRequired", [])) <= used, "an extension is required but not used")

    def run(self):
        self.expect(self.gltf["buffers"][0]["byteLength"] == len(self.data), "the buffer's length is not the file's")
        triangles = 0
        for m, mesh in enumerate(self.gltf["meshes"]):
            for p, primitive in enumerate(mesh["primitives"]):
                triangles += self.check_primitive(f"meshes[{m}].primitives[{p}] ({mesh['name']})", primitive)
        self.check_nodes()
        self.check_animations()
        self.check_extensions()
        for image in self.gltf["images"]:
            self.expect(os.path.exists(os.path.join(self.folder, image["uri"])), f"no image {image['uri']}")
        return triangles


def main():
    checker = Checker(sys.argv[1])
    triangles = checker.run()
    for problem in checker.problems:
        print(f"{sys.argv[1]}: {problem}")
    print(f"{sys.argv[1]}: {triangles} triangles in {len(checker.gltf['meshes'])} meshes, {len(checker.problems)} problems")
    return 1 if checker.problems else 0


if __name__ == "__main__":
    sys.exit(main())

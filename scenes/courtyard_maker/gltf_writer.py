# SPDX-License-Identifier: Apache-2.0
"""Collects meshes, materials, nodes and animations and writes them as glTF 2.0: NAME.gltf and NAME.bin."""
import json
import os
import struct

_FLOAT, _UNSIGNED_SHORT, _UNSIGNED_INT = 5126, 5123, 5125
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def rounded(value, digits=6):
    """Short numbers for the JSON text."""
    if isinstance(value, (list, tuple)):
        return [rounded(v, digits) for v in value]
    return round(value, digits) + 0.0 if isinstance(value, float) else value


class GltfWriter:
    def __init__(self, generator, copyright_line):
        self.data = bytearray()
        self.json = {
            "asset": {"version": "2.0", "generator": generator, "copyright": copyright_line},
            "extensionsUsed": [],
            "scene": 0,
            "scenes": [{"nodes": []}],
        }

    def append(self, array, item):
        items = self.json.setdefault(array, [])
        items.append(item)
        return len(items) - 1

    def use(self, extension):
        if extension not in self.json["extensionsUsed"]:
            self.json["extensionsUsed"].append(extension)

    def accessor(self, rows, kind, component=_FLOAT, target=None, bounds=False):
        while len(self.data) % 4:
            self.data.append(0)
        offset = len(self.data)
        flat = [v for row in rows for v in row] if kind != "SCALAR" else list(rows)
        code = {_FLOAT: "f", _UNSIGNED_SHORT: "H", _UNSIGNED_INT: "I"}[component]
        packed = struct.pack(f"<{len(flat)}{code}", *flat)
        self.data += packed
        view = {"buffer": 0, "byteOffset": offset, "byteLength": len(self.data) - offset}
        if target:
            view["target"] = target
        item = {
            "bufferView": self.append("bufferViews", view),
            "componentType": component,
            "count": len(rows),
            "type": kind,
        }
        if bounds:  # of the values as stored
            stored = struct.unpack(f"<{len(flat)}{code}", packed)
            width = _COMPONENTS[kind]
            item["min"] = [min(stored[c::width]) for c in range(width)]
            item["max"] = [max(stored[c::width]) for c in range(width)]
        return self.append("accessors", item)

    def texture(self, uri, clamp=False):
        mode = 33071 if clamp else 10497
        sampler = {"magFilter": 9729, "minFilter": 9987, "wrapS": mode, "wrapT": mode}
        samplers = self.json.setdefault("samplers", [])
        if sampler not in samplers:
            samplers.append(sampler)
        image = self.append("images", {"uri": uri})
        return self.append("textures", {"sampler": samplers.index(sampler), "source": image})

    def texture_info(self, texture, repeats=None, **more):
        info = {"index": texture, **more}
        if repeats:
            self.use("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": {"scale": list(repeats)}}
        return info

    def material(
        self, name, base=(1, 1, 1), alpha=1.0, roughness=1.0, metallic=0.0, emissive=None, strength=None, **more
    ):
        pbr = {"baseColorFactor": rounded([*base, alpha]), "metallicFactor": metallic, "roughnessFactor": roughness}
        for key in ("baseColorTexture", "metallicRoughnessTexture"):
            if key in more:
                pbr[key] = more.pop(key)
        material = {"name": name, "pbrMetallicRoughness": pbr, **more}
        if emissive:
            material["emissiveFactor"] = list(emissive)
            if strength:
                self.use("KHR_materials_emissive_strength")
                material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        return self.append("materials", material)

    def primitive(self, shape, material):
        triangles = []
        for k in range(0, len(shape.indices), 3):
            corners = shape.indices[k : k + 3]
            if len({shape.positions[c] for c in corners}) == 3:  # a pole's quads have one side of no length
                triangles += corners
        used = sorted(set(triangles))
        renumbered = {old: new for new, old in enumerate(used)}
        pick = lambda values: [values[k] for k in used]  # noqa: E731
        attributes = {
            "POSITION": self.accessor(pick(shape.positions), "VEC3", target=_ARRAY_BUFFER, bounds=True),
            "NORMAL": self.accessor(pick(shape.normals), "VEC3", target=_ARRAY_BUFFER),
            "TEXCOORD_0": self.accessor(pick(shape.uvs), "VEC2", target=_ARRAY_BUFFER),
        }
        if shape.colors:
            attributes["COLOR_0"] = self.accessor(pick(shape.colors), "VEC3", target=_ARRAY_BUFFER)
        component = _UNSIGNED_SHORT if len(used) < 65535 else _UNSIGNED_INT
        indices = self.accessor(
            [renumbered[k] for k in triangles], "SCALAR", component, target=_ELEMENT_ARRAY_BUFFER
        )
        return {"attributes": attributes, "indices": indices, "material": material}

    def mesh(self, name, *shapes_and_materials):
        primitives = [self.primitive(shape, material) for shape, material in shapes_and_materials]
        return self.append("meshes", {"name": name, "primitives": primitives})

    def node(self, name, parent=None, **members):
        index = self.append("nodes", {"name": name, **{k: rounded(v) for k, v in members.items()}})
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def instances(self, name, mesh, translations, rotations, scales):
        """One node that stands for many, by EXT_mesh_gpu_instancing."""
        self.use("EXT_mesh_gpu_instancing")
        attributes = {
            "TRANSLATION": self.accessor(translations, "VEC3"),
            "ROTATION": self.accessor(rotations, "VEC4"),
            "SCALE": self.accessor(scales, "VEC3"),
        }
        return self.node(name, mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})

    def animation(self, name, channels):
        """`channels`: (node, "translation" | "rotation", interpolation, times, values)."""
        samplers, targets = [], []
        for node, path, interpolation, times, values in channels:
            samplers.append(
                {
                    "input": self.accessor(times, "SCALAR", bounds=True),
                    "output": self.accessor(values, "VEC4" if path == "rotation" else "VEC3"),
                    "interpolation": interpolation,
                }
            )
            targets.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
        self.append("animations", {"name": name, "channels": targets, "samplers": samplers})

    def write(self, folder, name):
        self.json["buffers"] = [{"uri": f"{name}.bin", "byteLength": len(self.data)}]
        self.json["extensionsUsed"].sort()
        with open(os.path.join(folder, f"{name}.bin"), "wb") as file:
            file.write(self.data)
        with open(os.path.join(folder, f"{name}.gltf"), "w", encoding="utf-8", newline="\n") as file:
            json.dump(self.json, file, separators=(",", ":"))
            file.write("\n")

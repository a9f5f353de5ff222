# SPDX-License-Identifier: Apache-2.0
"""The part of glTF 2.0 that the peer comparisons need, read with numpy alone: triangles in world space, per material."""

import base64
import dataclasses
import json
import pathlib
import struct
import urllib.parse

import numpy as np

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@dataclasses.dataclass
class Mesh:
    """One primitive of one node. Arrays are float32 (n, 3), (n, 3), (n, 2) and uint32 (m, 3); missing ones are None."""

    material: int
    positions: np.ndarray
    normals: np.ndarray | None
    uv: np.ndarray | None
    triangles: np.ndarray


class Gltf:
    def __init__(self, path):
        self.path = pathlib.Path(path)
        data = self.path.read_bytes()
        self.binary = None
        if data[:4] == b"glTF":
            length = struct.unpack("<I", data[12:16])[0]
            self.json = json.loads(data[20 : 20 + length])
            self.binary = data[20 + length + 8 :]
        else:
            self.json = json.loads(data)
        self.buffers = [self._buffer(b) for b in self.json.get("buffers", [])]
        self.materials = self.json.get("materials", [])

    def _buffer(self, buffer):
        uri = buffer.get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.path.parent / urllib.parse.unquote(uri)).read_bytes()

    def accessor(self, index):
        a = self.json["accessors"][index]
        if "sparse" in a:
            raise ValueError("sparse accessors are not read here")
        view = self.json["bufferViews"][a["bufferView"]]
        dtype, count = np.dtype(COMPONENTS[a["componentType"]]), COUNTS[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        stride = view.get("byteStride", dtype.itemsize * count)
        values = np.ndarray((a["count"], count), dtype, self.buffers[view["buffer"]], start, (stride, dtype.itemsize))
        values = np.array(values)
        if a.get("normalized") and dtype.kind in "iu":
            values = np.maximum(values.astype(np.float32) / np.iinfo(dtype).max, -1)
        return values

    def image_path(self, texture):
        """The file of a texture index; embedded pictures are not read here."""
        source = self.json["textures"][texture]["source"]
        return self.path.parent / urllib.parse.unquote(self.json["images"][source]["uri"])

    def nodes(self):
        """(node, its matrix to the world) for every node of the default scene."""
        scene = self.json["scenes"][self.json.get("scene", 0)]
        stack = [(i, np.eye(4)) for i in scene["nodes"]]
        while stack:
            index, parent = stack.pop()
            node = self.json["nodes"][index]
            matrix = parent @ local_matrix(node)
            yield node, matrix
            stack += [(child, matrix) for child in node.get("children", [])]

    def meshes(self):
        for node, matrix in self.nodes():
            if "mesh" not in node:
                continue
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                yield self._primitive(primitive, matrix)

    def _primitive(self, primitive, matrix):
        if primitive.get("mode", 4) != 4:
            raise ValueError("only triangle lists are read here")
        attributes = primitive["attributes"]
        local = self.accessor(attributes["POSITION"]).astype(np.float64)
        positions = local @ matrix[:3, :3].T + matrix[:3, 3]
        if "indices" in primitive:
            triangles = self.accessor(primitive["indices"]).reshape(-1, 3).astype(np.uint32)
        else:
            triangles = np.arange(len(local), dtype=np.uint32).reshape(-1, 3)
        normals = None
        if "NORMAL" in attributes:
            normals = self.accessor(attributes["NORMAL"]).astype(np.float64) @ np.linalg.inv(matrix[:3, :3])
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
            normals = normals.astype(np.float32)
        if np.linalg.det(matrix[:3, :3]) < 0:
            triangles = triangles[:, ::-1]
        uv = self.accessor(attributes["TEXCOORD_0"]).astype(np.float32) if "TEXCOORD_0" in attributes else None
        return Mesh(primitive.get("material", -1), positions.astype(np.float32), normals, uv, triangles)


def local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    rotation = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def write_ply(mesh, path, normals):
    """Binary PLY; without normals a reader shades flat."""
    columns = [mesh.positions]
    names = ["x", "y", "z"]
    if normals and mesh.normals is not None:
        columns.append(mesh.normals)
        names += ["nx", "ny", "nz"]
    if mesh.uv is not None:
        columns.append(mesh.uv)
        names += ["u", "v"]
    faces = np.empty(len(mesh.triangles), dtype=[("n", "u1"), ("i", "<u4", 3)])
    faces["n"] = 3
    faces["i"] = mesh.triangles
    with open(path, "wb") as file:
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.positions)}"]
        header += [f"property float {name}" for name in names]
        header += [f"element face {len(faces)}", "property list uchar uint vertex_indices", "end_header", ""]
        file.write("\n".join(header).encode())
        file.write(np.hstack(columns).astype("<f4").tobytes())
        file.write(faces.tobytes())

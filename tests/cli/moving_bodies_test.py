# SPDX-License-Identifier: Apache-2.0
"""Bodies that move, by their node, by a bone or by a morph target, leave nothing behind where frames are joined."""

import base64
import json
import struct

import harness
from exr_reader import Exr

SIZE_PX, SIDE_PX, START_PX, FRAMES = (64, 36), 10, -18, 24
WALL = 0.2


class Document:
    """A glTF file with one buffer."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def add(self, values, code, component, kind, **limits):
        packed = struct.pack(f"<{len(values)}{code}", *values)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed + b"\0" * (-len(packed) % 4)
        parts = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": component, "count": len(values) // parts, "type": kind, **limits})
        return len(self.accessors) - 1

    def floats(self, values, kind, **limits):
        return self.add(values, "f", 5126, kind, **limits)


def scene(kind, speed_px):
    """A shining square before a shining wall, seen by parallel rays so that a metre is a pixel. It glides to the right."""
    gltf, half, way = Document(), SIDE_PX / 2, speed_px * FRAMES

    def square(half, z):
        corners = [-half, -half, z, half, -half, z, -half, half, z, half, half, z]
        return gltf.floats(corners, "VEC3", min=[-half, -half, z], max=[half, half, z])

    indices = gltf.add([0, 1, 2, 2, 1, 3], "H", 5123, "SCALAR")
    body = {"attributes": {"POSITION": square(half, 0)}, "indices": indices, "material": 0}
    wall = {"attributes": {"POSITION": square(99, -5)}, "indices": indices, "material": 1}
    meshes = [{"primitives": [body]}, {"primitives": [wall]}]
    nodes = [{"mesh": 0}, {"mesh": 1}, {"camera": 0, "translation": [0, 0, 10]}, {}]
    times = gltf.floats([0, FRAMES / 24], "SCALAR", min=[0], max=[FRAMES / 24])
    target = {"node": 0, "path": "translation"}
    keys = gltf.floats([START_PX, 0, 0, START_PX + way, 0, 0], "VEC3")
    more = {}
    if kind == "bone":
        body["attributes"] |= {"JOINTS_0": gltf.add([0] * 16, "B", 5121, "VEC4"), "WEIGHTS_0": gltf.floats([1, 0, 0, 0] * 4, "VEC4")}
        identity = [float(i % 5 == 0) for i in range(16)]
        more["skins"] = [{"joints": [3], "inverseBindMatrices": gltf.floats(identity, "MAT4")}]
        nodes[0]["skin"], target["node"] = 0, 3
    elif kind == "morph":
        body["targets"] = [{"POSITION": gltf.floats([way, 0, 0] * 4, "VEC3", min=[way, 0, 0], max=[way, 0, 0])}]
        meshes[0]["weights"], nodes[0]["translation"] = [0], [START_PX, 0, 0]
        target["path"], keys = "weights", gltf.floats([0, 1], "SCALAR")

    def glow(light):
        black = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}
        return {"emissiveFactor": [light] * 3, "doubleSided": True, "pbrMetallicRoughness": black}

    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}], "nodes": nodes, "meshes": meshes, **more,
        "materials": [glow(1), glow(WALL)],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 32, "ymag": 18, "znear": 0.1, "zfar": 100}}],
        "animations": [{"samplers": [{"input": times, "output": keys}], "channels": [{"sampler": 0, "target": target}]}],
        "accessors": gltf.accessors, "bufferViews": gltf.views,
        "buffers": [{"byteLength": len(gltf.data), "uri": "data:application/octet-stream;base64," + base64.b64encode(gltf.data).decode()}],
    }  # fmt: skip


class MovingBodies(harness.CliTest):
    def test_no_ghost_is_left_where_a_body_was_or_will_be(self):
        for kind in ("node", "bone", "morph"):
            for speed_px in (1.5, 2.3):
                self.write("body.gltf", json.dumps(scene(kind, speed_px)))
                for frame in (1, 6):
                    self.run_ok("render", "body.gltf", "--size", "64x36", "--env", "none", "--fps", "24", "--frames", str(frame), "--sampling", "uniform",
                                "--spp", "16", "--bounces", "0", "--filter", "none", "--accumulate", "window", "-o", "f.exr", "--overwrite", "--quiet",
                                "--exr-compression", "none", "--exr-pixels", "float")  # fmt: skip
                    middle = SIZE_PX[0] / 2 + START_PX + speed_px * (frame - 0.5)
                    rows = Exr(self.folder / "f.exr").channel("R")
                    for y, row in enumerate(rows):
                        for x, light in enumerate(row):
                            # How far the pixel lies outside of the body.
                            outside = max(abs(x + 0.5 - middle), abs(y + 0.5 - SIZE_PX[1] / 2)) - SIDE_PX / 2
                            if abs(outside) > 1.5:
                                self.assertAlmostEqual(light, WALL if outside > 0 else 1, delta=1e-3, msg=(kind, speed_px, frame, x, y))


if __name__ == "__main__":
    harness.main()

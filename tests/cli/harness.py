# SPDX-License-Identifier: Apache-2.0
"""Runs the program and makes tiny inputs for it. Needs nothing but Python."""

import base64
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

from fork_server import ForkServer

PROGRAM = os.environ["GAZETRACE"]
SHARED = Path(os.environ.get("GAZETRACE_SHARED_DIR", "/nonexistent"))
SOURCE = Path(os.environ.get("GAZETRACE_SOURCE_DIR", Path(__file__).parents[2]))

# Where it is built, most runs are forks of one program (fork_server.py); `alone` is for those that start by themselves.
PRELOADED = os.environ.get("GAZETRACE_FORK_SERVER")
server = None

SCREEN = ["--screen-px", "64,36", "--screen-cm", "64,36", "--screen-distance-cm", "60"]


def box_gltf(camera_seconds=None):
    """A floor, a box above it and a point light; with `camera_seconds` its camera glides sideways that long."""
    corners = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    faces = [(0, 2, 1, 1, 2, 3), (4, 5, 6, 5, 7, 6), (0, 1, 4, 1, 5, 4), (2, 6, 3, 3, 6, 7), (0, 4, 2, 2, 4, 6), (1, 3, 5, 3, 7, 5)]
    indices = [i for face in faces for i in face]
    positions = b"".join(struct.pack("<3f", *corner) for corner in corners)
    buffer = positions + struct.pack("<36H", *indices)
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": 96},
        {"buffer": 0, "byteOffset": 96, "byteLength": 72},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1]},
        {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
    ]
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2, 3]}],
        "nodes": [
            {"mesh": 0, "scale": [0.5, 0.5, 0.5]},
            {"mesh": 0, "translation": [0, -1, 0], "scale": [4, 0.1, 4]},
            {"camera": 0, "translation": [0, 0.5, 4]},
            {"translation": [1, 3, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.6, 0.4, 1], "metallicFactor": 0.2, "roughnessFactor": 0.4}}],
        "cameras": [{"name": "main", "type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.01}}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 40}]}},
    }
    if camera_seconds is not None:
        keys = struct.pack("<2f", 0, camera_seconds) + struct.pack("<6f", -0.5, 0.5, 4, 0.5, 0.5, 4)
        views += [
            {"buffer": 0, "byteOffset": 168, "byteLength": 8},
            {"buffer": 0, "byteOffset": 176, "byteLength": 24},
        ]
        accessors += [
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [camera_seconds]},
            {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
        ]
        buffer += keys
        gltf["animations"] = [
            {"channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}], "samplers": [{"input": 2, "output": 3}]}
        ]
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    gltf.update(buffers=[{"byteLength": len(buffer), "uri": uri}], bufferViews=views, accessors=accessors)
    return gltf


def gaze_csv(rows, header="t[ns],u[1],v[1],valid,eye"):
    preamble = "# gazetrace-gaze 1\n# display_px 64 36\n# display_mm 640 360\n# distance_mm 600\n"
    return preamble + header + "\n" + "".join(row + "\n" for row in rows)


def moving_gaze(samples=100, step_ns=10_000_000):
    return gaze_csv(f"{i * step_ns},{0.2 + 0.6 * i / samples:.4f},0.5,ok,cyclopean" for i in range(samples))


def png(width, height, pixel):
    """8-bit RGB; pixel(x, y) gives three code values."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def read_png(path):
    """Size, and rows of pixels, of 8-bit RGB or RGBA."""
    data, at, chunks = Path(path).read_bytes(), 8, {}
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunks[kind] = chunks.get(kind, b"") + data[at + 8:at + 8 + length]
        at += length + 12
    width, height, bits, color = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    assert bits == 8 and color in (2, 6)
    step = 3 if color == 2 else 4
    raw, rows, above = zlib.decompress(chunks[b"IDAT"]), [], bytes(width * step)
    for y in range(height):
        kind, line = raw[y * (width * step + 1)], bytearray(raw[y * (width * step + 1) + 1:(y + 1) * (width * step + 1)])
        for i in range(len(line)):
            a, b, c = (line[i - step], above[i], above[i - step]) if i >= step else (0, above[i], 0)
            paeth = min((a, b, c), key=lambda value: abs(a + b - c - value))
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[kind]) % 256
        above = bytes(line)
        rows.append([tuple(above[i:i + step]) for i in range(0, len(above), step)])
    return (width, height), rows


def shared_server():
    global server
    if server is None:
        server = ForkServer(PROGRAM, PRELOADED)
    return server


class CliTest(unittest.TestCase):
    """A test with a folder of its own, in which the program is started."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="gazetrace_cli_"))
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.write("box.gltf", json.dumps(box_gltf()))

    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, str):
            content = content.encode()
        path.write_bytes(content)
        return path

    def run_program(self, *arguments, timeout=300, environment=None, alone=False):
        variables = {name: value for name, value in os.environ.items() if name != "OCIO"}
        variables.update(environment or {})
        if PRELOADED and not alone:
            result = shared_server().run(arguments, self.folder, variables, timeout)
        else:
            result = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, timeout=timeout,
                                    env=variables, check=False)
        # Not text=True, which would turn the carriage returns of a progress bar into line ends.
        result.stdout, result.stderr = (stream.decode(errors="replace") for stream in (result.stdout, result.stderr))
        return result

    def run_ok(self, *arguments, **more):
        result = self.run_program(*arguments, **more)
        self.assertEqual(result.returncode, 0, f"{arguments}\n{result.stdout}\n{result.stderr}")
        return result

    def assert_refused(self, arguments, words, code=2, **more):
        """This exit code, one line on stderr with all the words, nothing on stdout, no picture or record left."""
        before = set(self.files())
        result = self.run_program(*arguments, **more)
        self.assertEqual(result.returncode, code, f"{arguments}\n{result.stdout}\n{result.stderr}")
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("gazetrace: error: "), lines[0])
        for word in words:
            self.assertIn(word.lower(), lines[0].lower())
        self.assertEqual(result.stdout, "")
        self.assertEqual(set(self.files()), before)
        return lines[0]

    def files(self, folder="."):
        """Without those that stay where runs have been, to be locked."""
        root = self.folder / folder
        return sorted(str(path.relative_to(root)) for path in root.rglob("*") if path.is_file() and path.name != ".gazetrace.lock")

    def pictures(self, folder):
        root = self.folder / folder
        return {path.name: path.read_bytes() for path in root.iterdir() if path.suffix in (".exr", ".png")}


def main():
    program = unittest.main(exit=False)
    result = program.result
    for _, reason in result.skipped:
        print("skipped:", reason)
    if result.wasSuccessful() and result.testsRun and len(result.skipped) == result.testsRun:
        sys.exit(77)
    sys.exit(0 if result.wasSuccessful() else 1)

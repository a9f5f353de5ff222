#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes hostile files of every kind that the program reads, gives it each, and prints what became of it: outcome, time,
peak memory. A file fails that ends the process by a signal, takes more than its limit of time or memory, or is told in
more than a few lines.

    GAZETRACE=build/bin/gazetrace python3 tests/benchmarks/hostile_files.py [--markdown]
"""

import argparse
import base64
import gzip
import json
import os
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
import harness  # noqa: E402

LIMIT_S = 10
LIMIT_MIB = 700
MAX_MEMORY = "512M"


def png_head(width, height, bits=8, color=2):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, color, 0, 0, 0)), chunk


def png_of_zeros(width, height, surplus=0):
    head, chunk = png_head(width, height)
    packer = zlib.compressobj(9)
    data = b"".join(packer.compress(b"\0" * (1 + 3 * width)) for _ in range(height))
    block = b"\0" * (1 << 20)
    data += b"".join(packer.compress(block) for _ in range(surplus >> 20)) + packer.flush()
    return head + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def textured(uri="picture.png"):
    scene = harness.box_gltf()
    scene["images"] = [{"uri": uri}]
    scene["textures"] = [{"source": 0}]
    scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    return scene


def changed(change, camera_seconds=None):
    scene = harness.box_gltf(camera_seconds)
    change(scene)
    return scene


def put(path, value):
    """Sets a value deep in a scene: put("meshes.0.primitives.0.indices", 7)."""
    def change(scene):
        *way, last = [int(word) if word.isdigit() else word for word in path.split(".")]
        at = scene
        for word in way:
            at = at[word]
        at[last] = value
    return change


def nested_nodes(count, cycle=False):
    def change(scene):
        first = len(scene["nodes"])
        scene["nodes"] += [{"children": [first + i + 1]} for i in range(count)] + [{"mesh": 0}]
        if cycle:
            scene["nodes"][-1] = {"children": [first]}
        scene["scenes"][0]["nodes"].append(first)
    return change


def moving_chain(count):
    """Each node below the one before, all with the body, the first one moved: each keeps the transforms of all above."""
    def change(scene):
        first = len(scene["nodes"])
        scene["nodes"] += [{"mesh": 0, "children": [first + i + 1]} for i in range(count)] + [{"mesh": 0}]
        scene["scenes"][0]["nodes"].append(first)
        scene["animations"][0]["channels"].append({"sampler": 0, "target": {"node": first, "path": "translation"}})
    return change


def many_nodes(count):
    def change(scene):
        first = len(scene["nodes"])
        scene["nodes"] += [{"mesh": 0}] * count
        scene["scenes"][0]["nodes"] += list(range(first, first + count))
    return change


def tree_of_nodes(depth):
    """Every node has the next one twice: 2^depth instances of a few nodes."""
    def change(scene):
        first = len(scene["nodes"])
        scene["nodes"] += [{"children": [first + i + 1, first + i + 1]} for i in range(depth)] + [{"mesh": 0}]
        scene["scenes"][0]["nodes"].append(first)
    return change


def sparse_claim(count):
    def change(scene):
        scene["accessors"][0].pop("bufferView")
        scene["accessors"][0]["count"] = count
    return change


def many_lights(count):
    def change(scene):
        lights = scene["extensions"]["KHR_lights_punctual"]["lights"]
        lights[0]["intensity"] = 1e38
        scene["nodes"] += [{"extensions": {"KHR_lights_punctual": {"light": 0}}}] * count
        scene["scenes"][0]["nodes"] += list(range(4, 4 + count))
    return change


def glb(json_length, bin_length, content=b"{}"):
    return b"glTF" + struct.pack("<II", 2, 20 + len(content)) + struct.pack("<I", json_length) + b"JSON" + content + \
        struct.pack("<I", bin_length) + b"BIN\0"


def exr_head(width, height):
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data

    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name + b"\0" + struct.pack("<iBBBBii", 1, 0, 0, 0, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    return struct.pack("<II", 20000630, 2) + attribute(b"channels", b"chlist", channels) + \
        attribute(b"compression", b"compression", b"\3") + attribute(b"dataWindow", b"box2i", box) + \
        attribute(b"displayWindow", b"box2i", box) + attribute(b"lineOrder", b"lineOrder", b"\0") + \
        attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) + \
        attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)) + \
        attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"


def draco_of_claims():
    """A mesh whose stream says that it has 100 million triangles and vertices; the decoder makes room for them at once."""
    stream = b"DRACO\2\2\1\1\0\0\0" + 2 * b"\x80\xc2\xd7\x2f" + bytes(16)
    scene = harness.box_gltf()
    scene["buffers"].append({"byteLength": len(stream), "uri": "data:;base64," + base64.b64encode(stream).decode()})
    scene["bufferViews"].append({"buffer": len(scene["buffers"]) - 1, "byteLength": len(stream)})
    scene["meshes"][0]["primitives"][0]["extensions"] = {
        "KHR_draco_mesh_compression": {"bufferView": len(scene["bufferViews"]) - 1, "attributes": {"POSITION": 0}}}
    scene["extensionsUsed"].append("KHR_draco_mesh_compression")
    return json.dumps(scene)


def scenes():
    """Name -> a scene, or a scene with the files beside it."""
    yield "nodes: a million", changed(many_nodes(1_000_000))
    yield "nodes: 100,000 deep", changed(nested_nodes(100_000))
    yield "nodes: a cycle", changed(nested_nodes(10, cycle=True))
    yield "nodes: 2^40 by children that repeat", changed(tree_of_nodes(40))
    yield "nodes: a scale of 1e38", changed(put("nodes.0.scale", [1e38, 1e38, 1e38]))
    yield "nodes: a scale of 0", changed(put("nodes.0.scale", [0, 0, 0]))
    yield "nodes: a matrix of infinities", changed(put("nodes.0", {"mesh": 0, "matrix": [1e39] * 16}))
    yield "nodes: mesh -1", changed(put("nodes.0.mesh", -1))
    yield "nodes: mesh 2^31", changed(put("nodes.0.mesh", 2**31))
    yield "scene 99", changed(put("scene", 99))
    yield "accessors: 2^31 vertices of nothing", changed(sparse_claim(2**31 - 1))
    yield "accessors: 200 million vertices of nothing", changed(sparse_claim(200_000_000))
    yield "accessors: a count of 0", changed(put("accessors.0.count", 0))
    yield "accessors: a negative count", changed(put("accessors.0.count", -5))
    yield "accessors: an offset of 2^63", changed(put("accessors.0.byteOffset", 2**63 - 1))
    yield "accessors: beyond its view", changed(put("accessors.0.count", 1000))
    yield "accessors: indices of vertices that are not", changed(put("accessors.0.count", 3))
    yield "accessors: an unknown component", changed(put("accessors.0.componentType", 1))
    yield "views: a length of 2^62", changed(put("bufferViews.0.byteLength", 2**62))
    yield "views: a stride of 2^31", changed(put("bufferViews.0.byteStride", 2**31 - 1))
    yield "buffers: a length of 2^40", changed(put("buffers.0.byteLength", 2**40))
    yield "buffers: /etc/passwd", changed(put("buffers.0", {"byteLength": 168, "uri": "/etc/passwd"}))
    yield "buffers: ../../../etc/passwd", changed(put("buffers.0", {"byteLength": 168, "uri": "../../../../../etc/passwd"}))
    yield "buffers: %2e%2e/%2e%2e/etc/passwd", changed(put("buffers.0", {"byteLength": 168, "uri": "%2e%2e/%2e%2e/%2e%2e/etc/passwd"}))
    yield "buffers: /dev/zero", changed(put("buffers.0", {"byteLength": 2**33, "uri": "/dev/zero"}))
    yield "buffers: a broken base64", changed(put("buffers.0.uri", "data:;base64,!!!!"))
    yield "buffers: https://", changed(put("buffers.0.uri", "https://localhost/x.bin"))
    yield "buffers: a name of 10 MB", changed(put("buffers.0", {"byteLength": 168, "uri": "x" * 10_000_000}))
    yield "materials: a name of 10 MB", changed(put("materials.0.name", "y" * 10_000_000))
    yield "materials: not a number", changed(put("materials.0.pbrMetallicRoughness.roughnessFactor", 1e400))
    yield "materials: emission of 1e38", changed(put("materials.0.emissiveFactor", [1e38, 1e38, 1e38]))
    yield "materials: an index of refraction of -1", changed(put("materials.0.extensions", {"KHR_materials_ior": {"ior": -1}}))
    yield "lights: 100,000 of 1e38 candela", changed(many_lights(100_000))
    yield "camera: 180 degrees and more", changed(put("cameras.0.perspective.yfov", 3.5))
    yield "camera: a field of 1e-38", changed(put("cameras.0.perspective.yfov", 1e-38))
    yield "animation: keys that go back", changed(put("accessors.2.min", [5]), 1.0)
    yield "animation: an output that is not there", changed(put("animations.0.samplers.0.output", 77), 1.0)
    yield "animation: a camera as the output", changed(put("animations.0.channels.0.target.node", 99), 1.0)
    yield "animation: 20,000 bodies in a chain that moves", changed(moving_chain(20_000), 1.0)
    yield "skins: 100,000 joints that are one", changed(lambda scene: scene.update(skins=[{"joints": [0] * 100_000}]))
    yield "morph targets: 10,000", changed(put("meshes.0.primitives.0.targets", [{"POSITION": 0}] * 10_000))
    yield "primitives: 100,000 of one mesh", changed(put("meshes.0.primitives", [{"attributes": {"POSITION": 0}, "indices": 1}] * 100_000))
    yield "extensions: an unknown one is required", changed(put("extensionsRequired", ["X_none"]))
    yield "draco: an empty stream", changed(put("meshes.0.primitives.0.extensions", {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}))
    yield "draco: thirty bytes that claim 100 million triangles", draco_of_claims()
    yield "meshopt: a count of 2^31", changed(put("bufferViews.0.extensions", {"EXT_meshopt_compression": {
        "buffer": 0, "byteLength": 96, "byteStride": 12, "count": 2**31 - 1, "mode": "ATTRIBUTES"}}))
    yield "json: 100,000 arrays deep", "[" * 100_000
    yield "json: 50 MB of digits", '{"asset": {"version": "2.0"}, "x": ' + "9" * 50_000_000 + "}"
    yield "json: 15 MB of empty arrays", '{"asset": {"version": "2.0"}, "extras": [' + "[]," * 5_000_000 + "0]}"
    yield "json: half a file", json.dumps(harness.box_gltf())[:800]
    yield "json: zeros", "\0" * 1000
    yield "json: empty", ""
    yield "json: not UTF-8", changed(put("materials.0.name", "\udcff\udcfe"))


def pictures():
    head, chunk = png_head(16384, 16384)
    yield "png: 16384 x 16384 of zeros", png_of_zeros(16384, 16384)
    yield "png: 2 GB of surplus data", png_of_zeros(4, 4, surplus=2 << 30)
    yield "png: 2^31 pixels wide", png_head(2**31 - 1, 1)[0] + chunk(b"IDAT", b"") + chunk(b"IEND", b"")
    yield "png: only its head", head
    yield "png: a text of 100 MB", png_head(4, 4)[0] + chunk(b"zTXt", b"k\0\0" + zlib.compress(b"\0" * 100_000_000)) + \
        chunk(b"IDAT", zlib.compress(b"\0" * 52)) + chunk(b"IEND", b"")
    yield "png: a chunk of 2^31 bytes", png_head(4, 4)[0] + struct.pack(">I", 2**31 - 1) + b"IDAT" + b"\0" * 100
    yield "jpeg: only its head", b"\xff\xd8\xff\xc0\x00\x11\x08\xff\xff\xff\xff\x03\x01\x22\x00\x02\x11\x01\x03\x11\x01" + b"\0" * 50
    yield "picture: nothing", b""
    yield "picture: a pixmap by another name", b"P6\n2 2\n255\n" + b"\7" * 12
    yield "picture: a film by another name", b"\0\0\0\x18ftypisom" + b"\0" * 300


def others():
    """Name -> files by name, and the arguments."""
    box = {"box.gltf": json.dumps(harness.box_gltf())}
    render = ["render", "box.gltf", "--size", "32x18", "--spp", "1", "-o", "out/f.exr", "--quiet"]
    yield "exr: 10^5 x 10^5 by its head", {**box, "sky.exr": exr_head(100_000, 100_000)}, [*render, "--env", "sky.exr"]
    yield "exr: windows turned around", {**box, "sky.exr": exr_head(-5, -5)}, [*render, "--env", "sky.exr"]
    yield "hdr: 10^9 columns by its head", {**box, "sky.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000 +X 1000000000\n"}, [*render, "--env", "sky.hdr"]
    yield "hdr: cut", {**box, "sky.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 512 +X 1024\n\2\2\4\0"}, [*render, "--env", "sky.hdr"]
    yield "gaze: 200 MB that are 200 kB packed", {**box, "log.csv.gz": gzip.compress(b"0,0.5,0.5\n" * 20_000_000)}, \
        [*render, "--gaze", "log.csv.gz", *harness.SCREEN]
    yield "gaze: a line of 50 MB", {**box, "log.csv": b"t[ns],u[1],v[1]\n" + b"1" * 50_000_000}, [*render, "--gaze", "log.csv", *harness.SCREEN]
    yield "gaze: zeros", {**box, "log.csv": b"\0" * 10_000_000}, [*render, "--gaze", "log.csv", *harness.SCREEN]
    yield "gaze: times of 1e300", {**box, "log.csv": harness.gaze_csv(["1e300,0.5,0.5,ok,left"])}, [*render, "--gaze", "log.csv", *harness.SCREEN]
    yield "camera: numbers of 1e300", {**box, "path.tum": "0 1e300 0 0 0 0 0 1\n1 0 0 1e300 0 0 0 1\n"}, [*render, "--camera-path", "path.tum"]
    yield "camera: a cycle of nothing", {**box, "path.tum": "\n" * 1_000_000}, [*render, "--camera-path", "path.tum"]
    yield "job: 10,000 tables deep", {**box, "job.toml": "a = " + "[" * 10_000}, [*render, "--config", "job.toml"]
    yield "job: a key of 10 MB", {**box, "job.toml": "x" * 10_000_000 + " = 1"}, [*render, "--config", "job.toml"]
    yield "job: frames 1-2000000000", {**box, "job.toml": 'frames = "1-2000000000"'}, \
        ["render", "box.gltf", "--size", "8x8", "--config", "job.toml", "-o", "out/f.####.exr"]
    yield "job: 65535 x 65535 pixels", box, ["render", "box.gltf", "--size", "65535x65535", "-o", "out/f.exr"]
    yield "map: 60,000 x 100 by its head", {**box, "map.exr": exr_head(60_000, 100) + b"\1" * 3000}, \
        [*render, "--density", "map.exr"]
    yield "map: 100,000,000 x 4 by its head", {**box, "map.exr": exr_head(100_000_000, 4) + b"\1" * 3000}, \
        [*render, "--density", "map.exr"]
    grid = "\n".join(f"{key} = {list(range(1, 101))}" for key in ("spp", "bounces", "block-samples", "exposure-key"))
    yield "plan: a grid of 10^8 rows", {**box, "plan.toml": '[[scene]]\nname = "a"\npath = "box.gltf"\n[[gaze]]\nname = "m"\n'
                                        'at = [0.5, 0.5]\n[grid]\n' + grid}, ["sweep", "plan.toml", "-o", "s"]
    yield "map: a picture of nothing", {**box, "map.exr": b"v/1\1" + b"\0" * 200}, [*render, "--density", "map.exr"]
    yield "record: frames 1-2000000000", {"out/f.timing.1-2.csv": "", "out/f.run.1-2.json": json.dumps({"frames": "1-2000000000"})}, ["merge", "out"]
    yield "record: 100,000 arrays deep", {"out/f.timing.1-2.csv": "", "out/f.run.1-2.json": "[" * 100_000}, ["merge", "out"]
    yield "table: a line of 20 MB", {"out/f.timing.1-2.csv": "1" * 20_000_000, "out/f.run.1-2.json": "{}"}, ["merge", "out"]
    yield "results of a sweep: 100,000 arrays deep", {"s/results.json": "[" * 100_000}, ["report", "s"]
    yield "farm.json: numbers for names", {"out/farm/farm.json": json.dumps({"name": 1})}, ["farm", "status", "out"]
    yield "farm.json: 100,000 arrays deep", {"out/farm/farm.json": "[" * 100_000}, ["farm", "status", "out"]


def cases():
    scene = ["render", "scene.gltf", "--size", "32x18", "--spp", "1", "-o", "out/f.exr", "--quiet", "--max-memory", MAX_MEMORY]
    for name, content in scenes():
        text = content if isinstance(content, str) else json.dumps(content)
        yield name, {"scene.gltf": text}, scene
    for name, lengths in (("glb: chunks of 2^32 bytes", (2**32 - 1, 2**32 - 1)), ("glb: a chunk of 0 bytes", (0, 0))):
        yield name, {"scene.glb": glb(*lengths)}, ["render", "scene.glb", *scene[2:]]
    for name, content in pictures():
        yield name, {"scene.gltf": json.dumps(textured()), "picture.png": content}, scene
        if name == "png: 16384 x 16384 of zeros":
            inside = "data:image/png;base64," + base64.b64encode(content).decode()
            yield name + ", within the scene", {"scene.gltf": json.dumps(textured(inside))}, scene
    yield from others()
    large = {name: Sparse(content, 6_000_000_000) for name, content in (("scene.glb", glb(2**32 - 1, 2**32 - 1)), ("scene.gltf", b"{}"),
                                                                     ("padded.png", png_of_zeros(4, 4)), ("data.bin", b"\0" * 200))}
    for name in ("scene.glb", "scene.gltf"):
        yield f"{name[6:]}: a file of 6 GB", {name: large[name]}, ["render", name, *scene[2:]]
    yield "png: 4 x 4 in a file of 6 GB", {"scene.gltf": json.dumps(textured("padded.png")), "padded.png": large["padded.png"]}, scene
    buffer_in_file = harness.box_gltf()
    inside = base64.b64decode(buffer_in_file["buffers"][0]["uri"].split(",")[1])
    buffer_in_file["buffers"][0]["uri"] = "data.bin"
    yield "buffer: a file of 6 GB, of which little is used", {"scene.gltf": json.dumps(buffer_in_file),
                                                             "data.bin": Sparse(inside, 6_000_000_000)}, scene
    yield "job: a file of 3 GB", {"job.toml": Sparse(b"a = 1\n", 3_000_000_000)}, ["render", "--config", "job.toml", "-o", "out/f.exr"]


class Sparse:
    """A file that begins with these bytes and goes on with zeros, which take no room."""

    def __init__(self, content, size):
        self.content, self.size = content, size

    def write_to(self, path):
        path.write_bytes(self.content)
        os.truncate(path, self.size)


def most_memory_mib(process):
    """The peak of a process so far; its resource usage would hold that of this script before it became the program."""
    try:
        with open(f"/proc/{process}/status", encoding="ascii") as file:
            return next((int(line.split()[1]) / 1024 for line in file if line.startswith("VmHWM")), 0)
    except OSError:
        return 0


def run(name, files, arguments):
    with tempfile.TemporaryDirectory(prefix="gazetrace_hostile_") as folder:
        for file, content in files.items():
            path = Path(folder) / file
            path.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(content, Sparse):
                content.write_to(path)
            else:
                path.write_bytes(content.encode(errors="surrogateescape") if isinstance(content, str) else content)
        begin = time.monotonic()
        with open(Path(folder) / ".said", "wb+") as said:
            process = subprocess.Popen([harness.PROGRAM, *arguments], cwd=folder, stdout=said, stderr=said)
            mib = 0.0
            while True:
                mib = max(mib, most_memory_mib(process.pid))
                done, state, usage = os.wait4(process.pid, os.WNOHANG)
                if done:
                    break
                if time.monotonic() - begin > 6 * LIMIT_S:
                    process.kill()
                time.sleep(0.005)
            process.returncode = os.waitstatus_to_exitcode(state)
            said.seek(0)
            text = said.read().decode(errors="replace")
    cpu_s = usage.ru_utime + usage.ru_stime
    problems = [words for is_so, words in (
        (process.returncode < 0 or process.returncode > 4, f"ended with {process.returncode}"),
        (cpu_s > LIMIT_S, "takes too long"),
        (mib > LIMIT_MIB, "takes too much memory"),
        (len(text) > 20_000, "says too much"),
        ("root:" in text, "shows another file")) if is_so]
    last = text.strip().splitlines()[-1] if text.strip() else ""
    return process.returncode, cpu_s, mib, last, ", ".join(problems)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--only", default="", help="cases whose name holds this")
    arguments = parser.parse_args()
    wrong = count = 0
    if arguments.markdown:
        print("| file | exit | CPU s | MiB | what is said |\n| --- | --- | --- | --- | --- |")
    for name, files, words in cases():
        if arguments.only not in name:
            continue
        code, cpu_s, mib, said, problem = run(name, files, words)
        count += 1
        wrong += bool(problem)
        said = said.replace("gazetrace: error: ", "")[:110].replace("|", "\\|") + ("" if not problem else f" WRONG: {problem}")
        row = (name, code, f"{cpu_s:.2f}", f"{mib:.0f}", said)
        print("| " + " | ".join(map(str, row)) + " |" if arguments.markdown else f"{name:<45}{code:>4}{cpu_s:>8.2f} s{mib:>7.0f} MiB  {said}",
              flush=True)
    print(f"\n{count} files, {wrong} of them outside of their limits ({LIMIT_S} s of CPU, {LIMIT_MIB} MiB)")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""How objects move, as keys of glTF nodes, one a frame.

Blender's exporters bake constraints, drivers and parents each in their own way, and older ones only in part. Here every
object is where Blender shows it: the world matrix of each frame becomes the key of its node. What moves in bones and
shape keys is left as the exporter wrote it.
"""

from collections.abc import Iterable, Mapping

import bpy
import numpy as np
from mathutils import Matrix, Quaternion

from .frames import FrameRange
from .glb import Glb

# glTF has y up and Blender z: (x, y, z) becomes (x, z, -y).
TO_Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
# A change of a local matrix that is less is the noise of single precision.
STILL = 1e-6


def world_matrices(scene: bpy.types.Scene, frames: Iterable[int]) -> dict[str, np.ndarray]:
    """Of each object the evaluated world matrix at each of the frames."""
    matrices: dict[str, list[np.ndarray]] = {item.name: [] for item in scene.objects}
    for frame in frames:
        scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for item in scene.objects:
            matrices[item.name].append(np.array(item.evaluated_get(depsgraph).matrix_world, float))
    return {name: np.array(of_frames) for name, of_frames in matrices.items()}


def animate(glb: Glb, matrices: Mapping[str, np.ndarray], frames: FrameRange) -> None:
    """Gives the nodes of moving objects their keys and leaves one animation."""
    document = glb.document
    nodes = document.get("nodes", [])
    parents = {child: index for index, node in enumerate(nodes) for child in node.get("children", [])}
    bones = {joint for skin in document.get("skins", []) for joint in skin["joints"]}
    moved_here = {index: nodes[index]["name"] for index in nodes_of_objects(nodes, parents, bones, matrices)}
    channels, samplers = kept_channels(document, set(moved_here))
    times = None
    global_motion: dict[int, np.ndarray] = {}
    for index in from_the_roots(nodes, parents):
        rest = local_matrix(nodes[index])
        above = global_motion.get(parents.get(index, -1), np.eye(4)[None])
        if index not in moved_here:
            global_motion[index] = above @ rest
            continue
        motion = TO_Y_UP @ matrices[moved_here[index]]
        as_exported = (above[min(frames.shown, len(above) - 1)]) @ rest
        motion = motion @ closing(motion[frames.shown], as_exported)
        global_motion[index] = motion
        local = np.linalg.inv(above) @ motion
        if np.abs(local - local[0]).max() <= STILL * max(1.0, np.abs(local).max()):
            continue
        if times is None:
            times = glb.add_floats(np.array([frames.seconds(f) for f in frames.baked()]), "SCALAR")
        nodes[index].pop("matrix", None)
        for path, kind, keys in keys_of(local):
            nodes[index][path] = keys[0].tolist()
            samplers.append({"input": times, "output": glb.add_floats(keys, kind), "interpolation": "LINEAR"})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": index, "path": path}})
    document.pop("animations", None)
    if channels:
        document["animations"] = [{"name": "Blender", "channels": channels, "samplers": samplers}]


def scale_times(glb: Glb, factor: float, offset_s: float) -> None:
    """Stretches and moves the keys that the exporter wrote; none comes before 0."""
    inputs = {s["input"] for animation in glb.document.get("animations", []) for s in animation["samplers"]}
    for accessor in inputs:
        glb.floats(accessor)[:] = np.maximum(glb.floats(accessor) * np.float32(factor) + np.float32(offset_s), 0)
        for bound in ("min", "max"):
            glb.document["accessors"][accessor][bound] = [float(getattr(glb.floats(accessor), bound)())]


def nodes_of_objects(nodes: list[dict], parents: Mapping[int, int], bones: set[int], names: Iterable[str]) -> list[int]:
    """The nodes that stand for one object each: not bones and what hangs on them, not skins, not copies by instancing."""
    known = set(names)
    found: dict[str, int] = {}
    for index in from_the_roots(nodes, parents):
        node = nodes[index]
        line = [index]
        while line[-1] in parents:
            line.append(parents[line[-1]])
        instanced = any(
            bpy.data.objects[nodes[above]["name"]].instance_type != "NONE"
            for above in line[1:]
            if nodes[above].get("name") in known
        )
        if node.get("name") in known and "skin" not in node and not instanced and not bones.intersection(line):
            found.setdefault(node["name"], index)
    return list(found.values())


def from_the_roots(nodes: list[dict], parents: Mapping[int, int]) -> list[int]:
    """The numbers of all nodes, parents before their children."""
    order = [index for index in range(len(nodes)) if index not in parents]
    for index in order:
        order.extend(nodes[index].get("children", []))
    return order


def kept_channels(document: dict, moved_here: set[int]) -> tuple[list[dict], list[dict]]:
    """The channels of all animations in one, without those that move objects."""
    channels: list[dict] = []
    samplers: list[dict] = []
    for animation in document.get("animations", []):
        for channel in animation["channels"]:
            node, path = channel["target"].get("node"), channel["target"]["path"]
            if path != "weights" and (node in moved_here or node is None):
                continue
            samplers.append(animation["samplers"][channel["sampler"]])
            channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
    return channels, samplers


def local_matrix(node: dict) -> np.ndarray:
    """The matrix of a node in its parent."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    matrix = Matrix.LocRotScale(node.get("translation", (0, 0, 0)), Quaternion((w, x, y, z)), node.get("scale", (1, 1, 1)))
    return np.array(matrix, float)


def closing(motion: np.ndarray, as_exported: np.ndarray) -> np.ndarray:
    """What a node does after its object's matrix: meshes are written with y up, some exporters' cameras are as they are."""
    back = np.linalg.inv(TO_Y_UP)
    return min((back, np.eye(4)), key=lambda last: np.abs(motion @ last - as_exported).max())


def keys_of(local: np.ndarray) -> list[tuple[str, str, np.ndarray]]:
    """The keys of local matrices as the paths of a node, each with its accessor's type."""
    parts = [Matrix(matrix).decompose() for matrix in local]
    turns = np.array([(q.x, q.y, q.z, q.w) for _, q, _ in parts])
    for previous, turn in zip(turns, turns[1:]):  # The same rotation has two signs: take the nearer one.
        if previous @ turn < 0:
            turn *= -1
    return [
        ("translation", "VEC3", np.array([tuple(move) for move, _, _ in parts])),
        ("rotation", "VEC4", turns),
        ("scale", "VEC3", np.array([tuple(scale) for _, _, scale in parts])),
    ]

# SPDX-License-Identifier: Apache-2.0
"""Area lights as meshes that shine, since glTF has lights without a size only: the same flux from the same surface. Suns
with the strength and colour that Cycles gives them."""

import math

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from .glb import Glb
from .motion import TO_Y_UP

# Of a disc or an ellipse; the polygon has the area of what it stands for.
CORNERS = 64


def area_lights(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The area lights that renders show."""
    return [item for item in scene.objects if item.type == "LIGHT" and item.data.type == "AREA" and not item.hide_render]


def add_area_lights(glb: Glb, scene: bpy.types.Scene, matrices: dict[str, np.ndarray], shown_index: int) -> None:
    """Appends a shining mesh for each, whose node moves as its light: it gets the light's entry of `matrices`."""
    for item in area_lights(scene):
        node_name = f"{item.name} (area light)"
        shown = TO_Y_UP @ matrices[item.name][shown_index]
        triangles = triangles_of(item.data)
        radiance = radiance_of(item.data, area_m2(triangles @ shown[:3, :3].T))
        if max(radiance) > 0:
            matrices[node_name] = matrices[item.name]
            append(glb, node_name, triangles, shown, radiance)


def set_suns(glb: Glb) -> None:
    """Cycles multiplies a sun's strength and colour by those of its node; Blender's exporter takes the node's alone where
    there is one, and 5.2 gives one to every sun."""
    for entry in glb.document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", []):
        sun = bpy.data.lights.get(entry.get("name", ""))
        shown = emission_shown(sun) if entry["type"] == "directional" and sun is not None else None
        if shown is not None:
            strength, colour = shown
            entry["intensity"] = sun.energy * 2 ** getattr(sun, "exposure", 0.0) * strength
            entry["color"] = [a * b for a, b in zip(colour_of(sun), colour)]


def emission_shown(sun: bpy.types.SunLight) -> tuple[float, list[float]] | None:
    """Strength and colour by which its nodes multiply its own: of the emission that the active output shows, none where it
    shows nothing. None where other nodes compute them."""
    if not sun.use_nodes or sun.node_tree is None:
        return 1.0, [1.0, 1.0, 1.0]
    output = sun.node_tree.get_output_node("CYCLES")
    links = output.inputs["Surface"].links if output is not None else ()
    while links and links[0].from_node.type == "REROUTE":
        links = links[0].from_node.inputs[0].links
    node = links[0].from_node if links else None
    if node is None or (node.type == "EMISSION" and node.mute):
        return 0.0, [1.0, 1.0, 1.0]
    if node.type != "EMISSION" or node.inputs["Strength"].is_linked or node.inputs["Color"].is_linked:
        return None
    return node.inputs["Strength"].default_value, list(node.inputs["Color"].default_value)[:3]


def colour_of(light: bpy.types.Light) -> list[float]:
    """Of its light, with that of its temperature."""
    colour = [float(part) for part in light.color]
    if getattr(light, "use_temperature", False):
        colour = [a * b for a, b in zip(colour, light.temperature_color)]
    return colour


def triangles_of(light: bpy.types.AreaLight) -> np.ndarray:
    """The corners of its triangles in its own axes, three rows each. It shines along -z."""
    width = light.size
    height = light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size
    if light.shape in ("SQUARE", "RECTANGLE"):
        ring = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) / 2
    else:
        turns = np.arange(CORNERS) * (2 * math.pi / CORNERS)
        radius = 0.5 * math.sqrt(2 * math.pi / CORNERS / math.sin(2 * math.pi / CORNERS))
        ring = radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    ring = np.column_stack([ring * (width, height), np.zeros(len(ring))])
    # Clockwise about +z, so that the front is below.
    return np.concatenate([[ring[0], ring[i + 1], ring[i]] for i in range(1, len(ring) - 1)])


def area_m2(triangles: np.ndarray) -> float:
    """The sum over triangles, three rows each."""
    a, b, c = triangles[0::3], triangles[1::3], triangles[2::3]
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def radiance_of(light: bpy.types.AreaLight, area: float) -> list[float]:
    """Of a surface that sends the light's watts evenly to one side: flux / (pi area)."""
    watts = light.energy * 2 ** getattr(light, "exposure", 0.0)
    is_for_its_size = getattr(light, "normalize", True)  # else watts are those of a square metre
    surface = area if is_for_its_size else 1.0
    return [part * watts / (math.pi * surface) if surface > 0 else 0.0 for part in colour_of(light)]


def append(glb: Glb, name: str, triangles: np.ndarray, matrix: np.ndarray, radiance: list[float]) -> None:
    """A surface that shines on its front, and that other light passes as if it were not there, at the root of the scene."""
    document = glb.document
    peak = max(radiance)
    material = {
        "name": name,
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
        "emissiveFactor": [part / peak for part in radiance],
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": peak},
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_ior": {"ior": 1},
            "KHR_materials_specular": {"specularFactor": 0},
        },
    }
    used = document.setdefault("extensionsUsed", [])
    used.extend(extension for extension in material["extensions"] if extension not in used)
    document.setdefault("materials", []).append(material)
    primitive = {"attributes": {"POSITION": glb.add_floats(triangles, "VEC3")}, "material": len(document["materials"]) - 1}
    document.setdefault("meshes", []).append({"name": name, "primitives": [primitive]})
    document.setdefault("nodes", []).append(
        {"name": name, "mesh": len(document["meshes"]) - 1, "matrix": matrix.T.ravel().tolist()}
    )
    document["scenes"][document.get("scene", 0)].setdefault("nodes", []).append(len(document["nodes"]) - 1)


def lost_of_lights(scene: bpy.types.Scene) -> list[str]:
    """What of lights is other than in Blender, in a sentence each."""
    sentences = []
    for item in area_lights(scene):
        if item.data.spread < math.pi - 1e-3:
            degrees = math.degrees(item.data.spread)
            sentences.append(f"Area light '{item.name}' shines evenly, though its spread is {degrees:.0f} degrees.")
        if not getattr(item, "visible_camera", True) and is_in_view(scene, item):
            sentences.append(f"Area light '{item.name}' is seen by the camera, from which Blender hides it.")
    for item in scene.objects:
        if item.type != "LIGHT" or item.hide_render:
            continue
        animation = item.data.animation_data
        if animation is not None and (animation.action is not None or animation.drivers):
            sentences.append(f"The light of '{item.name}' stays as in the first frame.")
        if item.data.type == "SUN" and emission_shown(item.data) is None:
            sentences.append(f"Sun '{item.name}' has strength and colour as Blender's glTF exporter takes them: its nodes compute them.")
    return sentences


def is_in_view(scene: bpy.types.Scene, item: bpy.types.Object) -> bool:
    """Whether the camera sees a corner of the front of an area light in the current frame."""
    if scene.camera is None:
        return False
    to_camera = scene.camera.matrix_world.translation - item.matrix_world.translation
    if to_camera.dot(item.matrix_world.to_3x3() @ Vector((0, 0, -1))) <= 0:
        return False
    for corner in triangles_of(item.data):
        seen = world_to_camera_view(scene, scene.camera, item.matrix_world @ Vector(corner))
        if seen.z > 0 and 0 <= seen.x <= 1 and 0 <= seen.y <= 1:
            return True
    return False

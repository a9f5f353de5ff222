# SPDX-License-Identifier: Apache-2.0
"""The light of the world: a colour, or an environment texture, as a Background node shows it."""

import math
import os
from pathlib import Path

import bpy

from .refusal import Refusal
from .toml import Value

SIMPLER = "use a Background node with a colour or an Environment Texture"

# At a direction (x, y, z) Blender's picture shows the column 1/2 - atan2(y, x) / turn, gazetrace's 1/2 + atan2(x, y) / turn.
BLENDER_TURN_DEG = 90.0


def world_options(world: bpy.types.World | None, job_folder: Path, side_folder: Path) -> dict[str, Value]:
    """The options of the environment; packed pictures are written into `side_folder`."""
    if world is None:
        return {"env": "none"}
    if not world.use_nodes:
        return constant(world.color, 1.0)
    output = world.node_tree.get_output_node("CYCLES")
    if output is None or not output.inputs["Surface"].is_linked:
        return {"env": "none"}
    background = source_node(output.inputs["Surface"], "BACKGROUND")
    strength = unlinked_value(background.inputs["Strength"])
    colour = background.inputs["Color"]
    if strength == 0:
        return {"env": "none"}
    if not colour.is_linked:
        return constant(colour.default_value, strength)
    texture = source_node(colour, "TEX_ENVIRONMENT")
    if texture.projection != "EQUIRECTANGULAR":
        raise Refusal(f"the environment texture '{texture.name}' is a mirror ball", "use an equirectangular one")
    if texture.image is None:
        raise Refusal(f"the environment texture '{texture.name}' has no image", "open one")
    picture = picture_file(texture.image, side_folder)
    return {
        "env": os.path.relpath(picture, job_folder),
        "env-rotation": BLENDER_TURN_DEG + mapping_turn_deg(texture.inputs["Vector"]),
        "env-ev": math.log2(strength),
    }


def constant(colour: bpy.types.bpy_prop_array, strength: float) -> dict[str, Value]:
    """The same radiance from everywhere."""
    radiance = [channel * strength for channel in tuple(colour)[:3]]
    return {"env": "constant:" + ",".join(f"{channel:.9g}" for channel in radiance) if any(radiance) else "none"}


def source_node(socket: bpy.types.NodeSocket, wanted: str) -> bpy.types.ShaderNode:
    """The node that feeds a socket, which must be of the wanted type."""
    node = socket.links[0].from_node
    while node.type == "REROUTE" and node.inputs[0].is_linked:
        node = node.inputs[0].links[0].from_node
    if node.type != wanted:
        raise Refusal(f"node '{node.name}' of the world has no counterpart in gazetrace", SIMPLER)
    return node


def unlinked_value(socket: bpy.types.NodeSocket) -> float:
    """The number that stands in a socket."""
    if socket.is_linked:
        raise Refusal(f"the world's {socket.name.lower()} is made by other nodes", "give it a number")
    return socket.default_value


def mapping_turn_deg(socket: bpy.types.NodeSocket) -> float:
    """How far a Mapping node before the texture turns it about the vertical, in degrees."""
    if not socket.is_linked or socket.links[0].from_node.type == "TEX_COORD":
        return 0.0
    mapping = source_node(socket, "MAPPING")
    location, rotation, scale = (mapping.inputs[name] for name in ("Location", "Rotation", "Scale"))
    turns_only = (
        mapping.vector_type in ("POINT", "TEXTURE", "VECTOR")
        and not any(part.is_linked for part in (location, rotation, scale))
        and (mapping.vector_type == "VECTOR" or not any(location.default_value))
        and not any(rotation.default_value[:2])
        and tuple(scale.default_value) == (1, 1, 1)
    )
    if not turns_only:
        raise Refusal(f"node '{mapping.name}' does more than turn the world about z", "rotate about z alone")
    turn = math.degrees(rotation.default_value[2])
    return -turn if mapping.vector_type == "TEXTURE" else turn


def picture_file(image: bpy.types.Image, side_folder: Path) -> Path:
    """The file of an environment texture, .hdr or .exr."""
    path = Path(bpy.path.abspath(image.filepath_raw, library=image.library))
    if image.packed_file is not None:
        path = side_folder / (Path(image.filepath_raw).name or image.name)
        path.write_bytes(image.packed_file.data)
    if path.suffix.lower() not in (".hdr", ".exr"):
        raise Refusal(f"the environment texture {path.name} is neither .hdr nor .exr", "convert it and open that file")
    return path

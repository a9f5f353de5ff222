# SPDX-License-Identifier: Apache-2.0
"""The light of the world: a colour, or an environment texture, as a Background node shows it; all else is baked."""

import math
import os
from pathlib import Path

import bpy
import numpy as np

from .toml import Value

# A pixel is a third of the sun's width. Only at edges more than the fewest samples are taken.
BAKED_SIZE_PX, FEWEST_SAMPLES, MOST_SAMPLES = (2048, 1024), 4, 64
# The sun is a few pixels with most of the light: those around a peak that is so much brighter than the mean are baked
# again, with as many samples each as tell the sun's flux to a thousandth.
PEAK, AROUND_PX, PEAK_SAMPLES = 100, 8, 4096

# At a direction (x, y, z) Blender's picture shows the column 1/2 - atan2(y, x) / turn, gazetrace's 1/2 + atan2(x, y) / turn.
BLENDER_TURN_DEG = 90.0


class NotPlain(Exception):
    """A world that no option describes."""


def world_options(scene: bpy.types.Scene, job_folder: Path, side_folder: Path) -> dict[str, Value]:
    """The options of the environment. Pictures that have no file of their own are written into `side_folder`."""
    if scene.world is None:
        return {"env": "none"}
    try:
        return plain_options(scene.world, job_folder, side_folder)
    except NotPlain:
        picture = side_folder / "world.exr"
        bake(scene, picture)
        return {"env": os.path.relpath(picture, job_folder)}


def plain_options(world: bpy.types.World, job_folder: Path, side_folder: Path) -> dict[str, Value]:
    """The options for a colour, or for an environment texture in a format that gazetrace reads, turned about z."""
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
    if texture.projection != "EQUIRECTANGULAR" or texture.image is None:
        raise NotPlain
    picture = picture_file(texture.image, side_folder)
    return {
        "env": os.path.relpath(picture, job_folder),
        "env-rotation": BLENDER_TURN_DEG + mapping_turn_deg(texture.inputs["Vector"]),
        "env-ev": math.log2(strength),
    }


def bake(scene: bpy.types.Scene, path: Path) -> None:
    """Cycles renders what is seen of the world all around, at the current frame."""
    camera = bpy.data.cameras.new("gazetrace world")
    camera.type = "PANO"
    # Blender 5 has it as a setting of its own, older ones have it as one of Cycles.
    panorama = camera if hasattr(camera, "panorama_type") else camera.cycles
    panorama.panorama_type = "EQUIRECTANGULAR"
    eye = bpy.data.objects.new("gazetrace world", camera)
    eye.rotation_euler = (math.pi / 2, 0, 0)  # towards +y, which the middle of gazetrace's environments shows
    baking = bpy.data.scenes.new("gazetrace world")
    try:
        baking.world, baking.camera = scene.world, eye
        baking.collection.objects.link(eye)
        baking.frame_set(scene.frame_current)
        render = baking.render
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y, render.resolution_percentage = *BAKED_SIZE_PX, 100
        render.filepath = str(path)
        render.use_file_extension = False
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        cycles = baking.cycles
        cycles.samples, cycles.adaptive_min_samples, cycles.use_adaptive_sampling = MOST_SAMPLES, FEWEST_SAMPLES, True
        cycles.pixel_filter_type, cycles.use_denoising = "BOX", False
        bpy.ops.render.render(write_still=True, scene=baking.name)
        bake_peak(baking, path)
    finally:
        bpy.data.scenes.remove(baking)
        bpy.data.objects.remove(eye)
        bpy.data.cameras.remove(camera)


def bake_peak(baking: bpy.types.Scene, path: Path) -> None:
    """Renders the surroundings of the brightest pixel of a baked picture again, with many samples, and puts them in."""
    width, height = BAKED_SIZE_PX
    picture = bpy.data.images.load(str(path), check_existing=False)
    peak_path = path.with_suffix(".peak.exr")
    try:
        values = np.empty(width * height * 4, np.float32)
        picture.pixels.foreach_get(values)
        values = values.reshape(height, width, 4)
        light = values[..., :3].mean(axis=2)
        if light.max() < PEAK * light.mean():
            return
        y, x = np.unravel_index(light.argmax(), light.shape)
        left, low = max(0, int(x) - AROUND_PX), max(0, int(y) - AROUND_PX)
        right, high = min(width, int(x) + AROUND_PX), min(height, int(y) + AROUND_PX)
        render = baking.render
        render.use_border = True
        # A quarter of a pixel inwards, so that rounding keeps the edges.
        render.border_min_x, render.border_max_x = (left + 0.25) / width, (right - 0.25) / width
        render.border_min_y, render.border_max_y = (low + 0.25) / height, (high - 0.25) / height
        render.filepath = str(peak_path)
        baking.cycles.use_adaptive_sampling, baking.cycles.samples = False, PEAK_SAMPLES
        bpy.ops.render.render(write_still=True, scene=baking.name)
        peak = bpy.data.images.load(str(peak_path), check_existing=False)
        again = np.empty(width * height * 4, np.float32)
        peak.pixels.foreach_get(again)
        bpy.data.images.remove(peak)
        values[low:high, left:right] = again.reshape(height, width, 4)[low:high, left:right]
        picture.pixels.foreach_set(values.ravel())
        picture.filepath_raw, picture.file_format = str(path), "OPEN_EXR"
        picture.save()
    finally:
        bpy.data.images.remove(picture)
        peak_path.unlink(missing_ok=True)


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
        raise NotPlain
    return node


def unlinked_value(socket: bpy.types.NodeSocket) -> float:
    """The number that stands in a socket."""
    if socket.is_linked:
        raise NotPlain
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
        raise NotPlain
    turn = math.degrees(rotation.default_value[2])
    return -turn if mapping.vector_type == "TEXTURE" else turn


def picture_file(image: bpy.types.Image, side_folder: Path) -> Path:
    """The file of an environment texture, .hdr or .exr."""
    path = Path(bpy.path.abspath(image.filepath_raw, library=image.library))
    if image.packed_file is not None:
        path = side_folder / (Path(image.filepath_raw).name or image.name)
        path.write_bytes(image.packed_file.data)
    if path.suffix.lower() not in (".hdr", ".exr"):
        raise NotPlain
    return path

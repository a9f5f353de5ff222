# SPDX-License-Identifier: Apache-2.0
"""Writes the scene as binary glTF, with everything that moves baked frame by frame, and the projection of its camera."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

from .camera import Projection
from .frames import FrameRange
from .glb import Glb
from .lights import add_area_lights, lost_of_lights, set_suns
from .motion import animate, from_the_roots, scale_times, world_matrices
from .refusal import Refusal

# What is asked of Blender's exporter. Names that an older or newer one does not know are left out.
EXPORTER_OPTIONS = {
    "export_format": "GLB",
    "use_active_scene": True,
    "use_renderable": True,
    "export_cameras": True,
    "export_lights": True,
    "export_apply": True,
    "export_yup": True,
    "export_extras": False,
    "export_current_frame": True,
    "export_animations": True,
    "export_frame_range": True,
    "export_force_sampling": True,
    "export_optimize_animation_size": False,
    "export_nla_strips": False,  # 3.4: what is shown, not all actions
    "export_animation_mode": "SCENE",  # newer ones say it so
    "export_anim_slide_to_zero": False,
    # Watts per steradian and per square metre as they are; gazetrace's light has no unit but the scene's.
    "convert_lighting_mode": "COMPAT",
    "export_import_convert_lighting_mode": "COMPAT",
}

# Kinds of objects that the exporter passes over without a word.
LEFT_OUT = {"CURVES": "curves of hair", "POINTCLOUD": "clouds of points", "GREASEPENCIL": "grease pencil", "GPENCIL": "grease pencil"}
# Modifiers by which a mesh may change from frame to frame.
CHANGING = ("MESH_SEQUENCE_CACHE", "MESH_CACHE", "CLOTH", "SOFT_BODY", "OCEAN", "WAVE", "FLUID", "DYNAMIC_PAINT", "EXPLODE")
# Of nodes that make a colour or a surface, those that are carried over.
COMPUTED = ("TEX_", "BSDF_", "SUBSURFACE", "VOLUME", "PRINCIPLED_VOLUME", "VALTORGB", "BUMP", "SCRIPT")
CARRIED = ("TEX_IMAGE", "TEX_COORD", "BSDF_PRINCIPLED", "BSDF_TRANSPARENT", "BSDF_DIFFUSE", "BSDF_GLOSSY")


def export_scene(
    scene: bpy.types.Scene, frames: FrameRange, camera: bpy.types.Object, projection: Projection, path: Path
) -> str:
    """Writes the scene, and returns the name of the camera in the file."""
    glb = export_moving(scene, frames, path)
    name = "camera of the job"
    place_camera(glb.document, camera.name, projection, name)
    glb.write(path)
    return name


def export_moving(scene: bpy.types.Scene, frames: FrameRange, path: Path) -> Glb:
    """The scene with area lights and everything that moves, which is still to be written; `path` is overwritten."""
    with frame_kept(scene):
        matrices = world_matrices(scene, frames.baked())
        scene.frame_set(frames.first)
        with time_for_exporter(scene, frames):
            run_exporter(path)
    glb = Glb(path)
    drop_pointers(glb.document)
    scale_times(glb, scene.render.fps_base, frames.seconds(frames.first) - float(frames.first / frames.fps))
    set_suns(glb)
    add_area_lights(glb, scene, matrices, frames.shown)
    animate(glb, matrices, frames)
    return glb


def run_exporter(path: Path) -> None:
    """Calls the exporter that comes with Blender."""
    try:
        known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    except (AttributeError, KeyError):
        raise Refusal("Blender's glTF exporter is off", "switch on the add-on 'glTF 2.0 format'") from None
    options = {name: value for name, value in EXPORTER_OPTIONS.items() if name in known}
    if bpy.app.version[:2] == (4, 2):
        options["export_pointer_animation"] = True  # else that of 4.2 looks for values of cameras that it did not keep
    # It knows these by id(), which changes where nobody holds them.
    held = [*bpy.data.cameras, *bpy.data.lights, *bpy.data.materials, *bpy.data.objects, *bpy.data.meshes]
    try:
        bpy.ops.export_scene.gltf(filepath=str(path), **options)
    except RuntimeError as error:  # of 4.2: where bones or shape keys move a material's mesh
        last = next((line for line in reversed(str(error).splitlines()) if line and not line.startswith("Location")), "")
        raise Refusal(f"Blender's glTF exporter failed: {last.strip()}", "export it by a newer Blender") from error
    held.clear()


def drop_pointers(document: dict) -> None:
    """Takes out what moves something other than nodes and weights."""
    for animation in document.get("animations", []):
        animation["channels"] = [channel for channel in animation["channels"] if channel["target"]["path"] != "pointer"]
    if "animations" in document:
        document["animations"] = [animation for animation in document["animations"] if animation["channels"]]
        if not document["animations"]:
            del document["animations"]
    for key in ("extensionsUsed", "extensionsRequired"):
        if key in document:
            document[key] = [name for name in document[key] if name != "KHR_animation_pointer"]


def place_camera(document: dict, object_name: str, projection: Projection, name: str) -> None:
    """Gives a camera its projection, and its node the name by which gazetrace finds it."""
    nodes = document.get("nodes", [])
    parents = {child: index for index, node in enumerate(nodes) for child in node.get("children", [])}
    for index in from_the_roots(nodes, parents):
        owner = nodes[index] if nodes[index].get("name") == object_name else nodes[parents.get(index, index)]
        if "camera" in nodes[index] and owner.get("name") == object_name:
            document["cameras"].append({"name": object_name, **projection.gltf()})
            nodes[index]["camera"] = len(document["cameras"]) - 1
            nodes[index]["name"] = name
            return
    raise Refusal(f"camera '{object_name}' was not exported", "let it be shown in renders")


def left_out(scene: bpy.types.Scene) -> list[str]:
    """What of the scene glTF does not carry, in a sentence each."""
    sentences = lost_of_lights(scene)
    for item in scene.objects:
        if item.hide_render:
            continue
        if item.type == "VOLUME" or item.particle_systems:
            sentences.append(f"Volumes and particles of '{item.name}' are left out: glTF has none.")
        if item.type in LEFT_OUT:
            sentences.append(f"'{item.name}' is left out: glTF has no {LEFT_OUT[item.type]}.")
        changing = sorted({modifier.name for modifier in item.modifiers if modifier.type in CHANGING})
        if changing:
            sentences.append(f"The shape of '{item.name}' stays as in the first frame: {', '.join(changing)}.")
        keys = getattr(item.data, "shape_keys", None)
        if keys is not None and any(modifier.type != "ARMATURE" for modifier in item.modifiers):
            sentences.append(f"The shape keys of '{item.name}' stay at rest: its modifiers are applied.")
    used = {slot.material for item in scene.objects if not item.hide_render for slot in item.material_slots if slot.material}
    for material in sorted(used, key=lambda one: one.name):
        lost = sorted({node.bl_label for node in lost_nodes(material)})
        if lost:
            sentences.append(f"Material '{material.name}' is without its {', '.join(lost)}: glTF has none.")
    return sentences


def lost_nodes(material: bpy.types.Material) -> list[bpy.types.Node]:
    """The nodes that shape what Cycles shows of a material, and that Blender's exporter does not carry over."""
    if material.node_tree is None or not material.use_nodes:
        return []
    output = material.node_tree.get_output_node("CYCLES")
    reached = [output] if output is not None else []
    for node in reached:
        feeding = [link.from_node for socket in node.inputs for link in socket.links]
        reached.extend(other for other in feeding if other not in reached)
    return [node for node in reached if node.type.startswith(COMPUTED) and node.type not in CARRIED]


@contextmanager
def frame_kept(scene: bpy.types.Scene) -> Iterator[None]:
    """Returns to the current frame in the end."""
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)


@contextmanager
def time_for_exporter(scene: bpy.types.Scene, frames: FrameRange) -> Iterator[None]:
    """Lets the exporter bake as many frames, at a rate without a base, with which exporters deal each in its own way."""
    kept = scene.frame_start, scene.frame_end, scene.render.fps_base
    try:
        scene.frame_start, scene.frame_end, scene.render.fps_base = frames.baked()[0], frames.baked()[-1], 1
        yield
    finally:
        scene.frame_start, scene.frame_end, scene.render.fps_base = kept

# SPDX-License-Identifier: Apache-2.0
"""Writes one scene as files of each kind that Blender writes, and as glTF by Blender's own exporter.

Runs inside Blender (blender -b --factory-startup -P files.py -- FOLDER) or under a Python that has bpy. A box with a texture
stands on a floor, and a camera moves for five frames.

lit.glb, lit.blend, lit.usdc              under a panel: an area light, in lit.glb a mesh that glows
coloured.glb, coloured.obj, coloured.fbx  without a light
bare.glb, bare.abc, bare.ply, bare.stl    without a light and without materials
gloss.glb                                 lit.glb with the gloss of an index of refraction of 1.5, which USD's surfaces have by default
warm.glb                                  gloss.glb under a light of 6500 K, which Blender writes into lit.usdc (white has no such number)
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "blender")]

import scenes  # noqa: E402
from against_cycles import box, camera, matte, panel  # noqa: E402

FRAMES = 5
WATTS, WIDTH_M, HEIGHT_M = 80.0, 1.5, 1.0
# UsdLux.BlackbodyTemperatureAsRgb(6500) of usd-core 26.11.
OF_6500_K = (1.0433334, 0.98362446, 1.0346133)


def checks(folder: Path) -> bpy.types.Image:
    """A picture of squares in two colours."""
    odd = np.indices((32, 32)).sum(axis=0) // 8 % 2
    pixels = np.ones((32, 32, 4), np.float32)
    pixels[..., :3] = np.where(odd[..., None], (0.7, 0.3, 0.1), (0.1, 0.4, 0.6))
    image = bpy.data.images.new("checks", 32, 32)
    image.pixels.foreach_set(pixels.ravel())
    image.file_format, image.filepath_raw = "PNG", str(folder / "checks.png")
    image.save()
    return image


def glowing_mesh(colour: tuple) -> None:
    """What an area light is to a renderer: the same flux from the same surface."""
    bpy.ops.mesh.primitive_plane_add(size=1, location=(0.2, -0.3, 2.5), rotation=(math.pi, 0, 0))
    item = bpy.context.object
    item.scale = (WIDTH_M, HEIGHT_M, 1)
    material = matte("glow", (0, 0, 0))
    material.use_backface_culling = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Emission Color"].default_value = tuple(part / max(colour) for part in colour) + (1,)
    surface.inputs["Emission Strength"].default_value = max(colour) * WATTS / (math.pi * WIDTH_M * HEIGHT_M)
    item.data.materials.append(material)


def build(folder: Path, light: str, has_materials: bool, gloss: float = 0.0, colour: tuple = (1.0, 1.0, 1.0)) -> None:
    """The scene; `light` is area, mesh or none, `gloss` the strength of what a dielectric of 1.5 reflects, 0.5 all of it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 90, 100
    floor = box("floor", (0, 0, -0.1), (6, 6, 0.2), (0.5, 0.5, 0.5))
    block = box("block", (0, 0, 0.5), (1, 1, 1), (0.5, 0.5, 0.5))
    tree = block.data.materials[0].node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = checks(folder)
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    for item in (floor, block):
        item.data.materials[0].node_tree.nodes["Principled BSDF"].inputs["Specular IOR Level"].default_value = gloss
    if not has_materials:
        for item in (floor, block):
            item.data.materials.clear()
    if light == "area":
        panel("panel", (0.2, -0.3, 2.5), WATTS, shape="RECTANGLE", size=WIDTH_M, size_y=HEIGHT_M)
    elif light == "mesh":
        glowing_mesh(colour)
    eye = camera((3, -3, 2), (math.radians(65), 0, math.radians(45)), 35)
    scenes.key(eye, "location", 1, (3, -3, 2))
    scenes.key(eye, "location", FRAMES, (3.4, -2.6, 2))
    scene.frame_set(1)


def main(folder: Path) -> None:
    """Writes all files."""
    folder.mkdir(parents=True, exist_ok=True)
    place = {name: str(folder / name) for name in ("lit", "coloured", "bare")}
    build(folder, "area", True)
    bpy.ops.wm.save_as_mainfile(filepath=place["lit"] + ".blend")
    bpy.ops.wm.usd_export(filepath=place["lit"] + ".usdc", export_animation=True)
    gltf = {"export_cameras": True, "export_apply": True, "export_animation_mode": "SCENE", "export_anim_slide_to_zero": False}
    build(folder, "mesh", True)
    bpy.ops.export_scene.gltf(filepath=place["lit"] + ".glb", **gltf)
    for name, colour in (("gloss", (1, 1, 1)), ("warm", OF_6500_K)):
        build(folder, "mesh", True, 0.5, colour)
        bpy.ops.export_scene.gltf(filepath=str(folder / f"{name}.glb"), **gltf)
    build(folder, "none", True)
    bpy.ops.export_scene.gltf(filepath=place["coloured"] + ".glb", **gltf)
    bpy.ops.wm.obj_export(filepath=place["coloured"] + ".obj")
    bpy.ops.export_scene.fbx(filepath=place["coloured"] + ".fbx")
    build(folder, "none", False)
    bpy.ops.export_scene.gltf(filepath=place["bare"] + ".glb", **gltf)
    bpy.ops.wm.alembic_export(filepath=place["bare"] + ".abc", start=1, end=FRAMES, as_background_job=False)
    bpy.ops.wm.ply_export(filepath=place["bare"] + ".ply")
    bpy.ops.wm.stl_export(filepath=place["bare"] + ".stl")


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    main(Path(given[0]))
    scenes.leave(0)

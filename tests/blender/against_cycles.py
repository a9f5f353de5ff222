# SPDX-License-Identifier: Apache-2.0
"""Renders whole scenes by Cycles and by the add-on, and prints how far the means of their pictures are apart.

Runs inside Blender (blender -b --factory-startup -P against_cycles.py -- FOLDER [SCENE ...]) or under a Python that has
bpy. For each scene it prints one JSON object, and writes `SCENE.png` into the folder: Cycles left, gazetrace right.

cube   the file that Blender begins with, with the add-on as it begins, and pictures through the view
matte  the same cube without a gloss: Blender's is another than glTF's
room   a closed room under a scaled rectangle and a coloured disc
shot   ten frames from 1001 under a sky with its sun: a camera that moves, a lens that is shifted, a region of the
       picture, a panel that moves
"""

import json
import math
import sys
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "blender")]

import gazetrace_blender  # noqa: E402
import scenes  # noqa: E402

SIZE_PX = (160, 90)
SAMPLES = 64
BLOCK_PX = 10
# Enough that nothing is left of the light; the two count them otherwise.
BOUNCES = 24


def matte(name: str, colour: tuple) -> bpy.types.Material:
    """A surface without a gloss."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Roughness"].default_value = 1
    for socket in ("Specular", "Specular IOR Level"):
        if socket in surface.inputs:
            surface.inputs[socket].default_value = 0
    return material


def panel(name: str, place: tuple, watts: float, **settings: object) -> bpy.types.Object:
    """An area light that shines down."""
    light = bpy.data.lights.new(name, "AREA")
    light.energy = watts
    for key, value in settings.items():
        setattr(light, key, value)
    item = bpy.data.objects.new(name, light)
    item.location = place
    bpy.context.scene.collection.objects.link(item)
    return item


def box(name: str, place: tuple, size: tuple, colour: tuple) -> bpy.types.Object:
    """A matte box."""
    bpy.ops.mesh.primitive_cube_add(size=1, location=place)
    item = bpy.context.object
    item.name, item.scale = name, size
    item.data.materials.append(matte(name, colour))
    return item


def camera(place: tuple, turn: tuple, lens_mm: float) -> bpy.types.Object:
    """The scene's camera."""
    lens = bpy.data.cameras.new("lens")
    lens.lens = lens_mm
    item = bpy.data.objects.new("camera", lens)
    item.location, item.rotation_euler = place, turn
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item
    return item


def further(text: str) -> None:
    """Lines that are added to the job."""
    settings = bpy.context.scene.gazetrace
    settings.further_settings = bpy.data.texts.new("further")
    settings.further_settings.write(text)
    settings.samples = SAMPLES


def cube() -> None:
    """What Blender begins with."""
    bpy.ops.wm.read_factory_settings()
    gazetrace_blender.register()
    scene = bpy.context.scene
    scene.frame_end = 1
    scene.gazetrace.display_pictures = True


def matte_cube() -> None:
    """What Blender begins with, without its gloss."""
    cube()
    surface = bpy.data.objects["Cube"].active_material.node_tree.nodes["Principled BSDF"]
    for socket in ("Specular", "Specular IOR Level"):
        if socket in surface.inputs:
            surface.inputs[socket].default_value = 0
    surface.inputs["Roughness"].default_value = 1
    further(f'sampling = "uniform"\nfilter = "none"\ndiffuse = "lambert"\nbounces = {BOUNCES}\naccumulate = "off"\n')


def room() -> None:
    """4 x 3 x 2.5 m, closed, with two area lights and a box."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    gazetrace_blender.register()
    scene = bpy.context.scene
    scene.frame_end = 1
    walls = box("walls", (0, 0, 1.25), (4, 3, 2.5), (0.6, 0.55, 0.5))
    walls.data.flip_normals()
    box("box", (-0.8, 0.5, 0.4), (0.8, 0.8, 0.8), (0.2, 0.4, 0.7))
    # 0.4 x 0.5 m by its size, 0.8 x 0.5 m by its scale.
    panel("rectangle", (0.3, 0.2, 2.45), 60, shape="RECTANGLE", size=0.4, size_y=0.5).scale = (2, 1, 1)
    disc = panel("disc", (1.9, 0.5, 1.2), 20, shape="DISK", size=0.4, color=(1, 0.5, 0.2))
    disc.rotation_euler = (0, math.pi / 2, 0)
    camera((1.7, -1.2, 1.3), (math.radians(80), 0, math.radians(50)), 24)
    further(f'sampling = "uniform"\nfilter = "none"\ndiffuse = "lambert"\nbounces = {BOUNCES}\naccumulate = "off"\n')


def shot() -> None:
    """Ten frames from 1001."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    gazetrace_blender.register()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1001, 1010
    world = scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    tree = world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    if "NISHITA" in sky.bl_rna.properties["sky_type"].enum_items:
        sky.sky_type = "NISHITA"
    sky.sun_elevation, sky.sun_rotation = math.radians(35), math.radians(70)
    background = tree.nodes["Background"]
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    background.inputs["Strength"].default_value = 0.1
    box("ground", (0, 0, -0.05), (30, 30, 0.1), (0.4, 0.4, 0.3))
    box("box", (0.2, 0.6, 0.6), (1.2, 1.2, 1.2), (0.7, 0.2, 0.2))
    lamp = panel("panel", (0, -1, 2.5), 300, shape="SQUARE", size=0.6, color=(0.3, 0.5, 1))
    scenes.key(lamp, "location", 1000, (-1.5, -1, 2.5))
    scenes.key(lamp, "location", 1011, (1.5, -1, 2.5))
    eye = camera((3, -5, 1.8), (math.radians(78), 0, math.radians(30)), 35)
    eye.data.shift_x, eye.data.shift_y = 0.08, -0.1
    scenes.key(eye, "location", 1000, (3, -5, 1.8))
    scenes.key(eye, "location", 1011, (3.6, -4.6, 1.8))
    render = scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.1, 0.85, 0.05, 0.9
    further(f'sampling = "uniform"\nfilter = "none"\ndiffuse = "lambert"\nbounces = {BOUNCES}\naccumulate = "off"\n')


SCENES = {"cube": cube, "matte": matte_cube, "room": room, "shot": shot}


def size_of(scene: bpy.types.Scene) -> None:
    """Small pictures."""
    scene.render.resolution_x, scene.render.resolution_y = SIZE_PX
    scene.render.resolution_percentage = 100


def by_cycles(scene: bpy.types.Scene, folder: Path, seed: int) -> np.ndarray:
    """All frames, as (frame, row, column, channel)."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.seed = SAMPLES, seed
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = BOUNCES
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
    scene.render.image_settings.file_format = "OPEN_EXR"
    pictures = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        scene.render.filepath = str(folder / f"cycles.{frame:04d}.exr")
        bpy.ops.render.render(write_still=True)
        pictures.append(scenes.pixels(scene.render.filepath))
    scene.frame_set(scene.frame_start)
    return np.array(pictures)


def by_gazetrace(scene: bpy.types.Scene, folder: Path, seed: int) -> np.ndarray:
    """The same by the add-on."""
    text = scene.gazetrace.further_settings or bpy.data.texts.new("further")
    scene.gazetrace.further_settings = text
    text.from_string(f"{text.as_string().partition('seed = ')[0]}seed = {seed}\n")
    scene.gazetrace.output_folder = f"//gazetrace-{seed}"
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    if bpy.ops.gazetrace.render() != {"FINISHED"}:
        raise RuntimeError(bpy.context.window_manager.gazetrace_run.told)
    frames = range(scene.frame_start, scene.frame_end + 1)
    return np.array([scenes.pixels(folder / f"gazetrace-{seed}" / f"frame.{frame:04d}.exr") for frame in frames])


def blocks(pictures: np.ndarray) -> np.ndarray:
    """Means over squares of the picture, whose noise is nearly independent."""
    count, height, width, channels = pictures.shape
    cut = pictures[:, : height // BLOCK_PX * BLOCK_PX, : width // BLOCK_PX * BLOCK_PX]
    return cut.reshape(count, height // BLOCK_PX, BLOCK_PX, width // BLOCK_PX, BLOCK_PX, channels).mean(axis=(2, 4))


def compare(cycles: list[np.ndarray], ours: list[np.ndarray]) -> dict:
    """The ratio of the means of each channel, and the standard error of this ratio by two renders of each."""
    means = [np.mean(pair, axis=(0, 1, 2, 3)) for pair in (cycles, ours)]
    errors = []
    for pair, mean in zip((cycles, ours), means):
        difference = blocks(pair[0]) - blocks(pair[1])
        count = difference.size / difference.shape[-1]
        errors.append(np.sqrt((difference**2).mean(axis=(0, 1, 2)) / count) / 2 / mean)
    by_frame = [np.mean(pair, axis=(0, 2, 3, 4)) for pair in (cycles, ours)]
    return {
        "mean": [round(float(part), 5) for part in means[0]],
        "ratio": [round(float(part), 5) for part in means[1] / means[0]],
        "error_of_ratio": [round(float(part), 5) for part in np.hypot(*errors)],
        "frames": len(cycles[0]),
        "worst_frame_ratio": round(float(max(by_frame[1] / by_frame[0], key=lambda ratio: abs(ratio - 1))), 5),
    }


def write_sheet(cycles: np.ndarray, ours: np.ndarray, path: Path) -> None:
    """The first frame of both beside each other, at the same exposure."""
    both = np.concatenate([cycles[0], ours[0]], axis=1)
    light = np.clip(both * (0.3 / np.median(both[both > 0])), 0, 1)
    code = np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    height, width, _ = code.shape
    image = bpy.data.images.new("sheet", width, height)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.concatenate([code, np.ones((height, width, 1))], axis=2)[::-1].astype(np.float32).ravel())
    image.file_format, image.filepath_raw = "PNG", str(path)
    image.save()


def main(folder: Path, names: list[str]) -> None:
    """Prints one JSON object a scene."""
    for name in names or SCENES:
        SCENES[name]()
        scene = bpy.context.scene
        size_of(scene)
        here = folder / name
        here.mkdir(parents=True)
        cycles = [by_cycles(scene, here, seed) for seed in (1, 2)]
        ours = [by_gazetrace(scene, here, seed) for seed in (1, 2)]
        result = {"scene": name, "blender": bpy.app.version_string, **compare(cycles, ours)}
        write_sheet(cycles[0], ours[0], folder / f"{name}.png")
        print("RESULT " + json.dumps(result), flush=True)
        gazetrace_blender.unregister()


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    main(Path(given[0]), given[1:])
    scenes.leave(0)

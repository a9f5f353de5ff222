# SPDX-License-Identifier: Apache-2.0
"""Renders each view by Cycles and by gazetrace, and prints by how many pixels the places of the balls differ.

Runs inside Blender (blender -b --factory-startup -P framing.py -- FOLDER [NUMBER ...]) or under a Python that has bpy.
Numbers choose among the views.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "blender")]

import gazetrace_blender  # noqa: E402
import scenes  # noqa: E402

SAMPLES = 64


def render_by_cycles(scene: bpy.types.Scene, folder: Path) -> dict[int, np.ndarray]:
    """The places of the balls in each frame."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    scene.render.image_settings.file_format = "OPEN_EXR"
    places = {}
    for frame in range(scenes.FIRST, scenes.LAST + 1):
        scene.frame_set(frame)
        path = folder / f"cycles.{frame:04d}.exr"
        scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        places[frame] = scenes.centroids(scenes.pixels(path))
    return places


def render_by_gazetrace(scene: bpy.types.Scene, folder: Path) -> dict[int, np.ndarray]:
    """The same by the add-on."""
    scene.gazetrace.gaze_source = "NONE"
    scene.gazetrace.sampling = "uniform"
    scene.gazetrace.filter = "none"
    scene.gazetrace.samples = SAMPLES
    further = bpy.data.texts.new("further")
    further.write('bounces = 0\naccumulate = "off"\n')
    scene.gazetrace.further_settings = further
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))
    if bpy.ops.gazetrace.render() != {"FINISHED"}:
        raise RuntimeError(bpy.context.window_manager.gazetrace_run.told)
    pictures = {frame: folder / "gazetrace" / f"frame.{frame:04d}.exr" for frame in range(scenes.FIRST, scenes.LAST + 1)}
    return {frame: scenes.centroids(scenes.pixels(path)) for frame, path in pictures.items()}


def computed(scene: bpy.types.Scene, folder: Path) -> dict[int, np.ndarray]:
    """Where Blender itself says that the centres of the balls are, without rendering."""
    render = scene.render
    size = np.array([render.resolution_x, render.resolution_y]) * render.resolution_percentage // 100
    places = {}
    for frame in range(scenes.FIRST, scenes.LAST + 1):
        scene.frame_set(frame)
        centres = [bpy.data.objects[name].matrix_world.translation for name in scenes.COLOURS]
        views = [world_to_camera_view(scene, scene.camera, centre) for centre in centres]
        places[frame] = np.array([[view.x * size[0], (1 - view.y) * size[1]] for view in views])
    return places


def worst(a: dict[int, np.ndarray], b: dict[int, np.ndarray]) -> float:
    """The largest distance in pixels between two places of the same ball in the same frame."""
    return float(np.max([np.linalg.norm(a[frame] - b[frame], axis=1) for frame in a]))


def main(folder: Path, numbers: list[int]) -> None:
    """Prints one JSON object a view."""
    for number in numbers or range(len(scenes.VIEWS)):
        view = scenes.VIEWS[number]
        scene = scenes.build(view)
        gazetrace_blender.register()
        here = folder / str(number)
        here.mkdir(parents=True)
        by_blender = computed(scene, here)
        by_cycles = render_by_cycles(scene, here)
        by_gazetrace = render_by_gazetrace(scene, here)
        moved = max(float(np.linalg.norm(by_cycles[f] - by_cycles[scenes.FIRST], axis=1).max()) for f in by_cycles)
        result = {
            "view": view.name,
            "blender": bpy.app.version_string,
            "balls": 3 * len(by_cycles),
            "moved_px": round(moved, 2),
            "cycles_and_gazetrace_px": round(worst(by_cycles, by_gazetrace), 4),
            "computed_and_gazetrace_px": round(worst(by_blender, by_gazetrace), 4),
        }
        print("RESULT " + json.dumps(result), flush=True)
        gazetrace_blender.unregister()


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    main(Path(given[0]), [int(number) for number in given[1:]])
    scenes.leave(0)

# SPDX-License-Identifier: Apache-2.0
"""A job of gazetrace from a scene of Blender: the exported scene and the settings file beside the .blend file."""

from dataclasses import dataclass
from pathlib import Path

import bpy

from .camera import Projection, crop_options, lens_options, picture_size, projection, scene_camera
from .export import export_scene, frame_kept, left_out
from .frames import FrameRange, frame_options, frame_range
from .refusal import Refusal
from .toml import Value, toml_text
from .view import view_options
from .viewer import gaze_options, relative, screen_options
from .world import world_options


@dataclass(frozen=True)
class Job:
    """What was written, and what it says of frames and pictures."""

    settings_file: Path
    pictures: str  # the linear pictures as a pattern, from the folder of the job
    frames: FrameRange
    left_out: list[str]

    @property
    def folder(self) -> Path:
        """Where the program is started: paths in the job begin here."""
        return self.settings_file.parent

    def picture(self, frame: int) -> Path:
        """The linear picture of a frame."""
        return self.folder / self.pictures.replace("####", f"{frame:04d}")


def write_job(context: bpy.types.Context) -> Job:
    """Exports the scene and writes `NAME.gazetrace.toml` beside `NAME.blend`."""
    scene = context.scene
    if not bpy.data.filepath:
        raise Refusal("the .blend file was never saved", "save it: the job is written beside it")
    blend = Path(bpy.data.filepath)
    side_folder = blend.with_suffix(".gazetrace")
    frames = frame_range(scene)
    width_px, height_px = picture_size(scene)
    # Refusals come before the export, which can take long.
    camera, lens, shown = camera_over_time(scene, frames, width_px, height_px)
    side_folder.mkdir(exist_ok=True)
    scene_file = side_folder / "scene.glb"
    options = settings_of_job(scene, frames, blend.parent, side_folder)
    camera_name = export_scene(scene, frames, camera, shown, scene_file)
    first: dict[str, Value] = {
        "scene": scene_file.relative_to(blend.parent).as_posix(),
        "camera": camera_name,
        "size": f"{width_px}x{height_px}",
        **crop_options(scene, width_px, height_px),
    }
    settings_file = blend.with_suffix(".gazetrace.toml")
    text = f"# Written by gazetrace's add-on for Blender from {blend.name}; it is written anew for every render.\n"
    text += toml_text({**first, **lens, **options})
    further = scene.gazetrace.further_settings
    settings_file.write_text(text + (further.as_string() + "\n" if further else ""), encoding="utf-8")
    return Job(settings_file, options["output"][0], frames, left_out(scene))


def camera_over_time(
    scene: bpy.types.Scene, frames: FrameRange, width_px: int, height_px: int
) -> tuple[bpy.types.Object, dict[str, Value], Projection]:
    """The camera, its lens and its projection, which must be the same in every frame."""
    seen = []
    with frame_kept(scene):
        for frame in frames.rendered():
            scene.frame_set(frame)  # Markers may switch cameras.
            camera = scene_camera(scene)
            evaluated = camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
            lens = lens_options(scene, evaluated)
            seen.append((camera, lens, projection(evaluated.data, width_px, height_px)))
            if camera != seen[0][0]:
                raise Refusal(
                    f"a marker switches to camera '{camera.name}' in frame {frame}",
                    "render the frames of each camera by themselves",
                )
            if seen[-1] != seen[0]:
                raise Refusal(
                    f"the lens of camera '{camera.name}' is another in frame {frame} than in frame {frames.first}",
                    "render such frames by themselves: a job of gazetrace has one focal length, clipping and focus",
                )
    return seen[0]


def settings_of_job(
    scene: bpy.types.Scene, frames: FrameRange, job_folder: Path, side_folder: Path
) -> dict[str, Value]:
    """Everything but scene and camera. What is not set here is the program's to decide."""
    chosen = scene.gazetrace
    options: dict[str, Value] = {}
    options.update(frame_options(frames, chosen.gaze_delay, chosen.gaze_source == "LOG"))
    options.update(world_options(scene, job_folder, side_folder))
    options.update(gaze_options(chosen, job_folder))
    options.update(screen_options(chosen, job_folder))
    for name in ("preset", "sampling", "density", "filter"):
        if getattr(chosen, name):
            options[name] = getattr(chosen, name)
    if chosen.samples:
        options["spp"] = chosen.samples
    if scene.render.threads_mode == "FIXED":
        options["threads"] = scene.render.threads
    if chosen.view_source == "SCENE":
        options.update(view_options(scene))
    folder = relative(chosen.output_folder, job_folder)
    endings = ["exr", "png"] if chosen.display_pictures else ["exr"]
    options["output"] = [f"{folder}/frame.####.{ending}" for ending in endings]
    options["overwrite" if scene.render.use_overwrite else "resume"] = True
    return options

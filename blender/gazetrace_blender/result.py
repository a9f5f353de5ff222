# SPDX-License-Identifier: Apache-2.0
"""Shows what was rendered in the image editor, as an image sequence in linear light under the scene's view."""

import bpy

from .job import Job


def show(context: bpy.types.Context, job: Job) -> bpy.types.Image | None:
    """Loads the pictures of a job as a sequence, and lets every image editor show it. None where there is no picture."""
    frames = job.frames.rendered()
    first = next((frame for frame in frames if job.picture(frame).is_file()), None)
    if first is None:
        return None
    path = str(job.picture(first))
    image = next((known for known in bpy.data.images if bpy.path.abspath(known.filepath) == path), None)
    if image is None:
        image = bpy.data.images.load(path)
        image.name = "gazetrace"
    image.source = "SEQUENCE"
    image.reload()
    for window in context.window_manager.windows if context.window_manager else ():
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                show_in(area.spaces.active, image, first, frames[-1])
    return image


def show_in(editor: bpy.types.SpaceImageEditor, image: bpy.types.Image, first: int, last: int) -> None:
    """Each frame of the timeline shows the picture of the same number."""
    editor.image = image
    user = editor.image_user
    user.frame_start = first
    user.frame_offset = first - 1
    user.frame_duration = last - first + 1
    user.use_auto_refresh = True

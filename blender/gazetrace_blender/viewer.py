# SPDX-License-Identifier: Apache-2.0
"""The viewer: gaze and screen as options of a job."""

import os
from pathlib import Path

import bpy

from .refusal import Refusal
from .toml import Value

CM_PER_M = 100.0


def gaze_options(settings: bpy.types.PropertyGroup, job_folder: Path) -> dict[str, Value]:
    """The log, or a fixed place, or nothing."""
    if settings.gaze_source == "POINT":
        return {"gaze-at": [round(part, 6) for part in settings.gaze_at]}
    if settings.gaze_source == "LOG":
        if not settings.gaze_log:
            raise Refusal("no gaze log is given", "choose its file, or another kind of gaze")
        options: dict[str, Value] = {"gaze": relative(settings.gaze_log, job_folder)}
        if settings.gaze_transfer != "NONE":
            options["gaze-transfer"] = settings.gaze_transfer
        return options
    return {}


def screen_options(settings: bpy.types.PropertyGroup, job_folder: Path) -> dict[str, Value]:
    """The screen that the pictures are for; nothing where the log states it."""
    if settings.screen_source == "NAMED":
        is_file = settings.screen_name.lower().endswith(".json")
        return {"screen": relative(settings.screen_name, job_folder) if is_file else settings.screen_name}
    if settings.screen_source == "SIZE":
        return {
            "screen-px": list(settings.screen_px),
            "screen-cm": [round(side * CM_PER_M, 4) for side in (settings.screen_width, settings.screen_height)],
            "screen-distance-cm": round(settings.screen_distance * CM_PER_M, 4),
        }
    return {}


def relative(path: str, job_folder: Path) -> str:
    """A path of Blender's, from the folder of the job."""
    return os.path.relpath(bpy.path.abspath(path), job_folder)

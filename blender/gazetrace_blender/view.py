# SPDX-License-Identifier: Apache-2.0
"""Exposure and view of the scene. gazetrace reads Blender's own OpenColorIO configuration, so that all views are there."""

import os
from pathlib import Path

import bpy

from .refusal import Refusal
from .toml import Value

# What Blender's configurations call linear light with the primaries of Rec.709, in newer and in older versions.
LINEAR_NAMES = ("Linear Rec.709", "Linear")


def view_options(scene: bpy.types.Scene) -> dict[str, Value]:
    """The exposure, and the display, view and look of Blender's configuration."""
    view = scene.view_settings
    if view.gamma != 1 or view.use_curve_mapping:
        raise Refusal("the view has a gamma or curves", "set its gamma to 1 and switch its curves off")
    options: dict[str, Value] = {
        "exposure": round(view.exposure, 6),
        "ocio": str(colour_configuration()),
        "ocio-input": linear_name(),
        "display": scene.display_settings.display_device,
        "view": view.view_transform,
    }
    if view.look != "None":
        options["look"] = view.look
    return options


def colour_configuration() -> Path:
    """The file of the configuration that this Blender uses."""
    from_environment = os.environ.get("OCIO")
    if from_environment:
        return Path(from_environment)
    folders = [bpy.utils.system_resource("DATAFILES"), bpy.utils.resource_path("LOCAL") + "/datafiles"]
    for folder in folders:
        path = Path(folder, "colormanagement", "config.ocio")
        if path.is_file():
            return path
    raise Refusal("Blender's OpenColorIO configuration was not found", "choose the program's own view in the panel")


def linear_name() -> str:
    """The configuration's name of linear Rec.709."""
    known = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()
    return next((name for name in LINEAR_NAMES if name in known), LINEAR_NAMES[0])

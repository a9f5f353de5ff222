# SPDX-License-Identifier: Apache-2.0
"""Renders the scene with gazetrace, sampled where a recorded viewer looked.

The add-on describes the scene to the program and shows what comes of it; everything that the program can decide is left
to the program. `job.py` is the way from a scene to a job, `run.py` that from a job to pictures, and the operators in
`operators.py` walk both.
"""

import bpy

from . import operators, panels, properties

bl_info = {
    "name": "gazetrace",
    "description": "Foveated path tracing where a recorded viewer looked",
    "author": "The gazetrace authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > gazetrace",
    "category": "Render",
}

CLASSES = (*properties.CLASSES, *operators.CLASSES, *panels.CLASSES)


def register() -> None:
    """Makes the settings, operators and panels known to Blender."""
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    properties.attach()


def unregister() -> None:
    """Takes everything back that `register` made known."""
    properties.detach()
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)

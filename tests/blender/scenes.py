# SPDX-License-Identifier: Apache-2.0
"""Scenes whose framing can be measured: three glowing balls before black, one for each primary colour."""

import os
import sys
from dataclasses import dataclass

import bpy
import numpy as np

COLOURS = {"red": (1, 0, 0, 1), "green": (0, 1, 0, 1), "blue": (0, 0, 1, 1)}
FIRST, LAST = 11, 15


@dataclass(frozen=True)
class View:
    """A camera and the shape of its pictures."""

    name: str
    size: tuple[int, int] = (320, 180)
    percentage: int = 100
    lens_mm: float = 35
    sensor_mm: tuple[float, float] = (36, 24)
    fit: str = "AUTO"
    kind: str = "PERSP"
    shift: tuple[float, float] = (0, 0)


VIEWS = [
    View("as Blender begins"),
    View("upright", size=(180, 320), lens_mm=28),
    View("vertical fit, half size", size=(501, 301), percentage=50, lens_mm=24, sensor_mm=(36, 20), fit="VERTICAL"),
    View("horizontal fit, upright", size=(200, 260), lens_mm=30, sensor_mm=(32, 18), fit="HORIZONTAL"),
    View("long lens, vertical fit", size=(400, 300), lens_mm=42, fit="VERTICAL"),
    View("parallel rays, vertical fit", size=(320, 180), fit="VERTICAL", kind="ORTHO"),
    View("parallel rays, upright", size=(180, 240), kind="ORTHO"),
    View("shifted lens, upright", size=(180, 240), shift=(0.06, -0.1)),
    View("parallel rays, shifted", kind="ORTHO", shift=(-0.1, 0.05)),
]


def ball(name: str, colour: tuple, place: tuple) -> bpy.types.Object:
    """A small ball that shines in one colour."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.08, segments=32, ring_count=16)
    item = bpy.context.object
    item.name = name
    item.location = place
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = colour
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    item.data.materials.append(material)
    return item


def empty(name: str, place: tuple) -> bpy.types.Object:
    """A thing without a shape."""
    item = bpy.data.objects.new(name, None)
    item.location = place
    bpy.context.scene.collection.objects.link(item)
    return item


def key(item: bpy.types.ID, path: str, frame: float, value: object) -> None:
    """A keyframe."""
    setattr(item, path, value)
    item.keyframe_insert(path, frame=frame)


def build(view: View) -> bpy.types.Scene:
    """An empty file with a camera that follows a path and looks at a target that moves.

    The red ball rests. The green one hangs on a thing that turns, by an unequal scale, and is moved by a constraint. The
    blue one has no keys at all: a driver moves it.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FIRST, LAST
    scene.render.fps, scene.render.fps_base = 24, 1.001
    scene.render.resolution_x, scene.render.resolution_y = view.size
    scene.render.resolution_percentage = view.percentage

    ball("red", COLOURS["red"], (-0.5, 0.2, 0.35))
    turntable = empty("turntable", (0.2, 0.1, 0))
    key(turntable, "rotation_euler", 1, (0, 0.1, 0))
    key(turntable, "rotation_euler", 40, (0.4, 0.1, 3))
    turntable.scale = (1.5, 1.5, 0.7)
    green = ball("green", COLOURS["green"], (0.4, 0.1, -0.4))
    green.parent = turntable
    limit = green.constraints.new("LIMIT_LOCATION")
    limit.use_min_z, limit.min_z = True, -0.2
    blue = ball("blue", COLOURS["blue"], (0.2, 0.3, 0.1))
    driver = blue.driver_add("location", 2).driver
    driver.expression = "0.3 + 0.02 * frame - 0.2"

    target = empty("target", (0, 0, 0))
    key(target, "location", 1, (-0.2, 0, 0))
    key(target, "location", 30, (0.2, 0.1, 0.1))
    bpy.ops.curve.primitive_bezier_circle_add(radius=4, location=(0, 0, 1.2), rotation=(0.1, 0.2, 0))
    path = bpy.context.object
    path.data.use_path = True
    path.data.path_duration = 100
    key(path.data, "eval_time", 1, 0.0)
    key(path.data, "eval_time", 60, 60.0)

    lens = bpy.data.cameras.new("lens")
    lens.type = view.kind
    lens.lens, lens.ortho_scale, lens.sensor_fit = view.lens_mm, 3.5, view.fit
    lens.sensor_width, lens.sensor_height = view.sensor_mm
    lens.shift_x, lens.shift_y = view.shift
    camera = bpy.data.objects.new("camera", lens)
    scene.collection.objects.link(camera)
    scene.camera = camera
    follow = camera.constraints.new("FOLLOW_PATH")
    follow.target = path
    track = camera.constraints.new("TRACK_TO")
    track.target, track.track_axis, track.up_axis = target, "TRACK_NEGATIVE_Z", "UP_Y"
    return scene


def pixels(path: str) -> np.ndarray:
    """The colours of a picture, top row first."""
    image = bpy.data.images.load(str(path), check_existing=False)
    width, height = image.size
    values = np.array(image.pixels[:], np.float64).reshape(height, width, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return values


def centroids(values: np.ndarray) -> np.ndarray:
    """Where the light of each primary has its centre, in pixels from the top left; a row (x, y) for each of the three."""
    height, width, _ = values.shape
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return np.array([[(c * x).sum() / c.sum(), (c * y).sum() / c.sum()] for c in np.moveaxis(values, 2, 0)])


def leave(code: int) -> None:
    """Ends the process at once: bpy as a module can crash while Python takes itself down, after all is done."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)

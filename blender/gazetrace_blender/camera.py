# SPDX-License-Identifier: Apache-2.0
"""The camera's projection, lens and shutter. Its way through the scene is exported with the scene."""

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from .refusal import Refusal
from .toml import Value


@dataclass(frozen=True)
class Projection:
    """What a glTF camera says of its view."""

    is_perspective: bool
    yfov_rad: float
    ymag_m: float
    middle_m: tuple[float, float]  # of the picture, from the view axis; one metre before a perspective camera
    aspect: float
    near_m: float
    far_m: float

    def gltf(self) -> dict:
        """The camera as an object of glTF 2.0. A shifted lens, which glTF has not, stands in its extras."""
        if self.is_perspective:
            kind, lens = "perspective", {"yfov": self.yfov_rad, "aspectRatio": self.aspect}
        else:
            kind, lens = "orthographic", {"xmag": self.ymag_m * self.aspect, "ymag": self.ymag_m}
        camera = {"type": kind, kind: {**lens, "znear": self.near_m, "zfar": self.far_m}}
        if any(self.middle_m):
            camera["extras"] = {"gazetrace": {"middle_m": self.middle_m}}
        return camera


def picture_size(scene: bpy.types.Scene) -> tuple[int, int]:
    """Width and height of the pictures in pixels, rounded down as Blender does."""
    render = scene.render
    if render.pixel_aspect_x != render.pixel_aspect_y:
        raise Refusal(
            f"the pixel aspect is {render.pixel_aspect_x:g} to {render.pixel_aspect_y:g}, and gazetrace's pixels are square",
            "set both to 1",
        )
    return (
        render.resolution_x * render.resolution_percentage // 100,
        render.resolution_y * render.resolution_percentage // 100,
    )


def crop_options(scene: bpy.types.Scene, width_px: int, height_px: int) -> dict[str, Value]:
    """The render region, from the top left, rounded down as Blender does in single precision."""
    render = scene.render
    if not render.use_border:
        return {}
    left, right = (int(np.float32(part) * np.float32(width_px)) for part in (render.border_min_x, render.border_max_x))
    low, high = (int(np.float32(part) * np.float32(height_px)) for part in (render.border_min_y, render.border_max_y))
    if right <= left or high <= low:
        raise Refusal("the render region is smaller than a pixel", "draw it larger, or switch Render Region off")
    return {"crop": [left, height_px - high, right - left, high - low]}


def projection(camera: bpy.types.Camera, width_px: int, height_px: int) -> Projection:
    """The projection of a camera in a picture of this size, by the rules of Blender's sensor fit.

    The sensor fits the width, the height, or the longer of both (Auto, which measures it by the sensor's width). Shifts
    of the lens are parts of what it fits, for both axes.
    """
    fits_width = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and width_px >= height_px)
    sensor_mm = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    fitted_px = width_px if fits_width else height_px
    height_per_fitted = height_px / fitted_px
    is_perspective = camera.type == "PERSP"
    fitted_m = sensor_mm / camera.lens if is_perspective else camera.ortho_scale
    return Projection(
        is_perspective=is_perspective,
        yfov_rad=2 * math.atan(sensor_mm / (2 * camera.lens) * height_per_fitted),
        ymag_m=camera.ortho_scale / 2 * height_per_fitted,
        middle_m=(camera.shift_x * fitted_m, camera.shift_y * fitted_m),
        aspect=width_px / height_px,
        near_m=camera.clip_start,
        far_m=camera.clip_end,
    )


def scene_camera(scene: bpy.types.Scene) -> bpy.types.Object:
    """The camera of the scene at its current frame. Refuses what is not one picture of one pinhole or lens."""
    camera = scene.camera
    if camera is None or camera.type != "CAMERA":
        raise Refusal("the scene has no camera", "add one and make it the scene's camera")
    if camera.data.type not in ("PERSP", "ORTHO"):
        raise Refusal(f"camera '{camera.name}' is panoramic", "choose a perspective or an orthographic lens")
    if scene.render.use_multiview:
        raise Refusal("the scene is stereoscopic", "switch Stereoscopy off and render an eye at a time")
    return camera


def lens_options(scene: bpy.types.Scene, camera: bpy.types.Object) -> dict[str, Value]:
    """Depth of field and motion blur, where the scene has them. The lens is evaluated at the scene's current frame."""
    options: dict[str, Value] = {}
    depth_of_field = camera.data.dof
    if depth_of_field.use_dof:
        if depth_of_field.aperture_ratio != 1 or depth_of_field.aperture_blades > 2:
            raise Refusal("the lens has blades or is squeezed", "gazetrace's is round: set blades to 0 and ratio to 1")
        options["aperture"] = camera.data.lens * 1e-3 / (2 * depth_of_field.aperture_fstop)
        options["focus-distance"] = focus_distance_m(camera)
    if scene.render.use_motion_blur:
        options["shutter"] = shutter(scene)
    return options


def focus_distance_m(camera: bpy.types.Object) -> float:
    """How far along the view the picture is sharp."""
    target = camera.data.dof.focus_object
    if target is None:
        return camera.data.dof.focus_distance
    forward = camera.matrix_world.to_quaternion() @ Vector((0, 0, -1))
    return abs((target.matrix_world.translation - camera.matrix_world.translation).dot(forward))


def shutter(scene: bpy.types.Scene) -> str:
    """When the shutter opens and closes in parts of a frame, whose middle is the moment that Blender calls the frame."""
    length = scene.render.motion_blur_shutter
    position = getattr(scene.render, "motion_blur_position", None) or scene.cycles.motion_blur_position
    opens = {"START": 0.5, "CENTER": 0.5 - length / 2, "END": 0.5 - length}[position]
    return f"{opens:.9g},{opens + length:.9g}"

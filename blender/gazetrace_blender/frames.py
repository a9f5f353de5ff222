# SPDX-License-Identifier: Apache-2.0
"""Which frames are rendered, and how Blender's time becomes video time.

Frame numbers stay those of Blender, and so do the names of files. Blender's frame f is the moment f / fps; gazetrace shows
frame n at the middle of its interval, start + (n - 1/2) / fps. Both are the same moment where start is half a frame.
"""

from dataclasses import dataclass
from fractions import Fraction

import bpy

from .refusal import Refusal
from .toml import Value


@dataclass(frozen=True)
class FrameRange:
    """The frames of the scene, the first and the last included, and their rate in frames a second."""

    first: int
    last: int
    step: int
    fps: Fraction

    def baked(self) -> list[int]:
        """The frames that become keys: all, those that are stepped over included, and one more on either side.

        Things move between frames and while the shutter is open, and key times are rounded to floats.
        """
        return list(range(self.first - 1, self.last + 2))

    def rendered(self) -> list[int]:
        """The frames that become pictures."""
        return list(range(self.first, self.last + 1, self.step))

    @property
    def shown(self) -> int:
        """Which of the baked frames the exported file shows at rest: the first one that is rendered."""
        return self.baked().index(self.first)

    def seconds(self, frame: int) -> float:
        """The moment of a frame in the exported scene."""
        return float(frame / self.fps)


def frame_range(scene: bpy.types.Scene) -> FrameRange:
    """The frames of the scene. Refuses frames before 1, from which gazetrace counts."""
    if scene.frame_start < 1:
        raise Refusal(
            f"the first frame is {scene.frame_start}, and gazetrace counts frames from 1",
            "let the frame range begin at 1 or later",
        )
    if scene.frame_end < scene.frame_start:
        raise Refusal("the last frame comes before the first", "change the frame range")
    # The base is a rounded float: 1.001 stands for 1001/1000.
    base = Fraction(str(round(scene.render.fps_base, 6)))
    return FrameRange(scene.frame_start, scene.frame_end, scene.frame_step, scene.render.fps / base)


def nanoseconds(seconds: Fraction) -> str:
    """A duration as gazetrace reads it, to the nanosecond."""
    return f"{round(seconds * 10**9)}ns"


def frame_options(frames: FrameRange, gaze_delay_s: float, has_gaze_log: bool) -> dict[str, Value]:
    """The rate, the frames and the clock. The gaze log begins when the first frame begins to be shown, or later."""
    half = Fraction(1, 2) / frames.fps
    step = f"x{frames.step}" if frames.step != 1 else ""
    options: dict[str, Value] = {
        "fps": str(frames.fps),
        "frames": f"{frames.first}-{frames.last}{step}",
        "start": nanoseconds(half),
    }
    if has_gaze_log:
        shown_from = frames.first / frames.fps - half
        options["gaze-offset"] = nanoseconds(shown_from + Fraction(gaze_delay_s).limit_denominator(10**6))
    return options

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A sequence rendered where a recorded eye looked, on one sheet with the gaze marked, to be looked at.

  replay_sheet.py GAZETRACE OUT.png SCENE [options of `gazetrace render` ...]

A cross marks the gaze that steered the sampling, circles the borders of the fovea (5.2 degrees across) and of the
intermediate region (17). A gaze beside the frame is marked in yellow at its edge. The recorded eye looked at
something else: replay, not viewing. Needs Pillow.

A head-mounted recording (gaze and head from one log) and a desktop one (walk.csv is a path down the nave):

  replay_sheet.py GAZETRACE vive.png Sponza.gltf --env kiara_1_dawn_1k.hdr --exposure auto-1.5 --filter guided \\
    --gaze TESTNA01_360VR_Fist3.csv \\
    --camera-from-gaze --camera-start 8,1.7,-0.3 --camera-turn 40 --yfov 80 --size 640x360 --fps 2 --frames 1-24
  replay_sheet.py GAZETRACE studio.png Sponza.gltf --env kiara_1_dawn_1k.hdr --exposure auto-1.5 --filter guided --gaze data.tsv \\
    --camera-path walk.csv --size 640x360 --fps 2 --frames 1-24
"""

import argparse
import json
import math
import pathlib
import subprocess
import tempfile

from PIL import Image, ImageDraw

LABEL = 14
HALF_ANGLES_DEG = (2.6, 8.5)


def rotation_to(direction):
    """Two unit vectors across a direction."""
    x, y, z = direction
    across = (-z, 0.0, x) if abs(y) < 0.9 else (0.0, z, -y)
    length = math.sqrt(sum(a * a for a in across))
    a = [v / length for v in across]
    b = [y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0]]
    return a, b


class View:
    """From directions of the eye to pixels of the frame: through the camera, or through the screen."""

    def __init__(self, frame, size):
        self.size = size
        gaze = frame["gaze_render"]
        self.screen = "u" in gaze and gaze["u"] is not None
        self.gaze = gaze
        self.tan_half = math.tan(math.radians(frame["camera"]["yfov_deg"]) / 2)

    def center(self):
        if self.screen:
            return self.gaze["u"] * self.size[0], self.gaze["v"] * self.size[1]
        return self.pixel(self.gaze["direction"])

    def pixel(self, direction):
        if direction[2] >= -1e-6:
            return None
        scale = self.size[1] / 2 / self.tan_half
        return (self.size[0] / 2 + direction[0] / -direction[2] * scale,
                self.size[1] / 2 - direction[1] / -direction[2] * scale)

    def circle(self, half_angle_deg):
        direction = self.gaze["direction"]
        a, b = rotation_to(direction)
        t = math.tan(math.radians(half_angle_deg))
        points = []
        for k in range(49):
            c, s = math.cos(k * math.pi / 24) * t, math.sin(k * math.pi / 24) * t
            points.append([direction[i] + c * a[i] + s * b[i] for i in range(3)])
        if not self.screen:
            return [self.pixel(p) for p in points]
        # On the screen: the slope of a direction is a place, and the gaze's own place is known.
        u, v = self.center()
        scale = self.pixels_per_slope
        x0, y0 = direction[0] / -direction[2], direction[1] / -direction[2]
        return [(u + (p[0] / -p[2] - x0) * scale[0], v - (p[1] / -p[2] - y0) * scale[1]) for p in points]

    pixels_per_slope = (0, 0)


def slopes(frames, size):
    """Pixels per slope on the screen, from two gazes of the plan that lie apart."""
    seen = [f["gaze_render"] for f in frames if f["gaze_render"].get("u") is not None]
    scale = [0.0, 0.0]
    for axis, key in ((0, "u"), (1, "v")):
        least = min(seen, key=lambda g: g[key], default=None)
        most = max(seen, key=lambda g: g[key], default=None)
        if least is None or most[key] == least[key]:
            continue
        slope = [g["direction"][axis] / -g["direction"][2] for g in (least, most)]
        scale[axis] = abs((most[key] - least[key]) * size[axis] / (slope[1] - slope[0]))
    return scale[0] or scale[1], scale[1] or scale[0]


def mark(picture, view):
    draw = ImageDraw.Draw(picture)
    at = view.center()
    if at is None:
        draw.text((4, 4), "gaze behind the view", fill="red")
        return
    width, height = picture.size
    x, y = min(max(at[0], 3), width - 4), min(max(at[1], 3), height - 4)
    color = "red" if (x, y) == at else "yellow"
    draw.line((x - 9, y, x + 9, y), fill=color, width=2)
    draw.line((x, y - 9, x, y + 9), fill=color, width=2)
    for half_angle, shade in zip(HALF_ANGLES_DEG, ("red", "orange")):
        points = view.circle(half_angle)
        if all(points):
            draw.line(points, fill=shade, width=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("output")
    parser.add_argument("scene")
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--shrink", type=int, default=2, help="pictures on the sheet are smaller by this factor")
    parser.add_argument("--title", default="")
    arguments, extra = parser.parse_known_args()
    plan = json.loads(subprocess.run([arguments.program, "plan", arguments.scene, *extra, "--json"], check=True,
                                     stdout=subprocess.PIPE, text=True).stdout)
    frames = plan["frames"]
    size = frames[0]["size_px"]
    View.pixels_per_slope = slopes(frames, size)
    small = [size[0] // arguments.shrink, size[1] // arguments.shrink]
    rows = (len(frames) + arguments.columns - 1) // arguments.columns
    sheet = Image.new("RGB", (arguments.columns * small[0], rows * (small[1] + LABEL) + LABEL), "white")
    draw = ImageDraw.Draw(sheet)
    draw.text((4, 1), f"{arguments.title} Replay, not viewing: the recorded eye looked at something else.".strip(), fill="black")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([arguments.program, "render", arguments.scene, "-o", folder / "f.####.png", "--quiet", *extra],
                       check=True)
        for i, frame in enumerate(frames):
            picture = Image.open(folder / f"f.{frame['frame']:04d}.png").convert("RGB")
            gaze = frame["gaze_render"]
            if gaze["direction"]:
                mark(picture, View(frame, size))
            x, y = i % arguments.columns * small[0], i // arguments.columns * (small[1] + LABEL) + LABEL
            sheet.paste(picture.resize(small, Image.LANCZOS), (x, y + LABEL))
            draw.text((x + 4, y + 1), f"{frame['frame']}: {frame['t_video_ns'] * 1e-9:.3f} s, {gaze['reason'][:44]}", fill="black")
    sheet.save(arguments.output)


if __name__ == "__main__":
    main()

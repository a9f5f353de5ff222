# SPDX-License-Identifier: Apache-2.0
"""For fixed_quality.py: which pixels of a frame are traced at high rates and what each counts, and judges beside JOD."""

import math

import numpy
import OpenEXR


def read_exr(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return numpy.stack([file.channels()[c].pixels for c in "RGB"], -1).astype(numpy.float32)


def write_exr(path, channels):
    planes = {name: numpy.ascontiguousarray(plane, dtype=numpy.float32) for name, plane in channels.items()}
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, planes) as file:
        file.write(str(path))


def write_picture(path, rgb):
    write_exr(path, {c: rgb[..., i] for i, c in enumerate("RGB")})


class Windows:
    """Which pixels are traced at high rates, and how much each counts at each gaze."""

    def __init__(self, asked, width, height, gazes):
        self.shape = (height, width)
        self.is_traced = numpy.zeros(self.shape, dtype=bool)
        self.inner = numpy.zeros(self.shape, dtype=bool)
        self.gaze_px = {gaze: [float(v) * n for v, n in zip(gaze.split(","), (width, height))] for gaze in gazes}
        self.asked = asked
        if asked.whole:
            self.is_traced[:] = True
            return
        columns = max(round(width / asked.stride), 1)
        rows = max(round(height / asked.stride), 1)
        for row in range(rows):
            for column in range(columns):
                at = ((column + 0.5) * width / columns, (row + 0.5) * height / rows)
                self.inner[self.square(at, asked.inner / 2)] = True
                self.is_traced[self.square(at, asked.inner / 2 + asked.margin)] = True
        for at in self.gaze_px.values():
            self.is_traced[self.square(at, asked.inner / 2 + asked.margin)] = True

    def square(self, at, half):
        height, width = self.shape
        x, y = at
        return (slice(max(round(y - half), 0), min(round(y + half), height)),
                slice(max(round(x - half), 0), min(round(x + half), width)))

    def weights(self, gaze):
        """Of each pixel: the fovea's window counts as it is, the others for all that is not in it."""
        if self.asked.whole:
            return numpy.ones(self.shape)
        fovea = numpy.zeros(self.shape, dtype=bool)
        fovea[self.square(self.gaze_px[gaze], self.asked.inner / 2)] = True
        others = self.inner & ~fovea
        weights = fovea.astype(float)
        weights[others] = (fovea.size - fovea.sum()) / others.sum()
        return weights


class OtherJudges:
    """What nothing was optimised for: the relative squared error weighted by cortical magnification, and how much the relative
    error changes from frame to frame (root mean square)."""

    def __init__(self, weights, gaze_px, pixels_per_degree):
        height, width = weights.shape
        step = math.tan(math.radians(1 / pixels_per_degree))
        x, y = numpy.meshgrid((numpy.arange(width) + 0.5 - width / 2) * step, (numpy.arange(height) + 0.5 - height / 2) * step)
        at = [(gaze_px[0] - width / 2) * step, (gaze_px[1] - height / 2) * step]
        across = numpy.hypot(numpy.hypot(x * at[1] - y * at[0], x - at[0]), y - at[1])
        eccentricity_deg = numpy.degrees(numpy.arctan2(across, 1 + x * at[0] + y * at[1]))
        # Square millimetres of cortex a square degree (Horton and Hoyt 1991), times a constant.
        self.cortex = weights / (eccentricity_deg + 0.75)**2
        self.weights = weights
        self.before = None
        self.squares, self.changes, self.frames = 0.0, 0.0, 0

    @staticmethod
    def luminance(rgb):
        return rgb.astype(numpy.float64) @ numpy.array([0.2126, 0.7152, 0.0722])

    def add(self, picture, truth):
        expected = self.luminance(truth)
        error = (self.luminance(picture) - expected) / numpy.sqrt(expected**2 + 0.01)
        self.squares += float((self.cortex * error**2).sum() / self.cortex.sum())
        if self.before is not None:
            self.changes += float((self.weights * (error - self.before)**2).sum() / self.weights.sum())
        self.before = error
        self.frames += 1

    def found(self):
        return {"cortical": self.squares / self.frames, "change": math.sqrt(self.changes / max(self.frames - 1, 1))}

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the synthetic gaze logs of this folder, with the truth they were made from.

    make_gaze_logs.py [--out FOLDER] [--seed N]

Each log NAME.csv is a gazetrace CSV at 250 Hz; NAME_truth.csv beside it lists what the simulated eye did, without noise.
Same seed, same bytes. Python 3, standard library only.

Angles (azimuth right, elevation up) are independent, as on a flat display seen head on: x = d tan(azimuth),
y = d tan(elevation), from the display's centre. An eye at rest is never still and a tracker is never exact:
  * drift while fixating: Brownian, about 20 arcmin^2/s per axis (Engbert & Kliegl 2004 and later; the order of magnitude),
  * measurement noise: white, 0.05 deg SD per axis, as good remote trackers have it.
Saccades follow the main sequence, duration = 2.2 ms/deg x amplitude + 21 ms (Carpenter 1988), with the minimum-jerk
position profile 10 s^3 - 15 s^4 + 6 s^5 (Hogan 1984), whose velocity is the right bell shape.
"""
import argparse
import math
import os
import random

# The display of the preset "paper": 3840 x 2160 px, 70.848 x 39.852 cm, seen from 60 cm (61.1 x 36.8 deg).
WIDTH_PX, HEIGHT_PX = 3840, 2160
WIDTH_MM, HEIGHT_MM, DISTANCE_MM = 708.48, 398.52, 600.0

STEP_NS = 4_000_000  # 250 Hz
BEGIN_NS = 10_000_000_000  # logs do not start at 0; readers must not assume it
DRIFT_DEG2_PER_S = 20.0 / 3600.0
NOISE_SD_DEG = 0.05


def to_fraction(azimuth_deg, elevation_deg):
    u = 0.5 + DISTANCE_MM * math.tan(math.radians(azimuth_deg)) / WIDTH_MM
    v = 0.5 - DISTANCE_MM * math.tan(math.radians(elevation_deg)) / HEIGHT_MM
    return u, v


def to_angles(u, v):
    return (
        math.degrees(math.atan((u - 0.5) * WIDTH_MM / DISTANCE_MM)),
        math.degrees(math.atan((0.5 - v) * HEIGHT_MM / DISTANCE_MM)),
    )


def angle_between_deg(a, b):
    """Between the directions of two (azimuth, elevation) pairs, by atan2(|a x b|, a . b)."""
    p = (math.tan(math.radians(a[0])), math.tan(math.radians(a[1])), -1.0)
    q = (math.tan(math.radians(b[0])), math.tan(math.radians(b[1])), -1.0)
    cross = (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])
    dot = sum(x * y for x, y in zip(p, q))
    return math.degrees(math.atan2(math.sqrt(sum(c * c for c in cross)), dot))


def saccade_duration_ns(amplitude_deg):
    duration_ns = (2.2 * amplitude_deg + 21.0) * 1e6
    return max(1, round(duration_ns / STEP_NS)) * STEP_NS


class Recorder:
    """Builds a log from phases; every phase lasts a whole number of steps, so the grid of times never slips."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.time_ns = BEGIN_NS
        self.gaze_deg = (0.0, 0.0)  # where the eye means to look, free of drift and noise
        self.drift_deg = [0.0, 0.0]
        self.samples = []
        self.phases = []

    def _sample(self, azimuth, elevation, valid):
        noise = [self.random.gauss(0.0, NOISE_SD_DEG) for _ in range(2)]
        if valid == "ok":
            u, v = to_fraction(
                azimuth + self.drift_deg[0] + noise[0], elevation + self.drift_deg[1] + noise[1]
            )
            position = f"{u:.7f},{v:.7f}"
            if not (0.0 <= u <= 1.0 and 0.0 <= v <= 1.0):
                valid = "off_screen"
        else:
            position = "nan,nan"
        self.samples.append(f"{self.time_ns},{position},{valid},cyclopean")
        self.time_ns += STEP_NS

    def _phase(self, kind, duration_ns, path, valid="ok", drifts=True):
        """`path`: seconds since the phase began -> (azimuth, elevation)."""
        begin_ns = self.time_ns
        start = path(0.0)
        spread = math.sqrt(DRIFT_DEG2_PER_S * STEP_NS * 1e-9)
        for step in range(duration_ns // STEP_NS):
            azimuth, elevation = path(step * STEP_NS * 1e-9)
            if drifts:
                self.drift_deg = [d + self.random.gauss(0.0, spread) for d in self.drift_deg]
            self._sample(azimuth, elevation, valid)
        self.gaze_deg = path(duration_ns * 1e-9)
        ends = [*to_fraction(*start), *to_fraction(*self.gaze_deg)]
        self.phases.append(f"{begin_ns},{self.time_ns},{kind}," + ",".join(f"{e:.7f}" for e in ends))

    def fixate(self, duration_ns):
        target = self.gaze_deg
        self._phase("fixation", duration_ns, lambda t: target)

    def jump(self, target_deg):
        """A saccade; it also corrects the drift of the fixation before it."""
        start = tuple(g + d for g, d in zip(self.gaze_deg, self.drift_deg))
        self.drift_deg = [0.0, 0.0]
        duration_ns = saccade_duration_ns(angle_between_deg(start, target_deg))

        def path(t):
            s = min(1.0, t / (duration_ns * 1e-9))
            way = s * s * s * (10.0 + s * (6.0 * s - 15.0))
            return tuple(a + (b - a) * way for a, b in zip(start, target_deg))

        self._phase("saccade", duration_ns, path, drifts=False)
        self.gaze_deg = target_deg

    def lose(self, kind, duration_ns):
        """blink: the lid is down; lost: the tracker has no eye. The eye itself stays where it was."""
        target = self.gaze_deg
        self._phase(kind, duration_ns, lambda t: target, valid=kind)

    def pursue(self, kind, duration_ns, path):
        self._phase(kind, duration_ns, path, drifts=False)

    def write(self, folder, name):
        header = [
            "# gazetrace-gaze 1",
            f"# display_px {WIDTH_PX} {HEIGHT_PX}",
            f"# display_mm {WIDTH_MM:g} {HEIGHT_MM:g}",
            f"# distance_mm {DISTANCE_MM:g}",
            "# clock synthetic, arbitrary zero",
            "t[ns],u[1],v[1],valid,eye",
        ]
        write_lines(os.path.join(folder, name + ".csv"), header + self.samples)
        write_lines(
            os.path.join(folder, name + "_truth.csv"),
            ["begin[ns],end[ns],kind,begin_u[1],begin_v[1],end_u[1],end_v[1]", *self.phases],
        )


def write_lines(path, lines):
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join(lines) + "\n")


def ms(value):
    return value * 1_000_000


def fixation_grid(seed):
    """Nine targets, 3 x 3 at 0.1, 0.5, 0.9 of the display, row by row, 600 ms each."""
    log = Recorder(seed)
    targets = [to_angles(u, v) for v in (0.1, 0.5, 0.9) for u in (0.1, 0.5, 0.9)]
    log.gaze_deg = targets[0]
    log.fixate(ms(600))
    for target in targets[1:]:
        log.jump(target)
        log.fixate(ms(600))
    return log


def smooth_pursuit(seed):
    """A horizontal sinusoid (12 deg, 0.25 Hz, one period, peak 18.8 deg/s), then a ramp of 10 deg/s to the right."""
    log = Recorder(seed + 1)
    log.fixate(ms(400))
    log.pursue("pursuit_sinusoid", ms(4000), lambda t: (12.0 * math.sin(2.0 * math.pi * 0.25 * t), 0.0))
    log.fixate(ms(200))
    log.jump((-12.0, -4.0))
    log.fixate(ms(200))
    log.pursue("pursuit_ramp", ms(2400), lambda t: (-12.0 + 10.0 * t, -4.0))
    log.fixate(ms(400))
    return log


def saccades_blinks(seed):
    """Random targets with blinks (152 ms), a short loss (60 ms, shorter than the usual 75 ms fill) and a long one (800 ms)."""
    log = Recorder(seed + 2)
    places = random.Random(seed + 3)
    gaps = {2: ("blink", ms(152)), 4: ("lost", ms(60)), 6: ("blink", ms(152)), 8: ("lost", ms(800)), 11: ("blink", ms(152))}
    log.fixate(ms(300))
    for index in range(14):
        log.jump(to_angles(places.uniform(0.08, 0.92), places.uniform(0.1, 0.9)))
        log.fixate(4_000_000 * places.randrange(45, 110))
        if index in gaps:
            log.lose(*gaps[index])
            log.fixate(ms(120))
    return log


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--out", default=os.path.dirname(os.path.abspath(__file__)))
    parser.add_argument("--seed", type=int, default=20260)
    args = parser.parse_args()
    for make in (fixation_grid, smooth_pursuit, saccades_blinks):
        make(args.seed).write(args.out, make.__name__)


if __name__ == "__main__":
    main()

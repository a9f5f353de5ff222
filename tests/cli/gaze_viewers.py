# SPDX-License-Identifier: Apache-2.0
"""Viewers that are made up: they rest at places that are known and jump between them as eyes do, with a little noise.
What they do is written as recordings of many kinds."""

import math
import random
import struct

from gaze_reading import ANGLES, PLACES

SACCADE_S = 0.040


def viewer(places, rate_hz=120, rest_s=0.3, rounds=2, noise=0.0006, blinks=True, seed=1):
    """(seconds, x, y) for each sample; x and y are None in blinks. `noise` is in the unit of the places."""
    chance = random.Random(seed)
    stops = places * rounds
    samples = []
    stay = rest_s + SACCADE_S
    for i in range(int(len(stops) * stay * rate_hz)):
        t = i / rate_hz
        stop = min(int(t / stay), len(stops) - 1)
        at = t - stop * stay
        here, before = stops[stop], stops[max(stop - 1, 0)]
        s = min(at / SACCADE_S, 1)
        s = 10 * s**3 - 15 * s**4 + 6 * s**5  # minimum jerk
        x, y = (b + s * (h - b) + chance.gauss(0, noise) for b, h in zip(before, here))
        lost = blinks and stop % 5 == 3 and 0.1 < at < 0.2
        samples.append((t, None, None) if lost else (t, x, y))
    return samples


def on_screen(**options):
    return viewer(PLACES, **options)


def in_head(**options):
    """(seconds, (right, up, ahead)) of unit length; None in blinks."""
    rows = []
    for t, right, up in viewer(ANGLES, noise=0.02, **options):
        if right is None:
            rows.append((t, None))
            continue
        az, el = math.radians(right), math.radians(up)
        rows.append((t, (math.sin(az) * math.cos(el), math.sin(el), math.cos(az) * math.cos(el))))
    return rows


def table(header, rows, separator=","):
    return "\n".join([header, *(separator.join(str(cell) for cell in row) for row in rows)]) + "\n"


def quaternion(right, up, ahead, forward=1):
    """The turn that takes straight ahead, along z with the sign of `forward`, to a direction given in the same axes."""
    from_z = (0.0, 0.0, float(forward))
    to = (right, up, forward * ahead)
    cross = (from_z[1] * to[2] - from_z[2] * to[1], from_z[2] * to[0] - from_z[0] * to[2], from_z[0] * to[1] - from_z[1] * to[0])
    w = 1 + sum(a * b for a, b in zip(from_z, to))
    norm = math.sqrt(sum(c * c for c in cross) + w * w)
    return [c / norm for c in cross] + [w / norm]


def xdf(name, channels, samples):
    """LSL's file of one stream of type Gaze: channels are (label, other XML) and samples (seconds, values)."""

    def chunk(tag, content):
        return struct.pack("<BQH", 8, len(content) + 2, tag) + content

    described = "".join(f"<channel><label>{label}</label>{more}</channel>" for label, more in channels)
    header = (f"<info><name>{name}</name><type>Gaze</type><channel_count>{len(channels)}</channel_count><nominal_srate>0</nominal_srate>"
              f"<channel_format>double64</channel_format><desc><channels>{described}</channels></desc></info>")
    rows = b"".join(struct.pack("<Bd", 8, t) + struct.pack(f"<{len(values)}d", *values) for t, values in samples)
    return (b"XDF:" + chunk(1, b"<info><version>1.0</version></info>") + chunk(2, struct.pack("<I", 1) + header.encode())
            + chunk(3, struct.pack("<IBQ", 1, 8, len(samples)) + rows))

# SPDX-License-Identifier: Apache-2.0
"""Scores of pictures by the authors' programs."""

import json
import struct

WIDTH, HEIGHT = 40, 30
# 0.7 m before 0.7 m of 3840 pixels: 67.02 pixels a degree, at which FLIP's program works unasked.
SCREEN = ["--screen-px", "3840,2160", "--screen-cm", "70,39.375", "--screen-distance-cm", "70", "--frame-rect", f"0,0,{WIDTH},{HEIGHT}"]


def _light(x, y):
    """Two pixels of five are lit."""
    return ((x % 8 + 1) / 4, (y % 6 + 1) / 3, 1.0) if (7 * x + 13 * y) % 5 < 2 else (0.0, 0.0, 0.0)


def _write(path, light):
    """An EXR of floats without compression."""
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    channels = b"".join(name + b"\0" + struct.pack("<iBxxxii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    header = struct.pack("<II", 20000630, 2) + b"".join((
        attribute(b"channels", b"chlist", channels), attribute(b"compression", b"compression", b"\0"), attribute(b"dataWindow", b"box2i", window),
        attribute(b"displayWindow", b"box2i", window), attribute(b"lineOrder", b"lineOrder", b"\0"),
        attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)), attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)))) + b"\0"
    size = 8 + 12 * WIDTH
    rows = b""
    for y in range(HEIGHT):
        pixels = [light(x, y) for x in range(WIDTH)]
        rows += struct.pack("<2i", y, 12 * WIDTH) + b"".join(struct.pack(f"<{WIDTH}f", *(pixel[c] for pixel in pixels)) for c in (2, 1, 0))
    offsets = b"".join(struct.pack("<Q", len(header) + 8 * HEIGHT + size * y) for y in range(HEIGHT))
    path.write_bytes(header + offsets + rows)
    return path


def hdr_flip_of_a_mostly_black_picture(bench):
    """24 exposures up to 24.083 stops, and a mean of 0.647591 (flip-evaluator 1.7 of the same numbers)"""
    reference = _write(bench.folder / "ref.exr", _light)
    test = _write(bench.folder / "test.exr", lambda x, y: tuple(1.125 * c + 1 / 128 for c in _light(x, y)))
    result = bench.run_program("compare", reference, test, "--metrics", "hdr_flip", *SCREEN, "--json", "out.json", "--anyway")
    if result.returncode:
        return False, bench.last_line(result)
    value = json.loads((bench.folder / "out.json").read_text())["sequence"][0]["scores"][0]["value"]
    return abs(value - 0.647591) < 1e-4, f"{value:.6f}"


def version_beside_jod(bench):
    """a score of FovVideoVDP is in JOD, version 1.2 of its parameters"""
    picture = bench.scene("compare/a8.png")
    result = bench.run_program("compare", picture, bench.scene("compare/b8.png"), "--metrics", "fovvideovdp", "--gaze-at", "0.5,0.5",
                               "--screen-px", "64,48", "--screen-cm", "64,48", "--screen-distance-cm", "60", "--json", "unit.json",
                               "--csv", "unit.csv")
    if result.returncode:
        return False, bench.last_line(result)
    unit = json.loads((bench.folder / "unit.json").read_text())["sequence"][0]["scores"][0]["unit"]
    lines = (bench.folder / "unit.csv").read_text().splitlines()
    shown = [line for line in result.stdout.splitlines() if line.startswith("fovvideovdp [")]
    return (unit, lines[0].split(",")[-1], lines[1].split(",")[-1], shown != []) == ("JOD v1.2", "unit", "JOD v1.2", True), unit

# SPDX-License-Identifier: Apache-2.0
"""Alpha, windows, layers, primaries, transfer and orientation of the pictures that come in as textures, environments,
sequences to compare and densities."""

import json
import struct

import harness

# Pillow: 8 x 8 pixels of one grey.
JPEG = bytes.fromhex("ffd8ffe000104a46494600010100000100010000ffdb004300100b0c0e0c0a100e0d0e1211101318281a181616183123251d283a333d3c3933383740"
    "485c4e404457453738506d51575f626768673e4d71797064785c656763ffc0000b080008000801011100ffc400140001000000000000000000000000"
    "00000002ffc40014100100000000000000000000000000000000ffda0008010100003f002fffd9")
RGBE = b"#?RADIANCE\n%sFORMAT=32-bit_rle_rgbe\n\n"


def _ball(bench, name, *options):
    return bench.render(bench.scene("env-exr/ball.gltf"), "--env", bench.scene(name) if "/" in str(name) else bench.folder / name,
                        "--spp", "4", *options)


def _lit_as(bench, name, other, tolerance=1e-6):
    """Whether the ball reflects one environment as it does the other; the mean of both."""
    result, got = _ball(bench, name)
    expected = _ball(bench, other)[1]
    if got is None:
        return False, bench.last_line(result)
    return got.difference(expected) <= tolerance, "mean %.4f %.4f %.4f" % got.mean() + ", that of %s is %.4f %.4f %.4f" % (other, *expected.mean())


def _exr(display, data, channels, attributes=(), half=False):
    """An EXR without compression; channels: name -> value(x, y); attributes: (name, type, bytes)."""
    letter, kind = ("e", 1) if half else ("f", 2)
    names = sorted(channels)
    entries = b"".join(name.encode() + b"\0" + struct.pack("<iBxxxii", kind, 0, 1, 1) for name in names) + b"\0"
    header = b""
    for name, type_, value in [("channels", "chlist", entries), ("compression", "compression", b"\0"),
                               ("dataWindow", "box2i", struct.pack("<4i", *data)), ("displayWindow", "box2i", struct.pack("<4i", *display)),
                               ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                               ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1)),
                               *attributes]:
        header += name.encode() + b"\0" + type_.encode() + b"\0" + struct.pack("<i", len(value)) + value
    start = struct.pack("<II", 20000630, 2) + header + b"\0"
    x0, y0, x1, y1 = data
    lines, offsets = b"", b""
    for y in range(y0, y1 + 1):
        pixels = b"".join(struct.pack(f"<{x1 - x0 + 1}{letter}", *(channels[name](x, y) for x in range(x0, x1 + 1))) for name in names)
        offsets += struct.pack("<Q", len(start) + 8 * (y1 - y0 + 1) + len(lines))
        lines += struct.pack("<ii", y, len(pixels)) + pixels
    return start + offsets + lines


def _score(bench, reference, test, metric):
    """The value of a metric between two pictures; AssertionError with what was printed where there is none."""
    result = bench.run_program("compare", reference, test, "--metrics", metric, "--json", "scores.json", "--overwrite")
    if result.returncode != 0:
        raise AssertionError(bench.last_line(result))
    return json.loads((bench.folder / "scores.json").read_text())["sequence"][0]["scores"][0]["value"]


def _scored(bench, reference, test, metric, right, tolerance):
    return bench.near([_score(bench, reference, test, metric)], [right], tolerance)


# Alpha


def _over_black(bench, name):
    """The mean of the middle of the picture, which the quad fills."""
    picture = bench.picture(bench.scene(name), "--env", "none", "--spp", "64")
    pixels = [picture.pixel(x, y) for y in range(17, 37) for x in range(38, 58)]
    return bench.near([sum(pixel[c] for pixel in pixels) / len(pixels) for c in range(3)], [0.502] * 3, 0.01)


def png_alpha_is_straight(bench):
    "white, alpha 128, over black: 0.502"
    return _over_black(bench, "webp-alpha/blend_png.gltf")


def webp_alpha_is_straight(bench):
    "as the PNG: 0.502"
    return _over_black(bench, "webp-alpha/blend_webp.gltf")


def flip_of_colors_beside_alpha(bench):
    "0.067546, with alpha 128 everywhere and without"
    first = _score(bench, bench.scene("compare/a8.png"), bench.scene("compare/b8.png"), "flip")
    second = _score(bench, bench.scene("compare/a8a.png"), bench.scene("compare/b8a.png"), "flip")
    return bench.near([first, second], [0.067546] * 2, 1e-5)


# Environments in EXR


def exr_of_two_parts(bench):
    "part 0 is a depth of 7, part 1 the light: that of plain.exr"
    return _lit_as(bench, "env-exr/multi.exr", "env-exr/plain.exr")


def exr_of_layers(bench):
    "ViewLayer.AO is 1, ViewLayer.Combined the light: that of plain.exr"
    return _lit_as(bench, "env-exr/layer.exr", "env-exr/plain.exr")


def exr_crop(bench):
    "as the picture that has black where the crop has no data"
    light = {"R": lambda x, y: 0.5 if 8 <= y <= 23 else 0, "G": lambda x, y: y / 32 if 8 <= y <= 23 else 0,
             "B": lambda x, y: x / 64 if 8 <= y <= 23 else 0}
    bench.write("whole.exr", _exr((0, 0, 63, 31), (0, 0, 63, 31), light))
    bench.write("crop.exr", _exr((0, 0, 63, 31), (0, 8, 63, 23), light))
    return _lit_as(bench, "crop.exr", "whole.exr")


def exr_crop_of_the_field(bench):
    "rows 8 to 15 are 0.1 0.3 0.9, rows 16 to 23 are 0.4 0.25 0.1, and the rest is black"
    rows = [(0, 0, 0)] * 8 + [(0.1, 0.3, 0.9)] * 8 + [(0.4, 0.25, 0.1)] * 8 + [(0, 0, 0)] * 8
    bench.write("whole.exr", _exr((0, 0, 63, 31), (0, 0, 63, 31), {c: lambda x, y, i=i: rows[y][i] for i, c in enumerate("RGB")}))
    return _lit_as(bench, "env-exr/crop.exr", "whole.exr")


def exr_in_ap0(bench):
    "the same light in other primaries: that of plain.exr, to the rounding of the matrix that made the file"
    return _lit_as(bench, "env-exr/ap0.exr", "env-exr/plain.exr", 0.001)


def exr_in_xyz(bench):
    "X, Y and Z of Rec.709's white and red are 0.9505 1 1.0891 and 0.4124 0.2126 0.0193: as the file that has 1 1 1 and 1 0 0"
    xyz = [(0.412391, 0.212639, 0.019331), (0.950456, 1.0, 1.089058)]
    bench.write("xyz.exr", _exr((0, 0, 15, 7), (0, 0, 15, 7), {c: lambda x, y, i=i: xyz[x // 8][i] for i, c in enumerate("RGB")},
                                [("chromaticities", "chromaticities", struct.pack("<8f", 1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3))]))
    bench.write("rgb.exr", _exr((0, 0, 15, 7), (0, 0, 15, 7), {"R": lambda x, y: 1, "G": lambda x, y: x // 8, "B": lambda x, y: x // 8}))
    return _lit_as(bench, "xyz.exr", "rgb.exr", 1e-4)


def exr_cube_map(bench):
    "refused as a cube map"
    return bench.refused(_ball(bench, "env-exr/cube.exr")[0], "cube map")


def cross_of_a_cube(bench):
    "six faces of 4 x 3 or 3 x 4 places, the corners empty: refused as a cube map"
    for columns, rows in ((4, 3), (3, 4)):
        row_of_all = 1  # of both forms; beside it the second column
        light = {c: lambda x, y, i=i: 0.2 + 0.1 * i + (x + y) / 99 if x // 8 == 1 or y // 8 == row_of_all else 0 for i, c in enumerate("RGB")}
        window = (0, 0, 8 * columns - 1, 8 * rows - 1)
        bench.write("cross.exr", _exr(window, window, light))
        good, got = bench.refused(_ball(bench, "cross.exr")[0], "cube map")
        if not good:
            return False, f"{columns} x {rows}: {got}"
    return True, got


def exr_of_depth_alone(bench):
    "refused: Z is no light"
    return bench.refused(_ball(bench, bench.fault("env_only_Z.exr"))[0], "none of which are its light")


def exr_of_luminance_and_chroma(bench):
    "refused as luminance and chroma"
    bench.write("yc.exr", _exr((0, 0, 15, 7), (0, 0, 15, 7), {name: lambda x, y: 0.5 for name in ("Y", "RY", "BY")}))
    return bench.refused(_ball(bench, "yc.exr")[0], "luminance and chroma")


def exr_with_infinite_halves(bench):
    "the largest half, 65504, with a warning that counts the pixels"
    for name, sun in (("infinite.exr", float("inf")), ("largest.exr", 65504)):
        bench.write(name, _exr((0, 0, 63, 31), (0, 0, 63, 31), {c: lambda x, y: sun if (x, y) in ((20, 9), (21, 9)) else 0.25 for c in "RGB"},
                               half=True))
    same, got = _lit_as(bench, "infinite.exr", "largest.exr")
    text = bench.run_program("render", bench.scene("env-exr/ball.gltf"), "--env", "infinite.exr", "--size", "8x8", "--spp", "1", "--filter",
                             "none", "--sampling", "uniform", "-o", "out.exr").stderr
    told = [line for line in text.splitlines() if "infinite" in line]
    return same and bool(told) and "2 pixels" in told[0], f"{got}; {told[:1]}"


def exr_with_nan(bench):
    "refused, with the count and the first place"
    bench.write("nan.exr", _exr((0, 0, 15, 7), (0, 0, 15, 7), {c: lambda x, y: float("nan") if y == 3 and x > 12 else 1 for c in "RGB"}))
    return bench.refused(_ball(bench, "nan.exr")[0], "3 pixels are not finite", "13, 3")


# Environments in Radiance's format


def hdr_from_the_bottom(bench):
    "+Y: as plain.hdr"
    return _lit_as(bench, "env-hdr/plusY.hdr", "env-hdr/plain.hdr")


def hdr_exposed(bench):
    "EXPOSURE=4 with numbers 4 times as large: as plain.hdr"
    return _lit_as(bench, "env-hdr/exposure.hdr", "env-hdr/plain.hdr")


def hdr_of_xyze(bench):
    "refused by its kind"
    return bench.refused(_ball(bench, "env-hdr/xyze.hdr")[0], "xyze")


def _pixels(x, y):
    return bytes((40 + 3 * x, 200 - 5 * y, 90 + x + y, 129))


def hdr_in_eight_orientations(bench):
    "one picture, whose scanlines are rows or columns from either end"
    wrong = []
    for size in ("-Y 8 +X 16", "+Y 8 +X 16", "-Y 8 -X 16", "+Y 8 -X 16", "+X 16 -Y 8", "-X 16 -Y 8", "+X 16 +Y 8", "-X 16 +Y 8"):
        columns = range(16) if "+X" in size else range(15, -1, -1)
        rows = range(8) if "-Y" in size else range(7, -1, -1)
        places = [(x, y) for y in rows for x in columns] if size[1] == "Y" else [(x, y) for x in columns for y in rows]
        bench.write("turned.hdr", RGBE % b"" + size.encode() + b"\n" + b"".join(_pixels(x, y) for x, y in places))
        if size == "-Y 8 +X 16":
            (bench.folder / "turned.hdr").rename(bench.folder / "upright.hdr")
        elif not _lit_as(bench, "turned.hdr", "upright.hdr")[0]:
            wrong.append(size)
    return not wrong, f"wrong: {wrong}" if wrong else "8 equal"


def hdr_with_old_run_lengths(bench):
    "runs of pixels, in two digits where they are long: as without"
    color = [bytes((200, 100, 50, 129)), bytes((50, 60, 70, 128))]
    bench.write("flat.hdr", RGBE % b"" + b"-Y 4 +X 700\n" + 4 * (color[0] * 600 + color[1] * 100))
    line = color[0] + bytes((1, 1, 1, 87, 1, 1, 1, 2)) + color[1] + bytes((1, 1, 1, 99))  # 1 + 87 + 2 * 256 = 600
    bench.write("runs.hdr", RGBE % b"" + b"-Y 4 +X 700\n" + 4 * line)
    return _lit_as(bench, "runs.hdr", "flat.hdr")


def hdr_with_two_exposures(bench):
    "EXPOSURE=2, EXPOSURE=0.25 and COLORCORR=1 2 4: numbers are divided by all; that of an indented header is another's"
    bench.write("plain.hdr", RGBE % b"" + b"-Y 8 +X 16\n" + bytes((128, 64, 32, 130)) * 128)
    bench.write("exposed.hdr", RGBE % b"EXPOSURE=2\n\tEXPOSURE=64\nEXPOSURE= 0.25\nCOLORCORR=1 2 4\n" + b"-Y 8 +X 16\n" +
                bytes((128, 128, 128, 129)) * 128)
    return _lit_as(bench, "exposed.hdr", "plain.hdr")


def environment_of_display_values(bench):
    "a PNG of code 188 is light of 0.5029 (IEC 61966-2-1), with a warning"
    bench.write("grey.png", harness.png(16, 8, lambda x, y: (188, 188, 188)))
    light = ((188 / 255 + 0.055) / 1.055) ** 2.4
    bench.write("grey.exr", _exr((0, 0, 15, 7), (0, 0, 15, 7), {c: lambda x, y: light for c in "RGB"}))
    return _lit_as(bench, "grey.png", "grey.exr", 1e-5)


def environment_below_max_memory(bench):
    "a file of 180 kB that holds 30000 x 15000 pixels of one color in old runs is refused below --max-memory 1G"
    line = bytes((128, 64, 32, 129, 1, 1, 1, 47, 1, 1, 1, 117))  # 1 + 47 + 117 * 256 = 30000
    bench.write("large.hdr", RGBE % b"" + b"-Y 15000 +X 30000\n" + line * 15000)
    return bench.refused(_ball(bench, "large.hdr", "--max-memory", "1G")[0], "30000 x 15000", "max-memory")


def environment_that_claims_too_much(bench):
    "27 MB that claim 30000 x 15000 pixels are refused as damaged, before there is room for the pixels"
    bench.write("claims.hdr", RGBE % b"" + b"-Y 15000 +X 30000\n" + bytes(27_000_000))
    return bench.refused(_ball(bench, "claims.hdr", "--max-memory", "64G")[0], "end early")


# OpenColorIO


def ocio_data_view(bench):
    "view Raw of the user's configuration shows patch 3 as 0.8 0.1 0.05: codes 204, 26 and 13 (PyOpenColorIO 2.6), not ACES2065-1's 102, 40 and 18"
    result = bench.run_program("render", bench.scene("ocio-data-view/patches.gltf"), "--size", "160x90", "--sampling", "uniform", "--filter", "none",
                               "--spp", "1", "--ocio", bench.scene("ocio-data-view/config.ocio"), "--exposure", "0", "--view", "Raw", "-o", "raw.png", "--quiet")
    if result.returncode != 0:
        return False, bench.last_line(result)
    (width, height), rows = harness.read_png(bench.folder / "raw.png")
    seen = {rows[y][x] for y in range(height) for x in range(width)}
    right = any(max(abs(a - b) for a, b in zip(color, (204, 25.5, 12.75))) < 1 for color in seen)
    return right, f"{len(seen)} colors: " + " ".join(map(str, sorted(seen)[-8:]))


# compare


def _plane(name, bench, display, data, x0=0):
    bench.write(name, _exr(display, data, {c: lambda x, y: 0.1 + 0.02 * ((x - x0) % 7) if 4 <= x - x0 <= 11 and 2 <= y <= 5 else 0 for c in "RGB"}))
    return name


def compare_frames_that_are_cropped_differently(bench):
    "one frame, whole and without its black rim: mse 0"
    whole = _plane("whole.exr", bench, (0, 0, 15, 7), (0, 0, 15, 7))
    return _scored(bench, whole, _plane("crop.exr", bench, (0, 0, 15, 7), (4, 2, 11, 5)), "mse", 0, 0)


def compare_frames_that_are_shifted(bench):
    "the same data two pixels to the right in the same display window: mse above 0"
    first = _plane("first.exr", bench, (0, 0, 15, 7), (4, 2, 11, 5))
    score = _score(bench, first, _plane("shifted.exr", bench, (0, 0, 15, 7), (6, 2, 13, 5), 2), "mse")
    return score > 1e-4, f"mse {score:.6f}"


def compare_display_windows_that_are_shifted(bench):
    "the same data in a display window that begins elsewhere: refused by the windows"
    first = _plane("first.exr", bench, (0, 0, 15, 7), (0, 0, 15, 7))
    return bench.refused(bench.run_program("compare", first, _plane("moved.exr", bench, (2, 0, 17, 7), (2, 0, 17, 7), 2), "--metrics", "mse"),
                         "display window")


def compare_sees_parts(bench):
    "multi.exr, whose second part is plain.exr: mse 0"
    return _scored(bench, bench.scene("env-exr/plain.exr"), bench.scene("env-exr/multi.exr"), "mse", 0, 0)


def compare_sees_layers(bench):
    "layer.exr, whose ViewLayer.Combined is plain.exr: mse 0"
    return _scored(bench, bench.scene("env-exr/plain.exr"), bench.scene("env-exr/layer.exr"), "mse", 0, 0)


def compare_takes_radiance_for_light(bench):
    "plain.hdr and exposure.hdr are one light: mse 0; a picture of code values is no light"
    same = _score(bench, bench.scene("env-hdr/plain.hdr"), bench.scene("env-hdr/exposure.hdr"), "mse")
    bench.write("grey.png", harness.png(64, 32, lambda x, y: (188, 188, 188)))
    other, got = bench.refused(bench.run_program("compare", bench.scene("env-hdr/plain.hdr"), "grey.png", "--metrics", "mse"), "linear light")
    return same == 0 and other, f"mse {same}; {got}"


# Faults


def jpeg_with_many_markers(bench):
    "a JPEG with 200000 empty comments is read as the one without, in seconds"
    bench.write("few.jpg", JPEG)
    bench.write("many.jpg", JPEG[:2] + b"\xff\xfe\x00\x02" * 200000 + JPEG[2:])
    return _scored(bench, "few.jpg", "many.jpg", "mse", 0, 0)

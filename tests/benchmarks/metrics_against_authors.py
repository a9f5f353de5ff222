#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""FLIP and FovVideoVDP beside their authors' programs (Python packages flip-evaluator and pyfvvdp, with a PyTorch for the
CPU), and FLIP beside OpenImageIO's own (package openimageio, 3.2 and newer; columns with "oiio").

    metrics_against_authors.py GAZETRACE [--pairs N] [--hdr-pairs N] [--clips N] [--time]

Makes pairs of pictures, scores each with `gazetrace compare` and with those of the two programs that can be imported,
and prints the worst differences by what was done to them: LDR-FLIP and FovVideoVDP of display pictures with gaze in the
middle, HDR-FLIP of light over ten stops, each second pair with 60 % of its
reference black (needs the OpenEXR package), FovVideoVDP of clips of 14 frames with a gaze that
moves or jumps from frame to frame. --time scores one 3840 x 2160 pair as well and prints seconds
of three rounds, with reading and the start of the program on our side and not on theirs. Needs numpy.
"""

import argparse
import json
import math
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy as np

try:
    import flip_evaluator
except ImportError:
    flip_evaluator = None
try:
    import OpenImageIO
    from OpenImageIO import ImageBufAlgo
except ImportError:
    OpenImageIO = None
try:
    import OpenEXR
except ImportError:
    OpenEXR = None
try:
    import pyfvvdp
    import torch
except ImportError:
    pyfvvdp = None

FOV_DEG = 40
DISTANCE_CM = 60.0
SIZES = [(256, 256), (320, 180), (97, 64), (201, 133)]
KINDS = ("noise", "blur", "blocks of 4 pixels", "colour cast", "specks")


def blurred(picture, radius):
    kernel = np.ones(2 * radius + 1) / (2 * radius + 1)
    for axis in (0, 1):
        picture = np.apply_along_axis(lambda line: np.convolve(np.pad(line, radius, "edge"), kernel, "valid"), axis, picture)
    return picture


def scene(random, width, height):
    """Soft colour gradients, hard-edged discs and fine texture, 0..1."""
    y, x = np.mgrid[0:height, 0:width]
    picture = np.stack([0.5 + 0.4 * np.sin(x / width * random.uniform(2, 9) + y / height * random.uniform(2, 9) + c)
                        for c in random.uniform(0, 6, 3)], axis=-1)
    for _ in range(12):
        centre, radius = random.uniform(0, 1, 2) * (width, height), random.uniform(0.03, 0.2) * height
        picture[np.hypot(x - centre[0], y - centre[1]) < radius] = random.uniform(0, 1, 3)
    picture *= 1 + 0.15 * np.sin(x * random.uniform(0.3, 2.5))[..., None]
    return np.clip(picture, 0, 1)


def spoiled(random, picture, kind):
    height, width = picture.shape[:2]
    if kind == 0:
        return picture + random.normal(0, 0.08, picture.shape)
    if kind == 1:
        return blurred(picture, 2)
    if kind == 2:
        small = picture[: height // 4 * 4, : width // 4 * 4].reshape(height // 4, 4, width // 4, 4, 3).mean((1, 3))
        result = picture.copy()
        result[: height // 4 * 4, : width // 4 * 4] = small.repeat(4, 0).repeat(4, 1)
        return result
    if kind == 3:
        return picture * random.uniform(0.8, 1.2, 3)
    return np.where(random.uniform(0, 1, (height, width, 1)) < 0.01, 1.0, picture)


def png(codes):
    height, width = codes.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 1:] = codes.reshape(height, -1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b"")


def write_pair(folder, random, width, height, kind):
    reference = scene(random, width, height)
    codes = []
    for name, picture in (("ref", reference), ("test", spoiled(random, reference, kind))):
        codes.append((np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8))
        (folder / f"{name}.png").write_bytes(png(codes[-1]))
    return codes


def screen_cm(width, height):
    width_cm = 2 * DISTANCE_CM * math.tan(math.radians(FOV_DEG / 2))
    return width_cm, width_cm * height / width


def ours(program, folder, width, height, metric):
    size = screen_cm(width, height)
    start = time.perf_counter()
    subprocess.run([program, "compare", folder / "ref.png", folder / "test.png", "--metrics", metric, "--json", folder / "out.json", "--overwrite",
                    "--screen-px", f"{width},{height}", "--screen-cm", f"{size[0]!r},{size[1]!r}",
                    "--screen-distance-cm", str(DISTANCE_CM), "--gaze-at", f"{(width // 2 + 0.5) / width!r},{(height // 2 + 0.5) / height!r}",
                    "--threads", "2"], check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - start
    result = json.loads((folder / "out.json").read_text())
    return result["sequence"][0]["scores"][0]["value"], seconds, float(result["conditions"]["ppd"].split()[0])


def their_flip(reference, test, ppd):
    start = time.perf_counter()
    _, mean, _ = flip_evaluator.evaluate(reference.astype(np.float32) / 255, test.astype(np.float32) / 255, "LDR",
                                         inputsRGB=True, applyMagma=False, parameters={"ppd": ppd})
    return float(mean), time.perf_counter() - start


def in_open_image_io(light):
    picture = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(light.shape[1], light.shape[0], 3, "float"))
    picture.set_pixels(OpenImageIO.ROI(), np.ascontiguousarray(light, dtype=np.float32))
    return picture


def light_of_code(codes):
    value = codes.astype(np.float64) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def oiio_flip(reference, test, ppd, hdr):
    """Its HDR-FLIP is told the largest luminance and the median, of which the authors' program takes none below 2^-23."""
    luminance = np.sort((reference @ (0.2126, 0.7152, 0.0722)).ravel())
    errors = ImageBufAlgo.FLIP_diff(in_open_image_io(reference), in_open_image_io(test), hdr=int(hdr), ppd=ppd,
                                    maxluminance=float(luminance[-1]),
                                    medianluminance=float(max(luminance[luminance.size // 2], np.finfo(np.float32).eps)))
    return float(errors.get_pixels("float")[..., 0].mean(dtype=np.float64))


def their_jod(reference, test):
    height, width = reference.shape[:2]
    geometry = pyfvvdp.fvvdp_display_geometry((width, height), distance_m=DISTANCE_CM / 100, fov_horizontal=FOV_DEG)
    metric = pyfvvdp.fvvdp(display_geometry=geometry, display_name="standard_4k", foveated=True, heatmap=None,
                           device=torch.device("cpu"))
    start = time.perf_counter()
    jod, _ = metric.predict(test, reference, dim_order="HWC")
    return float(jod), time.perf_counter() - start


def write_hdr_pair(folder, random, width, height, kind, mostly_black):
    """Light over ten stops, as floats: display codes to a power, and a lamp."""
    reference = scene(random, width, height)
    y, x = np.mgrid[0:height, 0:width]
    lamp = np.exp(-np.hypot(x - random.uniform(0, width), y - random.uniform(0, height)) / (0.05 * height))
    scale = random.uniform(0.3, 3)
    light = [np.ascontiguousarray(np.clip(picture, 0, 1) ** 2.2 * scale + 30 * lamp[..., None], dtype=np.float32)
             for picture in (reference, spoiled(random, reference, kind))]
    if mostly_black:
        light[0][: height * 6 // 10] = 0
    for name, picture in zip(("ref", "test"), light):
        header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
        with OpenEXR.File(header, {"RGB": picture}) as file:
            file.write(str(folder / f"{name}.exr"))
    return light


def our_hdr_flip(program, folder, width, height):
    size = screen_cm(width, height)
    subprocess.run([program, "compare", folder / "ref.exr", folder / "test.exr", "--metrics", "hdr_flip", "--json",
                    folder / "out.json", "--overwrite", "--anyway", "--screen-px", f"{width},{height}",
                    "--screen-cm", f"{size[0]!r},{size[1]!r}", "--screen-distance-cm", str(DISTANCE_CM), "--threads", "2"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    result = json.loads((folder / "out.json").read_text())
    return result["sequence"][0]["scores"][0]["value"], float(result["conditions"]["ppd"].split()[0])


def their_hdr_flip(reference, test, ppd):
    _, mean, _ = flip_evaluator.evaluate(reference, test, "HDR", inputsRGB=True, applyMagma=False, parameters={"ppd": ppd})
    return float(mean)


CLIP_FRAMES, CLIP_FPS = 14, 24


def clip_gaze(random, clip, width, height):
    """A gaze for each frame, in whole pixels: gliding, or three places one after the other."""
    begin, end = random.uniform(0.1, 0.9, 2), random.uniform(0.1, 0.9, 2)
    if clip % 2 == 0:
        places = [begin + (end - begin) * k / (CLIP_FRAMES - 1) for k in range(CLIP_FRAMES)]
    else:
        three = random.uniform(0.05, 0.95, (3, 2))
        places = [three[k * 3 // CLIP_FRAMES] for k in range(CLIP_FRAMES)]
    return np.floor(np.array(places) * (width, height))


def write_clip(folder, random, width, height, clip):
    """A picture that drifts, and the same with what is done to it done anew in every frame."""
    wide = scene(random, width + 2 * CLIP_FRAMES, height)
    clips = {"ref": [], "test": []}
    for k in range(CLIP_FRAMES):
        frame = wide[:, 2 * k:2 * k + width]
        for name, picture in (("ref", frame), ("test", spoiled(random, frame, clip % len(KINDS)))):
            clips[name].append((np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8))
            (folder / f"{name}.{k + 1:04}.png").write_bytes(png(clips[name][-1]))
    gaze = clip_gaze(random, clip, width, height)
    rows = ["# gazetrace-gaze 1", "t_ns,u,v"]
    for k, (x, y) in enumerate(gaze):
        rows.append(f"{k * 1_000_000_000 // CLIP_FPS},{float(x + 0.5) / width!r},{float(y + 0.5) / height!r}")
    (folder / "gaze.csv").write_text("\n".join(rows) + "\n")
    return np.stack(clips["ref"], axis=-1), np.stack(clips["test"], axis=-1), gaze


def our_clip_jod(program, folder, width, height):
    size = screen_cm(width, height)
    subprocess.run([program, "compare", folder / "ref.####.png", folder / "test.####.png", "--metrics", "fovvideovdp",
                    "--json", folder / "out.json", "--overwrite", "--fps", str(CLIP_FPS), "--gaze", folder / "gaze.csv",
                    "--gaze-start", "0s", "--screen-px", f"{width},{height}", "--screen-cm", f"{size[0]!r},{size[1]!r}",
                    "--screen-distance-cm", str(DISTANCE_CM), "--threads", "2"], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    result = json.loads((folder / "out.json").read_text())
    whole = next(part for part in result["sequence"] if part["frames"] == CLIP_FRAMES)
    return whole["scores"][0]["value"]


def their_clip_jod(reference, test, gaze):
    height, width = reference.shape[:2]
    geometry = pyfvvdp.fvvdp_display_geometry((width, height), distance_m=DISTANCE_CM / 100, fov_horizontal=FOV_DEG)
    metric = pyfvvdp.fvvdp(display_geometry=geometry, display_name="standard_4k", foveated=True, heatmap=None,
                           device=torch.device("cpu"))
    jod, _ = metric.predict(test, reference, dim_order="HWCF", frames_per_second=CLIP_FPS,
                            fixation_point=torch.tensor(gaze, dtype=torch.float32))
    return float(jod)


def table(title, worst):
    metrics = sorted({metric for _, metric in worst})
    print(f"{title:<24}" + "".join(f"{metric:>16}" for metric in metrics))
    for row in (*KINDS, "all"):
        print(f"{row:<24}" + "".join(f"{worst.get((row, metric), math.nan):>16.2g}" for metric in metrics))


def keep(worst, kind, metric, difference):
    for row in (KINDS[kind], "all"):
        worst[row, metric] = max(worst.get((row, metric), 0), difference)


def stills(program, folder, random, count):
    worst = {}
    for pair in range(count):
        width, height = SIZES[pair % 4]
        kind = pair % 5
        pictures = write_pair(folder, random, width, height, kind)
        if flip_evaluator is not None:
            value, _, ppd = ours(program, folder, width, height, "flip")
            keep(worst, kind, "flip", abs(value - their_flip(*pictures, ppd)[0]))
            if OpenImageIO is not None:
                keep(worst, kind, "flip, oiio", abs(value - oiio_flip(*map(light_of_code, pictures), ppd, False)))
        if pyfvvdp is not None:
            value, _, _ = ours(program, folder, width, height, "fovvideovdp")
            keep(worst, kind, "fovvideovdp", abs(value - their_jod(*pictures)[0]))
    return worst


def hdr_pairs(program, folder, random, count):
    worst = {}
    for pair in range(count):
        width, height = SIZES[pair % 4]
        light = write_hdr_pair(folder, random, width, height, pair % 5, pair % 2 == 1)
        value, ppd = our_hdr_flip(program, folder, width, height)
        keep(worst, pair % 5, "hdr_flip", abs(value - their_hdr_flip(*light, ppd)))
        if OpenImageIO is not None:
            keep(worst, pair % 5, "hdr_flip, oiio", abs(value - oiio_flip(*light, ppd, True)))
    return worst


def clips(program, folder, random, count):
    worst = {}
    for clip in range(count):
        width, height = SIZES[clip % 4]
        pictures = write_clip(folder, random, width, height, clip)
        value = our_clip_jod(program, folder, width, height)
        keep(worst, clip % 5, "fovvideovdp", abs(value - their_clip_jod(*pictures)))
    return worst


def times(program, folder, random):
    width, height = 3840, 2160
    pictures = write_pair(folder, random, width, height, 0)
    for _ in range(3):
        if flip_evaluator is not None:
            _, seconds, ppd = ours(program, folder, width, height, "flip")
            print(f"flip         3840x2160: ours {seconds:.2f} s, flip-evaluator {their_flip(*pictures, ppd)[1]:.2f} s")
        if pyfvvdp is not None:
            _, seconds, _ = ours(program, folder, width, height, "fovvideovdp")
            print(f"fovvideovdp  3840x2160: ours {seconds:.2f} s, pyfvvdp {their_jod(*pictures)[1]:.2f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--hdr-pairs", type=int, default=0)
    parser.add_argument("--clips", type=int, default=0)
    parser.add_argument("--time", action="store_true")
    arguments = parser.parse_args()
    if flip_evaluator is None and pyfvvdp is None:
        sys.exit("neither flip_evaluator nor pyfvvdp can be imported")
    if arguments.hdr_pairs and (flip_evaluator is None or OpenEXR is None):
        sys.exit("--hdr-pairs needs flip_evaluator and OpenEXR")
    if arguments.clips and pyfvvdp is None:
        sys.exit("--clips needs pyfvvdp")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if arguments.pairs:
            table("worst difference", stills(arguments.program, folder, np.random.default_rng(20), arguments.pairs))
        if arguments.hdr_pairs:
            table("worst, pairs of light", hdr_pairs(arguments.program, folder, np.random.default_rng(21), arguments.hdr_pairs))
        if arguments.clips:
            table("worst, clips", clips(arguments.program, folder, np.random.default_rng(22), arguments.clips))
        if arguments.time:
            times(arguments.program, folder, np.random.default_rng(23))


if __name__ == "__main__":
    main()

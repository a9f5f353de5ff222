#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The source paper from its own data: the views, gazes and radii of its authors' code, counts, times and errors as a page.

    paper.py --data FOLDER --program gazetrace [--size 3840x2160] [--seconds 3600] [--scenes sponza,...] -o page.md

FOLDER has sponza/, san-miguel/, lost-empire/, lost-empire-x30/ (README.md beside this file says which public files they are)
and an environment, kiara_1_dawn_1k.hdr. Frames are timed in turns, uniform and foveated, for as long as --seconds allows;
errors are measured on pictures of --error-size. Nothing else should run beside it.
"""
import argparse
import csv
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DISPLAY_PX, DISPLAY_CM, DISTANCE_CM = (3840, 2160), 70.848, 60
RADII_PX = (148, 482)  # at 3840 x 2160; the code's own, which are its equation's halves of 5.2 and 17 degrees
RATE = 32  # of uniform frames, samples a pixel
SETTINGS = ((32, 16, 8), (32, 8, 4), (32, 4, 2), (32, 2, 1))
# Eye and target in the units of our copies (Sponza's OBJ times 0.008), vertical field in degrees, gaze in pixels from the middle
# of 3840 x 2160, and how many times more frames a second the authors' raw timings have than of uniform 32.
SCENES = {
    "sponza": ("sponza/Sponza.gltf", (-10.34456, 1.237448, 0.8), (1.6, 0, 0), 45, (0, 0), (25.5, 37.1, 47.3, 58.3)),
    "lost-empire": ("lost-empire/lost-empire.gltf", (60, 25, 50), (-70, 10, 0), 45, (960, -540), (24.1,)),
    "san-miguel": ("san-miguel/san-miguel.gltf", (26, 8, -2), (0, 0, 0), 35, (700, 540), (24.3,)),
    # Stands in for Rungholt, with a view of its own.
    "lost-empire-x30": ("lost-empire-x30/lost-empire-x30.gltf", (190, 180, 900), (190, 20, 350), 43, (0, 0), (23.3,)),
}


def gaze_of(scene):
    return tuple((size / 2 + offset) / size for size, offset in zip(DISPLAY_PX, SCENES[scene][4]))


def angle_deg(radius_px):
    """The eccentricity whose circle the paper's equation gives that radius."""
    return math.degrees(math.atan(radius_px * DISPLAY_CM / (DISPLAY_PX[0] * DISTANCE_CM)))


def pixels_within(scene, radius_px):
    """How many pixel centres of the display lie in the circle."""
    x, y = (fraction * size for fraction, size in zip(gaze_of(scene), DISPLAY_PX))
    count = 0
    for row in range(DISPLAY_PX[1]):
        half = radius_px**2 - (row + 0.5 - y) ** 2
        if half >= 0:
            first, last = math.ceil(x - math.sqrt(half) - 0.5), math.floor(x + math.sqrt(half) - 0.5)
            count += max(0, min(last, DISPLAY_PX[0] - 1) - max(first, 0) + 1)
    return count


class Program:
    def __init__(self, arguments, folder):
        self.path, self.data, self.folder = str(arguments.program.resolve()), arguments.data.resolve(), folder

    def run(self, *words):
        done = subprocess.run([self.path, *map(str, words)], cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"paper.py: {' '.join(map(str, words))}\n{done.stderr.strip()}")
        return done.stdout

    def has_denoiser(self):
        return not any(line.startswith("denoiser: none") for line in self.run("version").splitlines())

    def view(self, scene, size):
        """The words of `plan` and `render` that are the same for all frames of a scene."""
        path, eye, target, yfov, _, _ = SCENES[scene]
        place = {name: ",".join(map(repr, values)) for name, values in (("eye", eye), ("target", target), ("gaze", gaze_of(scene)))}
        return [self.data / path, "--env", self.data / "kiara_1_dawn_1k.hdr", f"--eye={place['eye']}", f"--target={place['target']}",
                "--yfov", yfov, "--screen", "paper", "--size", size, "--gaze-at", place["gaze"], "--frames", 1, "--allow-outside"]

    def render(self, scene, size, *options):
        """The row of the frame's timing."""
        self.run("render", *self.view(scene, size), "-o", "frame.exr", "--overwrite", "--quiet", *options)
        with open(self.folder / "frame.timing.csv", newline="", encoding="utf-8") as file:
            return next(csv.DictReader(file))


def foveated(setting, filter_name="linear"):
    return ["--preset", "paper", "--region-eccentricities", ",".join(repr(angle_deg(radius)) for radius in RADII_PX),
            "--region-samples", ",".join(map(str, setting)), "--filter", filter_name]


UNIFORM = ["--preset", "paper", "--sampling", "uniform", "--spp", RATE, "--filter", "none"]


def counts(program, scene, setting):
    """Nominal samples of the regions, which must be the sum over pixel centres, and what is traced, at the display's resolution."""
    size = "x".join(map(str, DISPLAY_PX))
    told = program.run("plan", *program.view(scene, size), "--counts", *foveated(setting))
    rows = {words[0]: words[1:] for words in (line.split() for line in told.splitlines()) if words}
    inner, outer = (pixels_within(scene, radius) for radius in RADII_PX)
    pixels = (inner, outer - inner, DISPLAY_PX[0] * DISPLAY_PX[1] - outer)
    ours = tuple(int(rows[name][0]) for name in ("fovea", "intermediate", "periphery"))
    if ours != pixels:
        sys.exit(f"paper.py: {scene}: the program counts {ours} pixels, pixel centres {pixels}")
    nominal = sum(count * rate / block**2 for count, rate, block in zip(pixels, setting, (1, 2, 4)))
    return pixels, nominal, int(rows["all"][-1])


def name_of(setting):
    return "/".join(map(str, setting))


def table(head, rows):
    return "\n".join(["| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows)]) + "\n"


def count_table(program, scenes):
    rows = []
    for scene in scenes:
        for setting in SETTINGS[: len(SCENES[scene][5])]:
            pixels, nominal, traced = counts(program, scene, setting)
            full = DISPLAY_PX[0] * DISPLAY_PX[1] * RATE
            rows.append([scene, name_of(setting), *map(str, pixels), f"{full / nominal:.2f}", f"{full / traced:.2f}"])
    return table(["scene", "samples", "fovea, pixels", "intermediate", "periphery", "fewer samples, nominal", "traced"], rows)


def time_table(program, scenes, size, seconds):
    """Frames in turns, scene by scene: one turn, and more while the time lasts."""
    runs = [(scene, setting) for scene in scenes for setting in (None, *SETTINGS[: len(SCENES[scene][5])])]
    measured, lasted, end = {run: [] for run in runs}, {}, time.monotonic() + seconds
    while True:
        before = sum(map(len, measured.values()))
        for run in runs:
            if run in lasted and time.monotonic() + lasted[run] > end:
                continue
            begin = time.monotonic()
            row = program.render(run[0], size, *(UNIFORM if run[1] is None else foveated(run[1])))
            lasted[run] = time.monotonic() - begin
            measured[run].append((float(row["total_ms"]) - float(row["write_ms"]), float(row["trace_cpu_ms"])))
        if sum(map(len, measured.values())) == before:
            break
    rows = []
    for scene, setting in runs:
        pair = measured[scene, None], measured[scene, setting]
        if setting is None:
            continue
        (uniform_ms, uniform_cpu), (ms, cpu) = ([sum(part) / len(part) for part in zip(*frames)] for frames in pair)
        published = dict(zip(SETTINGS, SCENES[scene][5]))[setting]
        rows.append([scene, name_of(setting), f"{len(pair[0])}, {len(pair[1])}", f"{uniform_ms / 1000:.3f}", f"{ms / 1000:.3f}",
                     f"{uniform_ms / ms:.1f}", f"{uniform_cpu / cpu:.1f}", f"{published:.1f}"])
    return table(["scene", "samples", "frames, uniform and foveated", "uniform 32, s", "foveated, s", "ratio of times", "of CPU time in paths",
                  "theirs"], rows)


def error_table(program, scene, size, reference_spp, seeds):
    """Relative MSE and FLIP by eccentricity at the samples of 32/16/8, means over seeds."""
    setting = SETTINGS[0]
    row = program.render(scene, size, *UNIFORM, "--spp", reference_spp, "--exr-pixels", "float", "--seed", 1)
    for made in program.folder.glob("frame.*"):
        made.replace(program.folder / made.name.replace("frame", "reference", 1))
    shown = ["--exposure", row["exposure_ev"], "--view", "Reinhard"]
    spp = float(program.render(scene, size, *foveated(setting))["samples"]) / math.prod(map(int, size.split("x")))
    light = ["--bounces", 3, "--no-russian-roulette", "--diffuse", "burley", "--pixel-filter", "box", "--clamp-indirect", 0]
    even = ["--preset", "paper", "--sampling", "uniform", "--spp", f"{spp:.6g}"]
    ways = (("constant in each block (theirs)", foveated(setting, "none")), ("`linear`", foveated(setting)),
            ("uniform, as traced", [*even, "--filter", "none"]), ("the default", ["--spp", f"{spp:.6g}", *light]))
    if program.has_denoiser():
        ways += (("their samples, denoised", foveated(setting, "oidn")), ("uniform, denoised", [*even, "--filter", "oidn"]))
    rows, bands = [], []
    for name, options in ways:
        scores = []
        for seed in range(2, 2 + seeds):
            program.render(scene, size, *options, *shown, "--seed", seed)
            told = json.loads(program.run("compare", "reference.exr", "frame.exr", "--metrics", "relmse,flip", "--anyway", "--json", "-"))
            scores.append({score["metric"]: {"whole": score["value"], **score["bands"]} for score in told["sequence"][0]["scores"]})
        bands = [band for band, value in scores[0]["flip"].items() if value is not None]
        rows.append([name, *(", ".join(f"{sum(score[metric][band] for score in scores) / seeds:.3g}" for metric in ("relmse", "flip"))
                             for band in bands)])
    return table([f"{scene}, {spp:.3f} samples a pixel", *(band if band == "whole" else f"{band} deg" for band in bands)], rows)


def page(program, arguments):
    scenes = arguments.scenes.split(",")
    yield "# The source paper from its own data\n"
    yield ("`examples/paper.py` makes this page with the views, gazes and radii (148 and 482 pixels at 3840 x 2160) of the paper's authors, "
           "under the environment kiara_1_dawn in place of theirs. `lost-empire-x30` stands in for Rungholt, with a view of its own. "
           f"{program.run('version').splitlines()[0]}.\n")
    yield "## Samples\n\nPixels are counted by their centres, by the program and apart from it; both counts are the same.\n"
    yield count_table(program, scenes)
    yield (f"## Times at {arguments.size}\n\nUniform and foveated frames in turns, for {arguments.seconds:g} s with all loading; no pictures are "
           "written within the times. The last column has the ratios of the authors' raw timings on their GPU.\n")
    yield time_table(program, scenes, arguments.size, arguments.seconds)
    yield (f"## Errors at {arguments.error_size}\n\nRelative MSE and FLIP by eccentricity, at the samples of {name_of(SETTINGS[0])}, against "
           f"uniform {arguments.reference_spp}; means of {arguments.seeds} seeds.{'' if program.has_denoiser() else ' No denoiser was found.'}\n")
    for scene in scenes:
        yield error_table(program, scene, arguments.error_size, arguments.reference_spp, arguments.seeds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--size", default="3840x2160", help="of the frames that are timed")
    parser.add_argument("--seconds", type=float, default=3600, help="for timing; one turn is made in any case")
    parser.add_argument("--error-size", default="960x540")
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("-o", "--output", type=Path, help="the page; else the standard output")
    arguments = parser.parse_args()
    for scene in arguments.scenes.split(","):
        if scene not in SCENES:
            parser.error(f"--scenes: '{scene}' is none of {', '.join(SCENES)}")
        if not (arguments.data / SCENES[scene][0]).is_file():
            parser.error(f"--data: {arguments.data / SCENES[scene][0]} is not there")
    with tempfile.TemporaryDirectory(prefix="gazetrace_paper_") as made:
        parts = []
        for part in page(Program(arguments, Path(made)), arguments):
            parts.append(part)
            print(part, flush=True)
    if arguments.output:
        arguments.output.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()

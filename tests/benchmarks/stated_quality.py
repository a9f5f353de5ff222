#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does a stated quality come out? Clips are rendered by `--target-jod`, and measured against a reference.

  stated_quality.py GAZETRACE OUT_FOLDER --scene "NAME FILE OPTIONS" [--scene ...] [--targets 8.5,9]
                    [--filters none] [--samplings uniform] [--gazes "0.5,0.5 0.25,0.6"] [--size 256x144] [--ppd 28]
                    [--frames 24] [--reference-spp 4096] [--seed 1] [--with "--accumulate window --accumulate-past 460ms --accumulate-future 460ms"]
                    [--pyfvvdp]

OPTIONS are those of `gazetrace render`. Views are at rest, so that one reference stands for all frames; it is rendered in
two halves of other seeds, and what the halves score against each other, as a still, is printed. Every line is a pair of clip and
target: JOD stated, predicted and measured by `gazetrace compare`, by how much that is off, the rate, and the share of the choice
in the time of all frames. Pictures that OUT_FOLDER holds already are used again; a line is printed as soon as it is measured.
The last lines count the pairs within 0.1 and 0.2 JOD. It needs the Python packages numpy and OpenEXR.

`--with` is for further options of all renderings but the reference. `--pyfvvdp` lets the authors' program judge (the Python package
pyfvvdp, with a PyTorch for the CPU): what is counted is then its score, and that of `gazetrace compare` stands beside it. Both see
the view sRGB, in 8 bits.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import shlex
import shutil
import statistics
import subprocess
import sys


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr else f"{arguments[:2]}: {done.returncode}")
    return done.stdout


class Bench:
    def __init__(self, asked):
        self.asked = asked
        self.out = pathlib.Path(asked.out)
        width, height = asked.size.split("x")
        self.screen = ["--screen-px", f"{width},{height}", "--screen-ppd", asked.ppd]

    def render(self, folder, scene, gaze, *options):
        if not (folder / "done").exists():
            shutil.rmtree(folder, ignore_errors=True)
            run(self.asked.program, "render", *scene, "--size", self.asked.size, "--gaze-at", gaze, *self.screen,
                "--exr-pixels", "float", "--quiet", "-o", folder / "f.####.exr", *options)
            (folder / "done").touch()
        return folder

    def view(self):
        return ["--view", "sRGB"] if self.asked.pyfvvdp else []

    def reference(self, name, scene):
        folder = self.out / name / "reference"
        half = str(self.asked.reference_spp // 2)
        for k, seed in enumerate((700001, 700002)):
            self.render(self.out / name / f"half{k}", scene, "0.5,0.5", "--frames", "1", "--sampling", "uniform", "--filter",
                        "none", "--no-guiding", "--spp", half, "--seed", str(seed))
        if not folder.exists():
            folder.mkdir()
            mean_of_exr(*(self.out / name / f"half{k}" / "f.0001.exr" for k in range(2)), folder / "f.0001.exr")
            for frame in range(2, self.asked.frames + 1):
                (folder / f"f.{frame:04d}.exr").symlink_to("f.0001.exr")
        return folder

    def score(self, reference, test, gaze, frames, exposure):
        scores = self.out / "scores.json"
        run(self.asked.program, "compare", reference / "f.####.exr", test / "f.####.exr", "--metrics", "fovvideovdp", "--fps",
            "24", "--frames", frames, "--anyway", *self.screen, "--gaze-at", gaze, "--exposure", exposure, *self.view(),
            "--overwrite", "--json", scores)
        return json.loads(scores.read_text())["sequence"][0]["scores"][0]["value"]


def read_exr(path):
    import numpy
    import OpenEXR
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return numpy.stack([file.channels()[c].pixels for c in "RGB"], -1)


def mean_of_exr(a, b, to):
    import numpy
    import OpenEXR
    mean = 0.5 * (read_exr(a) + read_exr(b))
    channels = {c: numpy.ascontiguousarray(mean[..., i], dtype=numpy.float32) for i, c in enumerate("RGB")}
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, channels) as file:
        file.write(str(to))


def codes(folder, frame, exposure):
    """As the view sRGB shows a frame, in 8 bits."""
    import numpy
    light = numpy.clip(read_exr(folder / f"f.{frame:04d}.exr").astype(numpy.float64) * 2.0 ** float(exposure), 0, 1)
    return numpy.rint(255 * numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)).astype(numpy.uint8)


def their_jod(reference, test, gaze, frames, exposure, ppd):
    import numpy
    import pyfvvdp
    import torch
    clips = [numpy.stack([codes(folder, frame, exposure) for frame in range(1, frames + 1)], -1) for folder in (test, reference)]
    height, width = clips[0].shape[:2]
    # The foot of the perpendicular has this many pixels a degree.
    fov_deg = math.degrees(2 * math.atan(width / 2 * math.tan(math.radians(1 / ppd))))
    geometry = pyfvvdp.fvvdp_display_geometry((width, height), distance_m=1, fov_horizontal=fov_deg)
    metric = pyfvvdp.fvvdp(display_geometry=geometry, display_name="standard_4k", foveated=True, heatmap=None,
                           device=torch.device("cpu"))
    u, v = (float(number) for number in gaze.split(","))
    # It takes pixels' middles for whole numbers.
    looks_at = torch.tensor([[u * width - 0.5, v * height - 0.5]] * frames, dtype=torch.float32)
    jod, _ = metric.predict(*clips, dim_order="HWCF", frames_per_second=24, fixation_point=looks_at)
    return float(jod)


def exposure_of(scene):
    return scene[scene.index("--exposure") + 1] if "--exposure" in scene else "0"


def judge(bench, name, scene, gaze, sampling, filter_name, target):
    asked = bench.asked
    folder = bench.out / name / f"jod-{gaze.replace(',', '_')}-{sampling}-{filter_name}-{target}"
    bench.render(folder, scene, gaze, "--frames", f"1-{asked.frames}", "--sampling", sampling, "--filter", filter_name,
                 "--target-jod", target, "--seed", str(asked.seed), *shlex.split(asked.options), *bench.view())
    with open(folder / "f.timing.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    rate = json.loads((folder / "f.run.json").read_text())["facts"]["rate"]
    predicted = float(re.search(r"expected to reach ([\d.e-]+)", rate)[1])
    whole = sum(float(row["total_ms"]) for row in rows)
    pilot = sum(float(row["pilot_ms"]) for row in rows)
    reference = bench.reference(name, scene)
    measured = bench.score(reference, folder, gaze, f"1-{asked.frames}", exposure_of(scene))
    theirs = their_jod(reference, folder, gaze, asked.frames, exposure_of(scene), float(asked.ppd)) if asked.pyfvvdp else None
    return predicted, measured, theirs, float(re.match(r"[\d.e+]+", rate)[0]), pilot / whole


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--scene", action="append", required=True)
    parser.add_argument("--targets", default="8.5,9")
    parser.add_argument("--filters", default="none")
    parser.add_argument("--samplings", default="uniform")
    parser.add_argument("--gazes", default="0.5,0.5 0.25,0.6")
    parser.add_argument("--size", default="256x144")
    parser.add_argument("--ppd", default="28")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--reference-spp", type=int, default=4096)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--with", dest="options", default="")
    parser.add_argument("--pyfvvdp", action="store_true")
    asked = parser.parse_args()
    bench = Bench(asked)
    print(f"{'scene':<14}{'gaze':>10} {'sampling':<9}{'filter':<8}{'stated':>7}{'predicted':>10}{'measured':>9}{'off':>7}"
          f"{'spp':>9}{'pilot':>7}{'pyfvvdp':>9}")
    off = {}
    pilots = []
    for text in asked.scene:
        name, *scene = shlex.split(text)
        bench.reference(name, scene)
        floor = bench.score(*(bench.out / name / f"half{k}" for k in range(2)), "0.5,0.5", "1", exposure_of(scene))
        print(f"{name}: the halves of the reference score {floor:.4g} JOD against each other, as a still")
        for gaze in asked.gazes.split():
            for sampling in asked.samplings.split(","):
                for filter_name in asked.filters.split(","):
                    for target in asked.targets.split(","):
                        place = f"{name:<14}{gaze:>10} {sampling:<9}{filter_name:<8}{float(target):7.4g}"
                        try:
                            predicted, measured, theirs, spp, pilot = judge(bench, name, scene, gaze, sampling, filter_name, target)
                        except RuntimeError as problem:
                            print(f"{place} {problem}", flush=True)
                            continue
                        judged = measured if theirs is None else theirs
                        error = judged - float(target)
                        off.setdefault(filter_name, []).append(error)
                        pilots.append(pilot)
                        print(f"{place}{predicted:10.4g}{measured:9.4g}{error:+7.3f}{spp:9.2f}{pilot:7.1%}"
                              + ("" if theirs is None else f"{theirs:9.4g}"), flush=True)
    for filter_name, values in off.items():
        bounds = (0.1, 0.2)
        near = [sum(abs(v) <= most for v in values) for most in bounds]
        print(f"{filter_name}: {near[0]} of {len(values)} within {bounds[0]}, {near[1]} within {bounds[1]}; mean "
              f"{statistics.fmean(values):+.3f}")
    if pilots:
        print(f"pilot: median {statistics.median(pilots):.1%} of the time, most {max(pilots):.1%}")


if __name__ == "__main__":
    sys.exit(main())

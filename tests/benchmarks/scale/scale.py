#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time and memory as a scene, a picture and its sampling grow. Needs numpy; run by hand (10^8 triangles: minutes, 20 GB).

  scale.py GAZETRACE --out FOLDER [--curves triangles,instances,lights,width,spp] [--most 8] [--threads 0]

Each curve renders generated scenes (generate.py) and prints a row a step:

  triangles   10^3 .. 10^most unique ones       load s, tree s, tree bytes a triangle, peak MiB, us a sample
  instances   the same number as copies of a rock of 10^3
  lights      1 .. 10^5 emissive triangles      and the median relative squared error of a sample against 16 times as many
  width       1 .. 16384 pixels, 16:9           us a sample, ms of reconstruction and writing and peak MiB a megapixel
  spp         1 .. 65536                        us a sample, relative RMS error against the longest run's other seed

Times are CPU time over all threads. Writes scale.csv and one SVG a curve beside the tables.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import generate
import plot

VIEW = ["--eye", "0,12,48", "--target", "0,0,0", "--yfov", "50"]


def read_exr(path):
    import OpenEXR

    channels = OpenEXR.File(str(path)).channels()
    picture = channels["RGB"].pixels if "RGB" in channels else np.dstack([channels[c].pixels for c in "RGB"])
    return np.asarray(picture, np.float64)[:, :, :3]


class Program:
    def __init__(self, path, threads, folder):
        self.path, self.threads, self.folder = path, str(threads), folder

    def scene(self, scene):
        words = [self.path, "scene", str(scene), "--bvh", "--json", "--threads", self.threads]
        return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)

    def render(self, scene, size, spp, *more, seed=1, pixels="float"):
        """(row of timing.csv as numbers, picture's path)"""
        picture = self.folder / "picture.exr"
        words = [self.path, "render", str(scene), *VIEW, "--size", size, "--spp", str(spp), "--seed", str(seed), "--quiet",
                 "--no-guiding", "--overwrite", "--threads", self.threads, "--exr-pixels", pixels, "-o", str(picture), *more]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(words)}\n{done.stderr}")
        with open(next(self.folder.glob("*timing*.csv")), newline="") as file:
            row = next(csv.DictReader(file))
        return {k: float(v) for k, v in row.items() if not k.startswith("gaze_")}, picture


def sample_us(row):
    return row["trace_cpu_ms"] * 1000 / row["samples"]


def geometry(program, make, most):
    for power in range(3, most + 1):
        path = make(program.folder / "scene.gltf", 10**power)
        summary = program.scene(path)
        row, _ = program.render(path, "640x360", 16, "--env", "sky")
        yield {"n": summary["triangles_instanced"], "load_s": summary["load_s"], "tree_s": summary["bvh_build_s"],
               "tree_bytes_a_triangle": summary["bvh_bytes"] / summary["triangles_instanced"],
               "peak_mib": summary["peak_memory_mib"], "us_a_sample": sample_us(row),
               "rejected": row["rejected_rays"] + row["non_finite_samples"]}


def lights(program, _most):
    for power in range(6):
        path = generate.lights(program.folder / "scene.gltf", 10**power)
        summary = program.scene(path)
        row, picture = program.render(path, "320x180", 64)
        few = read_exr(picture)
        many = read_exr(program.render(path, "320x180", 1024, seed=2)[1])
        # The median: a mean would be that of the few pixels in which a lamp of less than a pixel is seen.
        error = np.median((few - many) ** 2 / (many**2 + (0.1 * many.mean()) ** 2)) * 64 / (1 + 64 / 1024)
        yield {"n": 10**power, "load_s": summary["load_s"], "tree_s": summary["bvh_build_s"],
               "peak_mib": summary["peak_memory_mib"], "us_a_sample": sample_us(row), "median_error_at_1_spp": error}


def width(program, _most):
    path = generate.unique(program.folder / "scene.gltf", 10**5)
    for n in (1, 4, 16, 64, 256, 1024, 2048, 4096, 8192, 16384):
        row, _ = program.render(path, f"{n}x{max(1, n * 9 // 16)}", 1 if n > 2048 else 4 if n > 64 else 64, "--env", "sky",
                                pixels="half")
        megapixels = row["pixels"] / 1e6
        yield {"n": n, "us_a_sample": sample_us(row), "reconstruct_ms_a_mpx": row["reconstruct_ms"] / megapixels,
               "write_ms_a_mpx": row["write_ms"] / megapixels, "peak_mib": row["peak_memory_mib"],
               "peak_mib_a_mpx": row["peak_memory_mib"] / megapixels}


def spp(program, _most):
    path = generate.unique(program.folder / "scene.gltf", 10**5)
    reference = read_exr(program.render(path, "64x36", 65536, "--env", "sky", seed=2)[1])
    for n in (4**k for k in range(9)):
        row, picture = program.render(path, "64x36", n, "--env", "sky")
        difference = read_exr(picture) - reference
        error = np.sqrt(np.mean(difference**2 / (reference**2 + (0.1 * reference.mean()) ** 2)))
        yield {"n": n, "us_a_sample": sample_us(row), "relative_rms": error,
               "mean_ratio": read_exr(picture).mean() / reference.mean(), "peak_mib": row["peak_memory_mib"]}


CURVES = {
    "triangles": (lambda p, most: geometry(p, generate.unique, most), "unique triangles"),
    "instances": (lambda p, most: geometry(p, generate.instanced, most), "instanced triangles"),
    "lights": (lights, "emissive triangles"),
    "width": (width, "pixels across, 16:9"),
    "spp": (spp, "samples a pixel"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for scale.csv and the plots")
    parser.add_argument("--curves", default=",".join(CURVES))
    parser.add_argument("--most", type=int, default=8, help="power of ten of the most triangles")
    parser.add_argument("--threads", type=int, default=0)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    rows = []
    for name in arguments.curves.split(","):
        make, title = CURVES[name]
        curve = []
        with tempfile.TemporaryDirectory(dir=arguments.out) as scratch:
            for row in make(Program(arguments.program, arguments.threads, pathlib.Path(scratch)), arguments.most):
                if not curve:
                    print(f"\n{title}\n" + "".join(f"{k:>24}" for k in row))
                print("".join(f"{v:24.6g}" for v in row.values()), flush=True)
                curve.append(row)
        rows += [{"curve": name, "quantity": k, "n": r["n"], "value": r[k]} for r in curve for k in r if k != "n"]
        (arguments.out / f"{name}.svg").write_text(plot.log_log(title, curve))
    with open(arguments.out / "scale.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["curve", "quantity", "n", "value"])
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()

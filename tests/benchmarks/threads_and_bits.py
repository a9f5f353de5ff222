#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a second thread is worth, and whether pictures are the same bits: over threads, and over builds. Needs numpy, OpenEXR.

  threads_and_bits.py PROGRAM [OTHER PROGRAM ...] --scene SCENE [--threads 1,2] [--rounds 5] [options of `gazetrace render`]

Runs of all thread counts alternate; `trace` of timing.csv is wall time. Prints per thread count the median microseconds of
wall time per sample, and the efficiency t_1 / (n t_n). Then, for each further program (a portable build, say) against the
first: pixels that differ, the largest difference of a pixel relative to it, and the change of the frame's mean.
"""

import argparse
import csv
import hashlib
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np


def pixels(path):
    import OpenEXR

    channels = OpenEXR.File(str(path)).channels()
    picture = channels["RGB"].pixels if "RGB" in channels else np.dstack([channels[c].pixels for c in "RGB"])
    return np.ascontiguousarray(np.asarray(picture, np.float32)[:, :, :3])


def render(program, scene, extra, threads, folder):
    """(wall microseconds of tracing per sample, picture)"""
    out = folder / "picture.exr"
    words = [program, "render", scene, *extra, "--threads", str(threads), "--exr-pixels", "float", "--quiet", "--overwrite",
             "-o", str(out)]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\n{done.stderr}")
    with open(folder / "picture.timing.csv", newline="") as file:
        row = next(csv.DictReader(file))
    return float(row["trace_ms"]) * 1000 / float(row["samples"]), pixels(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--scene", required=True)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--rounds", type=int, default=5)
    arguments, extra = parser.parse_known_args()
    counts = [int(n) for n in arguments.threads.split(",")]
    times, digests = {n: [] for n in counts}, {n: set() for n in counts}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for _ in range(arguments.rounds):
            for n in counts:
                us, first = render(arguments.programs[0], arguments.scene, extra, n, folder)
                times[n].append(us)
                digests[n].add(hashlib.sha256(first.tobytes()).hexdigest()[:16])
        one = statistics.median(times[counts[0]])
        print(f"{'threads':>8}{'us/sample':>11}{'least':>8}{'most':>8}{'efficiency':>12}  pixels")
        for n in counts:
            median = statistics.median(times[n])
            print(f"{n:8d}{median:11.4f}{min(times[n]):8.4f}{max(times[n]):8.4f}{one * counts[0] / (n * median):12.3f}  "
                  f"{' '.join(sorted(digests[n]))}")
        print("same bits for every thread count" if len(set.union(*digests.values())) == 1 else "PIXELS DIFFER")
        for program in arguments.programs[1:]:
            us, other = render(program, arguments.scene, extra, counts[0], folder)
            differ = np.any(other != first, axis=2)
            relative = np.abs(other.astype(np.float64) - first) / np.maximum(np.abs(first), 1e-12)
            print(f"{program}: {us:.4f} us/sample; {differ.mean():.2%} of the pixels differ, half of these by less than "
                  f"{np.median(relative[differ]) if differ.any() else 0:.2g}, the most by {relative.max():.2g}; mean "
                  f"{other.astype(np.float64).mean() / first.astype(np.float64).mean() - 1:+.2g}")


if __name__ == "__main__":
    main()

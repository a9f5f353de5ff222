#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is a place better where the viewer looks at it than where the viewer looks beside it?

  looked_at.py GAZETRACE SCENE [--size 480x270] [--reference-spp 512] [options of `gazetrace render` ...]

For nine gazes, the frame is rendered with the gaze there and with the gaze 4 degrees beside, and the pixels within 2.6
degrees of the first gaze are measured both times against a uniform reference of another seed. Prints relative MSE and
FLIP of these pixels, their means over the gazes, and how many gazes win.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

# 4 degrees on the 61 degrees of the screen `paper`, as a share of its width: about tan(4) / (2 tan(30.5)).
BESIDE = 0.06
PLACES = [(u, v) for v in (0.3, 0.5, 0.7) for u in (0.3, 0.5, 0.7)]


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stdout


def fovea(program, reference, test, gaze, folder):
    record = folder / "scores.json"
    record.unlink(missing_ok=True)
    run(program, "compare", reference, test, "--metrics", "relmse,flip", "--gaze-at", gaze, "--screen", "paper", "--region-eccentricities", "2.6,8.5",
        "--anyway", "--json", record)
    return [score["regions"]["fovea"] for score in json.loads(record.read_text())["frames"][0]["scores"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--reference-spp", default="512")
    arguments, extra = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        view = [arguments.program, "render", arguments.scene, "--size", arguments.size, "--screen", "paper", "--exposure", "0",
                "--frames", "1", "--quiet", "--overwrite", *extra]
        reference = folder / "reference" / "f.exr"
        run(*view, "--preset", "reference", "--spp", arguments.reference_spp, "--seed", "991", "-o", reference)
        sums = [[0.0, 0.0], [0.0, 0.0]]
        wins = [0, 0]
        for u, v in PLACES:
            scores = []
            for at in (u, u + (BESIDE if u < 0.5 else -BESIDE)):
                test = folder / "test" / "f.exr"
                run(*view, "--gaze-at", f"{at},{v}", "--seed", "5", "-o", test)
                scores.append(fovea(arguments.program, reference, test, f"{u},{v}", folder))
            for k in range(2):
                wins[k] += scores[0][k] <= scores[1][k]
                for m in range(2):
                    sums[m][k] += scores[m][k] / len(PLACES)
            print(f"gaze {u},{v}: relative MSE {scores[0][0]:.5f} looked at, {scores[1][0]:.5f} beside; "
                  f"FLIP {scores[0][1]:.4f}, {scores[1][1]:.4f}", flush=True)
        print(f"mean: relative MSE {sums[0][0]:.5f} looked at, {sums[1][0]:.5f} beside; FLIP {sums[0][1]:.4f}, {sums[1][1]:.4f}; "
              f"better where looked at: {wins[0]} and {wins[1]} of {len(PLACES)} gazes")


if __name__ == "__main__":
    main()

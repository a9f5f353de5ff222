#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What foveation saves and how much of the saving arrives: one uniform and one foveated frame, side by side.

  foveation_efficiency.py GAZETRACE SCENE [--rounds N] [options of `gazetrace render` ...]

Renders the frame with the same rate everywhere (regions of equal rate and 1 x 1 blocks, so that the time of each region
is known) and with the foveated setting, alternately, and reads both timing.csv files. Prints

  stages      wall time of each stage, median over the rounds
  samples     ratio of the samples traced
  speed-up    t_uniform / t_foveated: trace + reconstruct, and end to end
  efficiency  expected / measured time of trace + reconstruct of the foveated frame, where the expected time is its
              samples in each region times what a sample costs the uniform run in that same region
"""

import argparse
import csv
import pathlib
import statistics
import subprocess
import sys
import tempfile

STAGES = ["plan", "trace", "reconstruct", "temporal", "exposure", "color", "write", "total"]
REGIONS = ["fovea", "intermediate", "periphery"]


def render(program, scene, extra, folder, outputs):
    command = [program, "render", scene, *extra, "--quiet", "--overwrite"]
    for suffix in outputs:
        command += ["--output", str(folder / f"frame.####.{suffix}")]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(next(folder.glob("timing*.csv")), newline="") as file:
        row = next(csv.DictReader(file))
    return {key: float(value) for key, value in row.items() if not key.startswith("gaze_")}


def median(rows, key):
    return statistics.median(row[key] for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--samples", default="32,16,8", help="of the three regions, foveated")
    parser.add_argument("--blocks", default="2,4")
    parser.add_argument("--spp", default="32", help="of the uniform frame")
    parser.add_argument("--outputs", default="exr,png", help="file types to write, comma separated")
    arguments, extra = parser.parse_known_args()
    outputs = [suffix for suffix in arguments.outputs.split(",") if suffix]
    uniform_setting = ["--region-samples", ",".join([arguments.spp] * 3), "--region-blocks", "1,1"]
    foveated_setting = ["--region-samples", arguments.samples, "--region-blocks", arguments.blocks]

    uniform, foveated = [], []
    with tempfile.TemporaryDirectory() as name:
        for _ in range(arguments.rounds):
            for rows, setting, label in ((uniform, uniform_setting, "uniform"), (foveated, foveated_setting, "foveated")):
                folder = pathlib.Path(name) / label
                folder.mkdir(exist_ok=True)
                rows.append(render(arguments.program, arguments.scene, setting + extra, folder, outputs))

    print(f"{'':14}{'uniform':>12}{'foveated':>12}{'ratio':>9}")
    for stage in STAGES:
        u, f = median(uniform, stage + "_ms"), median(foveated, stage + "_ms")
        print(f"{stage + ' ms':14}{u:12.1f}{f:12.1f}{u / f if f > 0 else float('nan'):9.2f}")
    samples = uniform[0]["samples"] / foveated[0]["samples"]
    print(f"{'samples':14}{uniform[0]['samples']:12.0f}{foveated[0]['samples']:12.0f}{samples:9.2f}")
    for region in REGIONS:
        cost = [median(rows, f"{region}_cpu_ms") * 1e3 / max(1.0, rows[0][f"{region}_samples"])
                for rows in (uniform, foveated)]
        print(f"{region[:11] + ' us':14}{cost[0]:12.3f}{cost[1]:12.3f}   CPU time per sample")

    efficiencies, traced = [], []
    for u, f in zip(uniform, foveated):
        wall_per_cpu = u["trace_ms"] / u["trace_cpu_ms"]
        expected = sum(f[f"{r}_samples"] * u[f"{r}_cpu_ms"] / max(1.0, u[f"{r}_samples"]) for r in REGIONS)
        measured = f["trace_ms"] + f["reconstruct_ms"]
        efficiencies.append(expected * wall_per_cpu / measured)
        traced.append((u["trace_ms"] + u["reconstruct_ms"]) / measured)
    print(f"speed-up, trace + reconstruct  {statistics.median(traced):.2f}")
    print(f"speed-up, end to end           {median(uniform, 'total_ms') / median(foveated, 'total_ms'):.2f}"
          f"   (writing {' and '.join(outputs) if outputs else 'nothing'})")
    print(f"efficiency                     {100 * statistics.median(efficiencies):.1f} %"
          f"   (rounds: {' '.join(f'{100 * e:.1f}' for e in efficiencies)})")
    pixels = foveated[0]["pixels"] / 1e6
    post = sum(median(foveated, stage + "_ms") for stage in ("exposure", "color", "write"))
    print(f"exposure + color + write       {post / pixels:.0f} ms wall per megapixel")
    return 0


if __name__ == "__main__":
    sys.exit(main())

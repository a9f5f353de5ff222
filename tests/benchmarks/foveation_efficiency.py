#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What foveation saves and how much of the saving arrives: a uniform frame beside foveated ones, in one run.

  foveation_efficiency.py GAZETRACE SCENE --frame 24 [--rounds N] [--before N] [--samples 32,16,8 32,8,4]
                          [--filters linear guided] [--accumulate off window] [options of `gazetrace render` ...]

Renders the frame with the same rate everywhere (regions of equal rate and 1 x 1 blocks, so that the time of each region is
known) and with every combination of the foveated settings, one after another, and reads their timing.csv. Foveated runs
render the two frames before as well (--before), so that there is a past to look up and memory that a run has asked the
system for only once; the frame's own time counts. The uniform frame stands alone: it takes minutes, of which memory is
nothing. Prints a line each:

  samples     how many times less samples were traced than in the uniform frame
  speed-up    t_uniform / t_foveated: guides + trace + reconstruct + accumulate, and end to end
  efficiency  expected / measured time of the same stages of the foveated frame, where the expected time is its samples in
              each region times what a sample costs the uniform frame in that same region; median over the rounds
"""

import argparse
import csv
import itertools
import pathlib
import statistics
import subprocess
import sys
import tempfile

STAGES = ["plan", "guiding", "guides", "trace", "reconstruct", "temporal", "exposure", "color", "write", "total"]
REGIONS = ["fovea", "intermediate", "periphery"]


def render(program, scene, extra, folder, outputs):
    """The last frame's row of timing.csv."""
    folder.mkdir(exist_ok=True)
    command = [program, "render", scene, *extra, "--quiet", "--overwrite"]
    for suffix in outputs:
        command += ["--output", str(folder / f"frame.####.{suffix}")]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    with open(next(folder.glob("*timing*.csv")), newline="") as file:
        row = list(csv.DictReader(file))[-1]
    return {key: float(value) for key, value in row.items() if not key.startswith("gaze_")}


def median(rows, key):
    return statistics.median(row[key] for row in rows)


def rendering_ms(row):
    return row["guiding_ms"] + row["guides_ms"] + row["trace_ms"] + row["reconstruct_ms"] + row["temporal_ms"]


def efficiency(uniform, foveated):
    wall_per_cpu = uniform["trace_ms"] / uniform["trace_cpu_ms"]
    expected = sum(foveated[f"{r}_samples"] * uniform[f"{r}_cpu_ms"] / max(1.0, uniform[f"{r}_samples"]) for r in REGIONS)
    return expected * wall_per_cpu / rendering_ms(foveated)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--frame", type=int, required=True)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--samples", nargs="+", default=["32,16,8"], help="of the three regions, foveated")
    parser.add_argument("--filters", nargs="+", default=["linear"])
    parser.add_argument("--accumulate", nargs="+", default=["off"])
    parser.add_argument("--blocks", default="2,4")
    parser.add_argument("--spp", default="32", help="of the uniform frame")
    parser.add_argument("--before", type=int, default=2, help="frames rendered before a foveated one")
    parser.add_argument("--outputs", default="exr,png", help="file types to write, comma separated")
    arguments, extra = parser.parse_known_args()
    outputs = [suffix for suffix in arguments.outputs.split(",") if suffix]

    settings = {"uniform": ["--region-samples", ",".join([arguments.spp] * 3), "--region-blocks", "1,1",
                            "--frames", str(arguments.frame)]}
    for samples, name, accumulate in itertools.product(arguments.samples, arguments.filters, arguments.accumulate):
        first = arguments.frame - arguments.before
        settings[f"{samples} {name}{'' if accumulate == 'off' else ' ' + accumulate}"] = [
            "--region-samples", samples, "--region-blocks", arguments.blocks, "--filter", name, "--accumulate", accumulate,
            "--frames", f"{first}-{arguments.frame}"]
    rows = {label: [] for label in settings}
    with tempfile.TemporaryDirectory() as name:
        for _ in range(arguments.rounds):
            for label, setting in settings.items():
                folder = pathlib.Path(name) / label.replace(",", "_").replace(" ", "-")
                rows[label].append(render(arguments.program, arguments.scene, setting + extra, folder, outputs))

    print(f"{'median ms':28}" + "".join(f"{stage:>12}" for stage in STAGES))
    for label, measured in rows.items():
        print(f"{label:28}" + "".join(f"{median(measured, stage + '_ms'):12.1f}" for stage in STAGES))
    print(f"\n{'us of CPU time a sample':28}" + "".join(f"{region:>13}" for region in REGIONS))
    for label, measured in rows.items():
        print(f"{label:28}" + "".join(
            f"{median(measured, f'{r}_cpu_ms') * 1e3 / max(1.0, measured[0][f'{r}_samples']):13.3f}" for r in REGIONS))
    print(f"\n{'':28}{'samples':>9}{'rendering':>11}{'end to end':>12}{'efficiency':>12}   rounds")
    uniform = rows.pop("uniform")
    for label, measured in rows.items():
        efficiencies = [100 * efficiency(u, f) for u, f in zip(uniform, measured)]
        print(f"{label:28}{uniform[0]['samples'] / measured[0]['samples']:9.2f}"
              f"{statistics.median(rendering_ms(u) / rendering_ms(f) for u, f in zip(uniform, measured)):11.2f}"
              f"{median(uniform, 'total_ms') / median(measured, 'total_ms'):12.2f}"
              f"{statistics.median(efficiencies):11.1f} %   {' '.join(f'{e:.1f}' for e in efficiencies)}")
    print(f"end to end with {' and '.join(outputs) if outputs else 'nothing'} written")
    return 0


if __name__ == "__main__":
    sys.exit(main())

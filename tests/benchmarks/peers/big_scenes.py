#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A large scene in gazetrace and in Blender's Cycles: how long until the first sample, how much memory, how long a sample.

  big_scenes.py SCENE [--program gazetrace,cycles] --gazetrace build/release/bin/gazetrace --env FILE.hdr
                --eye X,Y,Z --target X,Y,Z --yfov DEG [--size 1920x1080] [--spp 1,5] [--rounds 3]

  load s      wall time of a whole run at 16x9 pixels and 1 sample: start, reading, tree, end
  peak MiB    largest resident size of the run with more samples at --size, picture written
  us          CPU time per sample: difference of the runs with many and few samples, over that in samples

Runs alternate; medians over the rounds. Each program reads the same file and keeps its own idea of its materials.
"""

import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile

import peers


def run(words):
    """(wall s, CPU s, peak MiB) of a process and its children."""
    # A process of its own, so that the peak of children is that of this run.
    probe = ("import resource,subprocess,sys,time\nb=time.monotonic()\n"
             "d=subprocess.run(sys.argv[1:],stdout=subprocess.PIPE,stderr=subprocess.STDOUT,text=True)\n"
             "w=time.monotonic()-b\nu=resource.getrusage(resource.RUSAGE_CHILDREN)\n"
             "print(d.stdout[-2000:] if d.returncode else '',file=sys.stderr)\n"
             "print(w,u.ru_utime+u.ru_stime,u.ru_maxrss/1024)\nsys.exit(d.returncode)")
    done = subprocess.run([sys.executable, "-c", probe, *words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\nfailed:\n{done.stderr}")
    return tuple(map(float, done.stdout.split()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--programs", default="gazetrace,cycles")
    parser.add_argument("--gazetrace", default="build/release/bin/gazetrace")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--env", default="none")
    parser.add_argument("--eye", required=True)
    parser.add_argument("--target", required=True)
    parser.add_argument("--yfov", default="50")
    parser.add_argument("--bounces", type=int, default=3)
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--spp", default="1,5")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    options.materials = "principled"
    view = [f"--env={options.env}", f"--eye={options.eye}", f"--target={options.target}", f"--yfov={options.yfov}"]
    few, many = map(int, options.spp.split(","))
    width, height = map(int, options.size.split("x"))
    programs = options.programs.split(",")
    rows = {p: [] for p in programs}
    with tempfile.TemporaryDirectory() as name:
        out = lambda p: pathlib.Path(name) / f"{p}.exr"
        for r in range(options.rounds):
            for p in programs:
                words = lambda size, spp: peers.command(p, options, options.scene, out(p), size, spp, r, view)
                load, _, _ = run(words("16x9", 1))
                _, low, _ = run(words(options.size, few))
                _, high, peak = run(words(options.size, many))
                rows[p].append((load, peak, (high - low) * 1e6 / (width * height * (many - few))))
    print(f"{options.scene}, {options.size}, {options.rounds} rounds of {few} and {many} spp, {options.bounces} bounces")
    print(f"{'program':12}{'load s':>10}{'peak MiB':>10}{'us':>10}{'least us':>10}{'most us':>10}")
    for p in programs:
        load, peak, us = zip(*rows[p])
        print(f"{p:12}{statistics.median(load):10.2f}{statistics.median(peak):10.0f}{statistics.median(us):10.3f}"
              f"{min(us):10.3f}{max(us):10.3f}")


if __name__ == "__main__":
    main()

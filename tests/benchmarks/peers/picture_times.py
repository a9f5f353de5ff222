# SPDX-License-Identifier: Apache-2.0
"""Pictures of the programs of peers.py, each with the processor time that it took, loading and building apart.

Mitsuba and Cycles load the scene once and are then asked for one picture after the other, since San Miguel takes them a
minute to load, which varies by more than a picture of one sample a pixel takes. gazetrace starts anew for each picture;
its time is what it says of its own stages: learning, the sampling map, tracing, and the means of the pixels. Writing files
counts for Cycles alone, which cannot be asked otherwise: some milliseconds.
"""

import csv
import os
import subprocess
import sys


class Gazetrace:
    """`command(out, spp, seed)` gives the words of one render."""

    def __init__(self, command, folder):
        self.command, self.out = command, folder / "gazetrace" / "picture.exr"
        self.out.parent.mkdir(exist_ok=True)

    def picture(self, spp, seed):
        """(CPU seconds, path of the picture), which the next picture overwrites."""
        words = self.command(self.out, spp, seed)
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(words)}\nfailed:\n{done.stdout[-2000:]}")
        with open(self.out.with_suffix(".timing.csv"), newline="") as file:
            row = next(csv.DictReader(file))
        # Of all but tracing only the wall time is known: as if it had kept all threads busy.
        beside = sum(float(row[stage]) for stage in ("guiding_ms", "plan_ms", "reconstruct_ms")) * len(os.sched_getaffinity(0))
        return (float(row["trace_cpu_ms"]) + beside) / 1000, self.out

    def close(self):
        pass


class Served:
    """A program that was started with --serve: see mitsuba_render.py and cycles_render.py."""

    def __init__(self, words, out):
        self.words, self.out = words, out
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True, bufsize=1)

    def picture(self, spp, seed):
        """(CPU seconds, path of the picture), which the next picture overwrites."""
        self.process.stdin.write(f"{self.out} {spp} {seed}\n")
        said = []
        for line in self.process.stdout:
            if line.startswith("served "):
                return float(line.split()[1]), self.out
            said.append(line)
        sys.exit(f"{' '.join(self.words)}\nended:\n{''.join(said)[-2000:]}")

    def close(self):
        self.process.stdin.close()
        self.process.wait()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From which noise on each event method fails, and whether `gaze events` says so before it does. Logs of `gaze synth`
with their truth, white noise in steps; F1 of fixations and of saccades that overlap those of the truth by more than half
of both together.

  tests/benchmarks/gaze_event_noise.py build/dev/bin/gazetrace [--seconds 40]
"""

import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

RATES_HZ = (60, 300, 1000)
NOISE_DEG = (0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1, 2)
METHODS = ("ivt", "idt", "adaptive")


def events(path, movement):
    with open(path, encoding="utf-8") as file:
        return [(int(row["onset_ns"]), int(row["offset_ns"])) for row in csv.DictReader(file, delimiter="\t") if row["movement"] == movement]


def f1(truth, found):
    """Each event counts once; both lists are in the order of time."""
    hits, used = 0, set()
    for begin, end in truth:
        for k, (other_begin, other_end) in enumerate(found):
            if other_begin > end:
                break
            overlap = min(end, other_end) - max(begin, other_begin)
            union = max(end, other_end) - min(begin, other_begin)
            if k not in used and union > 0 and overlap > 0.5 * union:
                used.add(k)
                hits += 1
                break
    return 2 * hits / max(1, len(truth) + len(found))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seconds", type=int, default=40)
    arguments = parser.parse_args()
    program = str(Path(arguments.program).resolve())
    print("rate Hz | noise SD deg | RMS-S2S deg | " + " | ".join(f"{m}: F1 fixations, saccades, warnings" for m in METHODS))
    with tempfile.TemporaryDirectory() as folder:
        for rate in RATES_HZ:
            for noise in NOISE_DEG:
                subprocess.run([program, "gaze", "synth", "-o", "log.csv", "--truth", "truth.tsv", "--duration", f"{arguments.seconds}s",
                                "--rate", str(rate), "--noise", str(noise), "--overwrite"], cwd=folder, check=True)
                cells = [str(rate), str(noise), f"{2 * noise:g}"]  # white noise in two axes: RMS-S2S is twice its SD in one
                for method in METHODS:
                    result = subprocess.run([program, "gaze", "events", "log.csv", "--method", method, "-o", "events.tsv", "--overwrite"],
                                            cwd=folder, check=True, capture_output=True, text=True)
                    scores = [f1(events(f"{folder}/truth.tsv", m), events(f"{folder}/events.tsv", m)) for m in ("fixation", "saccade")]
                    cells.append(f"{scores[0]:.2f} {scores[1]:.2f} {result.stderr.count(f'events by {method}')}")
                print(" | ".join(cells), flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pursuit beside an independent program, on synthetic gaze whose truth is known.

  python3 -m venv venv && venv/bin/pip install numpy peyes
  venv/bin/python tests/benchmarks/gaze_pursuit_against_peyes.py --gazetrace build/dev/bin/gazetrace

peyes' I-DVT has the constants of ours: it lets its window run over the whole trace and asks for velocity afterwards, ours
takes saccades out first. For every movement a line says how many events each finds, and Cohen's kappa over the samples.
"""

import argparse
import csv
import math
import subprocess
import sys
import tempfile
import warnings

import numpy as np

from gaze_events_against_peers import f1, gazetrace, kappa, labels_of, read_csv

DISTANCE_CM, PIXEL_CM = 65.0, 0.0265
NAMES = {"FIXATION": "fixation", "SACCADE": "saccade", "SMOOTH_PURSUIT": "pursuit"}


def peyes_events(t, azimuth, elevation, dispersion_deg, window_ms):
    from peyes._DataModels.Detector import IDVTDetector
    detector = IDVTDetector(math.nan, 4, 0, dispersion_threshold=dispersion_deg, window_duration=window_ms, saccade_velocity_threshold=70)
    x, y = (np.tan(np.radians(angle)) * DISTANCE_CM / PIXEL_CM for angle in (azimuth, -elevation))
    labels, _ = detector.detect(t * 1e-6, x, y, DISTANCE_CM, PIXEL_CM)
    events = []
    for i, label in enumerate(NAMES.get(getattr(label, "name", ""), "") for label in labels):
        if events and events[-1][0] == label:
            events[-1][2] = int(t[i])
        else:
            events.append([label, int(t[i]), int(t[i])])
    return events


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gazetrace", default="build/dev/bin/gazetrace")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    print("deg/s  noise  preset     movement     ours  peyes  truth   kappa: ours-peyes  ours-truth  peyes-truth   F1: ours-truth")
    for speed, noise in ((15, 0.01), (25, 0.01), (25, 0.05)):
        with tempfile.TemporaryDirectory() as folder:
            log, truth_file = f"{folder}/gaze.csv", f"{folder}/truth.tsv"
            subprocess.run([arguments.gazetrace, "gaze", "synth", "--rate", "500", "--noise", str(noise), "--pursuit-share", "0.5",
                            "--pursuit-speed", str(speed), "--fixation", "600ms", "--duration", "60s", "-o", log, "--truth", truth_file],
                           check=True)
            t, azimuth, elevation = read_csv(log)
            with open(truth_file) as file:
                truth = [(r["movement"], int(r["onset_ns"]), int(r["offset_ns"])) for r in csv.DictReader(file, delimiter="\t")]
            for preset, dispersion_deg, window_ms in (("ivdt", 2.0, 110), ("ivdt-slow", 0.5, 100)):
                found = [gazetrace(arguments.gazetrace, log, preset), peyes_events(t, azimuth, elevation, dispersion_deg, window_ms), truth]
                labels = [labels_of(events, t) for events in found]
                for movement in ("fixation", "pursuit"):
                    is_it = [each == movement for each in labels]
                    events = [[(s, e) for m, s, e in each if m == movement] for each in found]
                    print(f"{speed:5}  {noise:5}  {preset:10} {movement:10} {len(events[0]):6} {len(events[1]):6} {len(events[2]):6}"
                          f"{kappa(is_it[0], is_it[1]):20.3f}{kappa(is_it[0], is_it[2]):12.3f}{kappa(is_it[1], is_it[2]):13.3f}"
                          f"{f1(events[0], events[2]):17.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

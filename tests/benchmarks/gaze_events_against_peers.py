#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Event detection beside independent programs, on real recordings.

  python3 -m venv venv && venv/bin/pip install pymovements remodnav
  venv/bin/python tests/benchmarks/gaze_events_against_peers.py --gazetrace build/dev/bin/gazetrace --samples ../shared/gaze-samples

Each recording is converted to gazetrace CSV first, so that everybody sees the same one gaze; azimuth and elevation are
computed here. For every pair a line says how many samples each puts into a class, Cohen's kappa of the class over the
samples, how many events each finds, and the F1 score of the events, two of which agree when they share at least half of
the longer one's time. `log` is what the recording itself says of its events.
"""

import argparse
import csv
import json
import logging
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

RECORDINGS = ["tobii-studio-tsv/data.tsv", "arff/gaze.arff", "eyelink-asc/bino1000_blinks.asc"]
CLASSES = ["fixation", "saccade", "blink"]


def read_csv(path):
    """Times in ns, azimuth and elevation in degrees, NaN where not usable."""
    preamble = {}
    rows = []
    with open(path) as file:
        for line in file:
            if line.startswith("#"):
                key, *values = line[1:].split()
                preamble[key] = values
            else:
                rows = list(csv.DictReader([line, *file]))
    own = [row for row in rows if row["eye"] == "cyclopean"] or rows
    t = np.array([int(row["t[ns]"]) for row in own])
    usable = np.array([row["valid"] in ("ok", "off_screen", "interpolated") for row in own])
    u, v = (np.array([float(row[c] or "nan") for row in own]) for c in ("u[1]", "v[1]"))
    if "display_mm" in preamble and "distance_mm" in preamble:
        width, height = (float(x) / float(preamble["distance_mm"][0]) for x in preamble["display_mm"])
    elif "display_cm" in preamble:
        distance = float(preamble["distance_cm"][0]) if "distance_cm" in preamble else float(preamble["distance_mm"][0]) / 10
        width, height = (float(x) / distance for x in preamble["display_cm"])
    else:
        width, height = (float(px) / float(density) * math.tan(math.radians(1))
                         for px, density in zip(preamble["display_px"], preamble["pixels_per_degree"]))
    # Where the eye's perpendicular meets the display, from its center, in distances.
    eye = [10 * float(x) / float(preamble["distance_mm"][0]) for x in preamble["eye_cm"]] if "eye_cm" in preamble else (0, 0)
    x, y = (u - 0.5) * width - eye[0], (0.5 - v) * height - eye[1]
    azimuth, elevation = np.degrees(np.arctan2(x, 1)), np.degrees(np.arctan2(y, np.hypot(x, 1)))
    azimuth[~usable], elevation[~usable] = np.nan, np.nan
    return t, azimuth, elevation


def labels_of(events, t):
    labels = np.full(len(t), "", dtype=object)
    for movement, begin, end in events:
        labels[np.searchsorted(t, begin):np.searchsorted(t, end, "right")] = movement
    return labels


def gazetrace(program, log, method):
    text = subprocess.run([program, "gaze", "events", log, "--method", method], check=True, capture_output=True, text=True).stdout
    return [(row["movement"], int(row["onset_ns"]), int(row["offset_ns"]))
            for row in csv.DictReader(text.splitlines(), delimiter="\t")]


def pymovements_events(method, t, azimuth, elevation):
    from pymovements.events.detection import idt, ivt
    positions = np.column_stack([azimuth, elevation])
    # It wants equal steps: samples are counted, at the median rate.
    step_ms = float(np.median(np.diff(t))) * 1e-6
    index = np.arange(len(t))
    if method == "ivt":
        velocities = np.full_like(positions, np.nan)  # over both neighbours, as its "neighbors"
        velocities[1:-1] = (positions[2:] - positions[:-2]) / ((t[2:] - t[:-2]) * 1e-9)[:, None]
        found = ivt(velocities, timesteps=index, minimum_duration=round(60 / step_ms), velocity_threshold=30.0)
    else:
        found = idt(positions, timesteps=index, minimum_duration=round(100 / step_ms), dispersion_threshold=1.0)
    return [("fixation", int(t[row["onset"]]), int(t[row["offset"]])) for row in found.frame.iter_rows(named=True)]


def pymovements_microsaccades(t, azimuth, elevation):
    """Its ellipse and runs, with the velocities and the medians of Engbert & Kliegl 2003."""
    from pymovements.events.detection import microsaccades
    positions = np.column_stack([azimuth, elevation])
    step_s = float(np.median(np.diff(t))) * 1e-9
    velocities = np.full_like(positions, np.nan)
    velocities[2:-2] = (positions[4:] + positions[3:-1] - positions[1:-3] - positions[:-4]) / (6 * step_s)
    seen = velocities[~np.isnan(velocities).any(axis=1)]
    spread = np.sqrt(np.median(seen ** 2, axis=0) - np.median(seen, axis=0) ** 2)
    least = max(3, math.ceil(0.012 / step_s)) - 1  # from the first sample to the last
    found = microsaccades(velocities, timesteps=np.arange(len(t)), minimum_duration=least, threshold=tuple(spread), threshold_factor=6)
    return [("saccade", int(t[row["onset"]]), int(t[row["offset"]])) for row in found.frame.iter_rows(named=True)]


def remodnav_events(t, azimuth, elevation):
    from remodnav import EyegazeClassifier
    rate = 1e9 / float(np.median(np.diff(t)))
    classifier = EyegazeClassifier(px2deg=1.0, sampling_rate=rate)  # places are degrees already
    data = np.rec.fromarrays([azimuth, elevation], names=["x", "y"])
    names = {"FIXA": "fixation", "PURS": "fixation", "SACC": "saccade", "ISAC": "saccade"}
    events = []
    # Its window of 19 ms must be an odd number of samples, three at least.
    window = max(3, 2 * int(0.019 * rate / 2) + 1)
    for event in classifier(classifier.preproc(data, savgol_length=(window + 0.5) / rate)):
        begin, end = (min(int(round(event[k] * rate)), len(t) - 1) for k in ("start_time", "end_time"))
        if event["label"] in names:
            events.append((names[event["label"]], int(t[begin]), int(t[end])))
    return events


def kappa(a, b):
    """Cohen 1960, of two yes-no labellings."""
    agree = np.mean(a == b)
    chance = np.mean(a) * np.mean(b) + (1 - np.mean(a)) * (1 - np.mean(b))
    return (agree - chance) / (1 - chance) if chance < 1 else float("nan")


def f1(a, b):
    agreeing = 0
    for begin, end in a:
        agreeing += any(2 * (min(end, e) - max(begin, s)) >= max(end - begin, e - s) and min(end, e) >= max(begin, s) for s, e in b)
    return 2 * agreeing / (len(a) + len(b)) if a or b else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gazetrace", default="build/dev/bin/gazetrace")
    parser.add_argument("--samples", default="../shared/gaze-samples", type=pathlib.Path)
    parser.add_argument("--json", help="the table for programs")
    arguments = parser.parse_args()
    logging.disable(logging.INFO)
    table = []
    for name in RECORDINGS:
        log = str(arguments.samples / name)
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/gaze.csv"
            subprocess.run([arguments.gazetrace, "gaze", "import", log, "-o", path], check=True, capture_output=True)
            t, azimuth, elevation = read_csv(path)
        found = {method: gazetrace(arguments.gazetrace, log, method) for method in ("ivt", "idt", "adaptive", "log")}
        if not any(movement == "fixation" for movement, _, _ in found["log"]):
            del found["log"]
        found["pymovements ivt"] = pymovements_events("ivt", t, azimuth, elevation)
        found["pymovements idt"] = pymovements_events("idt", t, azimuth, elevation)
        found["remodnav"] = remodnav_events(t, azimuth, elevation)
        if np.median(np.diff(t)) <= 5_100_000:  # the method refuses recordings below 200 Hz
            found["ek"] = [("saccade" if m == "microsaccade" else m, s, e)
                           for m, s, e in gazetrace(arguments.gazetrace, log, "microsaccades")]
            found["pymovements ek"] = pymovements_microsaccades(t, azimuth, elevation)
        pairs = [("ek", "pymovements ek"), ("ivt", "pymovements ivt"), ("idt", "pymovements idt"), ("adaptive", "remodnav"), ("ivt", "remodnav"),
                 ("ivt", "log"), ("idt", "log"), ("adaptive", "log"), ("pymovements ivt", "log"), ("remodnav", "log")]
        print(f"\n{name}: {len(t)} samples, median rate {1e9 / float(np.median(np.diff(t))):.1f} Hz")
        print(f"  {'a':<16}{'b':<17}{'class':<10}{'samples a':>10}{'b':>8}{'kappa':>8}{'events a':>10}{'b':>6}{'F1':>7}")
        for a, b in pairs:
            if a not in found or b not in found:
                continue
            labels = [labels_of(found[k], t) for k in (a, b)]
            for movement in CLASSES:
                is_class = [np.array([label == movement for label in each]) for each in labels]
                events = [[(s, e) for m, s, e in found[k] if m == movement] for k in (a, b)]
                if not events[0] or not events[1]:
                    continue  # one of them does not look for it
                row = dict(recording=name, a=a, b=b, movement=movement, samples_a=int(is_class[0].sum()),
                           samples_b=int(is_class[1].sum()), kappa=kappa(*is_class), events_a=len(events[0]),
                           events_b=len(events[1]), f1=f1(*events))
                table.append(row)
                print(f"  {a:<16}{b:<17}{movement:<10}{row['samples_a']:>10}{row['samples_b']:>8}{row['kappa']:>8.3f}"
                      f"{row['events_a']:>10}{row['events_b']:>6}{row['f1']:>7.3f}")
    if arguments.json:
        pathlib.Path(arguments.json).write_text(json.dumps(table, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

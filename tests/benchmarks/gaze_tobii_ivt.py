#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tobii's I-VT fixation filter, written anew after its description (Olsen, "The Tobii I-VT Fixation Filter", 2012), on an
export of Tobii Studio, beside the fixations and saccades that the export holds. The whole filter first, then with one
step at a time done otherwise: by how much the agreement falls says what that step is worth. Last, gazetrace itself.

  venv/bin/python tests/benchmarks/gaze_tobii_ivt.py ../shared/gaze-samples/tobii-studio-tsv/data.tsv --gazetrace build/dev/bin/gazetrace

Columns: share of the samples with the same label of three, Cohen's kappa of fixations and of saccades, how many
fixations, and the F1 score of fixations, two of which agree when they share at least half of the longer one's time.
"""

import argparse
import csv
import subprocess
import warnings

import numpy as np

MAX_GAP_S = 0.075
THRESHOLD_DEG_S = 30.0
MERGE_GAP_S, MERGE_DEG = 0.075, 0.5
MIN_FIXATION_S = 0.060


class Export:
    """Rows with gaze: places of gaze and eyes in mm of the display, NaN where there is none, and Tobii's own labels."""

    def __init__(self, path):
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.DictReader(file, delimiter="\t") if row["ValidityLeft"]]

        def numbers(names):
            return np.array([[float(row[n]) if row[n] else np.nan for n in names] for row in rows])

        self.t_ns = np.array([int(row["RecordingTimestamp"]) * 1_000_000 for row in rows])
        self.tracker_s = np.array([int(row["EyeTrackerTimestamp"]) * 1e-6 for row in rows])
        flat = np.zeros((len(rows), 1))
        self.gaze = [np.hstack([numbers([f"GazePoint{e}X (ADCSmm)", f"GazePoint{e}Y (ADCSmm)"]), flat]) for e in ("Left", "Right")]
        self.eye = [numbers([f"EyePos{e}{a} (ADCSmm)" for a in "XYZ"]) for e in ("Left", "Right")]
        self.labels = np.array([row["GazeEventType"][0] for row in rows])  # Fixation, Saccade, Unclassified
        index = np.array([int(row["FixationIndex"] or 0) for row in rows])
        self.fixations = [(np.flatnonzero(index == k)[0], np.flatnonzero(index == k)[-1]) for k in range(1, index.max() + 1)]
        self.filter = rows[0]["FixationFilter"]


def filled(places, t, max_gap_s):
    """Straight over gaps between known places at most `max_gap_s` apart."""
    places = places.copy()
    known = np.flatnonzero(~np.isnan(places[:, 0]))
    for a, b in zip(known, known[1:]):
        if b > a + 1 and t[b] - t[a] <= max_gap_s + 1e-9:
            share = ((t[a + 1:b] - t[a]) / (t[b] - t[a]))[:, None]
            places[a + 1:b] = places[a] + share * (places[b] - places[a])
    return places


def angle_deg(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1)))


def mean(arrays):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of nothing
        return np.nanmean(arrays, axis=0)


def ivt(export, per_eye=True, milliseconds=False, fixed_eye=False, merge=True, last_minus_first=False, threshold=THRESHOLD_DEG_S):
    t = export.t_ns * 1e-9 if milliseconds else export.tracker_s
    gap_s = MAX_GAP_S if per_eye else 0
    gaze = mean([filled(g, t, gap_s) for g in export.gaze])
    eye = mean([filled(e, t, gap_s) for e in export.eye])
    if fixed_eye:
        eye = np.broadcast_to(np.nanmedian(eye, axis=0), eye.shape)
    ray = gaze - eye
    if not per_eye:
        ray = filled(ray, t, MAX_GAP_S)
    ray = ray / np.linalg.norm(ray, axis=1)[:, None]
    # 20 ms at 120 Hz: from the sample before to the one after.
    speed = np.full(len(t), np.nan)
    speed[1:-1] = angle_deg(ray[2:], ray[:-2]) / (t[2:] - t[:-2])
    labels = np.where(np.isnan(speed), "U", np.where(speed > threshold, "S", "F"))

    slow = labels == "F"
    borders = np.flatnonzero(np.diff(np.concatenate([[0], slow.astype(int), [0]])))
    runs = [(a, b - 1) for a, b in zip(borders[::2], borders[1::2])]
    labels[slow] = "U"
    step_s = float(np.median(np.diff(t)))
    while merge:  # until nothing is left to merge
        joined = []
        for a, b in runs:
            near = joined and t[a] - t[joined[-1][1]] - step_s <= MERGE_GAP_S
            if near and angle_deg(ray[joined[-1][0]:joined[-1][1] + 1].mean(axis=0), ray[a:b + 1].mean(axis=0)) <= MERGE_DEG:
                joined[-1] = (joined[-1][0], b)
            else:
                joined.append((a, b))
        merge = len(joined) < len(runs)
        runs = joined
    kept = [(a, b) for a, b in runs if t[b] - t[a] + (0 if last_minus_first else step_s) >= MIN_FIXATION_S - 1e-9]
    for a, b in kept:
        labels[a:b + 1] = "F"
    return labels, kept


def gazetrace(export, program, path, eye):
    text = subprocess.run([program, "gaze", "events", path, "--method", "ivt", "--gaze-eye", eye], check=True,
                          capture_output=True, text=True).stdout
    labels = np.full(len(export.t_ns), "U")
    kept = []
    for row in csv.DictReader(text.splitlines(), delimiter="\t"):
        begin = np.searchsorted(export.t_ns, int(row["onset_ns"]))
        end = np.searchsorted(export.t_ns, int(row["offset_ns"]), "right")
        labels[begin:end] = {"fixation": "F", "saccade": "S"}.get(row["movement"], "U")
        if row["movement"] == "fixation":
            kept.append((begin, end - 1))
    return labels, kept


def kappa(a, b):
    agree = np.mean(a == b)
    chance = np.mean(a) * np.mean(b) + (1 - np.mean(a)) * (1 - np.mean(b))
    return (agree - chance) / (1 - chance)


def f1(a, b, t):
    agreeing = sum(any(2 * (min(t[e], t[y]) - max(t[s], t[x])) >= max(t[e] - t[s], t[y] - t[x]) for x, y in b) for s, e in a)
    return 2 * agreeing / (len(a) + len(b))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("export")
    parser.add_argument("--gazetrace", help="the program")
    arguments = parser.parse_args()
    export = Export(arguments.export)
    one_eyed = sum(np.isnan(a[0]) != np.isnan(b[0]) for a, b in zip(*export.gaze))
    print(f"{len(export.labels)} samples, {one_eyed} of them of one eye; {len(export.fixations)} fixations by '{export.filter}'")
    print(f"{'':<52} {'same':>6} {'F kappa':>8} {'S kappa':>8} {'fixations':>10} {'F1':>6}")

    def show(name, result):
        labels, kept = result
        print(f"{name:<52} {np.mean(labels == export.labels):6.3f} {kappa(labels == 'F', export.labels == 'F'):8.3f} "
              f"{kappa(labels == 'S', export.labels == 'S'):8.3f} {len(kept):10} {f1(kept, export.fixations, export.tracker_s):6.3f}")

    show("as described", ivt(export))
    show("gaps are filled after the eyes were joined", ivt(export, per_eye=False))
    show("stamps in whole milliseconds (RecordingTimestamp)", ivt(export, milliseconds=True))
    show("an eye that stays where it is", ivt(export, fixed_eye=True))
    show("nothing merged", ivt(export, merge=False))
    show("durations from the first to the last sample", ivt(export, last_minus_first=True))
    for threshold in (20.0, 40.0):
        show(f"threshold {threshold:.0f} deg/s", ivt(export, threshold=threshold))
    if arguments.gazetrace:
        for eye, name in (("auto", "the tracker's combined gaze"), ("mean", "--gaze-eye mean")):
            show(f"gazetrace, {name}", gazetrace(export, arguments.gazetrace, arguments.export, eye))


if __name__ == "__main__":
    main()

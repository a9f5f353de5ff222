#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far event methods agree: with trackers' own events and with four independent implementations, on every recording
at hand; and how far they reach the truth of synthetic gaze, in noise that grows.

  python3 -m venv venv
  venv/bin/pip install numpy pymovements remodnav I2MC overrides plotly requests liac-arff Levenshtein opencv-python-headless
  venv/bin/pip install --no-deps peyes        # which asks for a plotting library that cannot be installed everywhere
  venv/bin/python tests/benchmarks/gaze_agreement.py build/dev/bin/gazetrace --samples ../shared/gaze-samples [--part peers|noise|pursuit]

Each recording is converted to gazetrace CSV first, so that everybody sees the same one gaze as azimuth and elevation.
Gaze of headsets and glasses is taken in the head, as none of the others knows of head movements.

Kappa is Cohen's (1960), of one class against all others over the samples in which the eye was seen. F1 is 2 m / (a + b)
with m the number of events that match: each event is held against the one of the other side with which it overlaps for
the longest time, and the two match where their intersection is more than half of their union; no event matches twice.

Nobody is the truth here: a tracker's events are those of its own parser. What is measured is called agreement.
"""

import argparse
import csv
import json
import logging
import math
import pathlib
import statistics
import subprocess
import tempfile
import warnings

import numpy as np

SCREEN = ["--screen-px", "1280,1024", "--screen-cm", "38,30.2", "--screen-distance-cm", "68"]
# Files below the folder of samples, or below gazelogs/, with what has to be said to read them.
RECORDINGS = [
    ("eyelink-asc/bino1000.asc", []), ("eyelink-asc/mono500.asc", []), ("eyelink-asc/bino1000_blinks.asc", []),
    ("tobii-studio-tsv/data.tsv", []), ("tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv", []),
    ("tobii-glasses2/livedata.json.gz", ["--frame", "head"]), ("tobii-glasses3/gazedata.gz", ["--frame", "head"]),
    ("pupil-core/gaze_positions.csv", ["--frame", "head"]),
    ("pupil-core/gaze_positions_with_monocular.csv", ["--frame", "head"]),
    ("pupil-invisible-cloud/gaze.csv", ["--frame", "head"]),
    ("pupil-invisible-cloud/trampoline_02_gaze.csv", ["--frame", "head"]),
    ("pupil-neon-native/gaze ps1.raw", ["--frame", "head"]),
    ("smi-iview-txt/recording1_Samples.txt", []), ("arff/gaze.arff", []),
    ("vive-pro-eye/TESTNA01_2D_Fist3.csv", []), ("vive-pro-eye/TESTNA01_360VR_Fist3.csv", []),
    ("vive-pro-eye/TESTVA03_2D_Spread9_header_only.csv", []), ("pico-neo3-pro/boxing_VR.csv", []),
    ("gazebase-vr/gazebase_vr_example.csv", []), ("bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz", []),
    ("bids/rest_eye/sub-01_ses-01_task-rest_run-01_recording-eye1_physio.tsv.gz", []),
    ("plain-csv/gaze-toy-example.csv", SCREEN),
    ("gazelogs/tx300_left.csv", []), ("gazelogs/tx300_right.csv", []), ("gazelogs/fixation_grid.csv", []),
    ("gazelogs/saccades_blinks.csv", []), ("gazelogs/smooth_pursuit.csv", []),
]
DISTANCE_CM, PIXEL_CM = 65.0, 0.0315  # of the plane on which those are given gaze that ask for pixels: 36 px a degree
LEAST_SAMPLES = 200


class Gaze:
    """Times in ns, azimuth and elevation in degrees, NaN where the eye was not seen."""

    def __init__(self, path):
        preamble, rows = {}, []
        with open(path, encoding="utf-8") as file:
            for line in file:
                if line.startswith("#"):
                    key, *values = line[1:].split() or [""]
                    preamble[key] = values
                else:
                    rows = list(csv.DictReader([line, *file]))
        own = [row for row in rows if row["eye"] == "cyclopean"]
        if not own:  # one eye stands for both
            eyes = {row["eye"] for row in rows}
            own = [row for row in rows if row["eye"] == ("left" if "left" in eyes else "right")]
        self.t = np.array([int(row["t[ns]"]) for row in own])
        usable = np.array([row["valid"] in ("ok", "off_screen", "interpolated") for row in own])
        number = lambda name: np.array([float(row[name] or "nan") for row in own])
        if "u[1]" in rows[0]:
            x, y = self.on_plane(number("u[1]"), number("v[1]"), preamble)
            self.azimuth, self.elevation = np.degrees(np.arctan(x)), np.degrees(np.arctan2(y, np.hypot(x, 1)))
        else:
            x, y, z = (number(name) for name in ("dx", "dy", "dz"))
            self.azimuth, self.elevation = np.degrees(np.arctan2(x, -z)), np.degrees(np.arctan2(y, np.hypot(x, z)))
        self.azimuth[~usable], self.elevation[~usable] = np.nan, np.nan
        self.seen = ~np.isnan(self.azimuth)
        # Filters that others begin with cannot begin at a loss.
        runs = np.flatnonzero(np.convolve(self.seen, np.ones(20), "valid") == 20)
        if len(runs):
            kept = slice(runs[0], runs[-1] + 20)
            self.t, self.azimuth, self.elevation, self.seen = (a[kept] for a in (self.t, self.azimuth, self.elevation, self.seen))
        self.step_ns = float(np.median(np.diff(self.t))) if len(self.t) > 1 else math.nan

    @staticmethod
    def on_plane(u, v, preamble):
        value = lambda key: [float(x) for x in preamble[key]]
        if "distance_mm" in preamble and "display_mm" in preamble:
            width, height = (x / value("distance_mm")[0] for x in value("display_mm"))
        else:
            width, height = (px / density * math.tan(math.radians(1))
                             for px, density in zip(value("display_px"), value("pixels_per_degree")))
        eye = [10 * x / value("distance_mm")[0] for x in value("eye_cm")] if "eye_cm" in preamble else (0, 0)
        return (u - 0.5) * width - eye[0], (0.5 - v) * height - eye[1]

    def pixels(self):
        """x to the right and y down on a plane that is so wide that all directions in front of the eye hit it."""
        scale = DISTANCE_CM / PIXEL_CM
        x, y = np.tan(np.radians(self.azimuth)), np.tan(np.radians(self.elevation)) * np.hypot(1, np.tan(np.radians(self.azimuth)))
        return x * scale, -y * scale

    def events_of_labels(self, labels):
        """Runs of equal labels; "" is none."""
        events = []
        for i, label in enumerate(labels):
            if events and events[-1][3] == i - 1 and events[-1][0] == label:
                events[-1][2], events[-1][3] = int(self.t[i]), i
            elif label:
                events.append([label, int(self.t[i]), int(self.t[i]), i])
        return [tuple(event[:3]) for event in events]


def gazetrace(program, log, method, *options):
    """Events, and the number of doubts that detection has of them."""
    result = subprocess.run([program, "gaze", "events", log, "--method", method, "--keep-ids", *options], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        return None, 0
    rows = csv.DictReader(result.stdout.splitlines(), delimiter="\t")
    return ([(row["movement"], int(row["onset_ns"]), int(row["offset_ns"])) for row in rows],
            result.stderr.count(f": events by {method}: "))


def pymovements_events(gaze, method):
    from pymovements.events.detection import idt, ivt
    positions = np.column_stack([gaze.azimuth, gaze.elevation])
    index, step_ms = np.arange(len(gaze.t)), gaze.step_ns * 1e-6  # it wants equal steps: samples are counted
    if method == "ivt":
        velocities = np.full_like(positions, np.nan)
        velocities[1:-1] = (positions[2:] - positions[:-2]) / ((gaze.t[2:] - gaze.t[:-2]) * 1e-9)[:, None]
        found = ivt(velocities, timesteps=index, minimum_duration=max(1, round(60 / step_ms)), velocity_threshold=30.0)
    else:
        found = idt(positions, timesteps=index, minimum_duration=max(2, round(100 / step_ms)), dispersion_threshold=1.0)
    return [("fixation", int(gaze.t[row["onset"]]), int(gaze.t[row["offset"]])) for row in found.frame.iter_rows(named=True)]


def peyes_events(gaze, method):
    from peyes._DataModels import Detector
    detector = {
        "ivt": lambda: Detector.IVTDetector(math.nan, 4, 0, saccade_velocity_threshold=30),
        "idt": lambda: Detector.IDTDetector(math.nan, 4, 0, dispersion_threshold=1.0, window_duration=100),
        "nh": lambda: Detector.NHDetector(math.nan, 4, 0),
        "idvt": lambda: Detector.IDVTDetector(math.nan, 4, 0, dispersion_threshold=2.0, window_duration=110, saccade_velocity_threshold=70),
    }[method]()
    labels, _ = detector.detect((gaze.t - gaze.t[0]) * 1e-6, *gaze.pixels(), DISTANCE_CM, PIXEL_CM)
    names = {"FIXATION": "fixation", "SACCADE": "saccade", "SMOOTH_PURSUIT": "pursuit"}
    return gaze.events_of_labels([names.get(getattr(label, "name", ""), "") for label in labels])


def remodnav_events(gaze):
    from remodnav import EyegazeClassifier
    rate = 1e9 / gaze.step_ns
    classifier = EyegazeClassifier(px2deg=1.0, sampling_rate=rate)  # places are degrees already
    data = np.rec.fromarrays([gaze.azimuth, gaze.elevation], names=["x", "y"])
    window = max(3, 2 * int(0.019 * rate / 2) + 1)  # an odd number of samples, three at least
    names = {"FIXA": "fixation", "PURS": "pursuit", "SACC": "saccade", "ISAC": "saccade"}
    events = []
    for event in classifier(classifier.preproc(data, savgol_length=(window + 0.5) / rate)):
        begin, end = (min(int(round(event[key] * rate)), len(gaze.t) - 1) for key in ("start_time", "end_time"))
        if event["label"] in names:
            events.append((names[event["label"]], int(gaze.t[begin]), int(gaze.t[end])))
    return events


def i2mc_events(gaze):
    import I2MC
    x, y = gaze.pixels()
    far = 4000.0  # the plane in pixels to each side; what lies beside it counts as missing
    missing = -9 * far
    ok = gaze.seen & (abs(x) < far) & (abs(y) < far)
    data = {"time": (gaze.t - gaze.t[0]) * 1e-6, "average_X": np.where(ok, x + far, missing), "average_Y": np.where(ok, y + far, missing)}
    # It asks for a rate that its levels of down-sampling divide: the usual one that is nearest.
    rate = min((30, 50, 60, 90, 100, 120, 200, 250, 300, 400, 500, 1000), key=lambda usual: abs(usual * gaze.step_ns - 1e9))
    options = {"xres": 2 * far, "yres": 2 * far, "freq": rate, "missingx": missing, "missingy": missing,
               "scrSz": [2 * far * PIXEL_CM] * 2, "disttoscreen": DISTANCE_CM}
    if rate < 500:  # its authors: down-sample less, and without the filter, where there are few samples
        options.update(downsamples=[n for n in (2, 3, 5) if rate % n == 0 and rate / n >= 30], downsampFilter=False)
    np.random.seed(1)  # its clusters start at random places
    fixations = I2MC.I2MC(data, options, logging=False)
    fixations = fixations[0] if isinstance(fixations, tuple) else fixations
    if not fixations:
        return []
    at = lambda i: int(gaze.t[min(max(int(i), 0), len(gaze.t) - 1)])
    return [("fixation", at(begin), at(end)) for begin, end in zip(fixations["start"], fixations["end"])]


PEERS = {
    "pymovements I-VT": lambda gaze: pymovements_events(gaze, "ivt"), "peyes I-VT": lambda gaze: peyes_events(gaze, "ivt"),
    "pymovements I-DT": lambda gaze: pymovements_events(gaze, "idt"), "peyes I-DT": lambda gaze: peyes_events(gaze, "idt"),
    "peyes NH": lambda gaze: peyes_events(gaze, "nh"), "REMoDNaV": remodnav_events, "I2MC": i2mc_events,
}
# Who is held against whom: each of our methods against the same method of others, and against two that work otherwise.
PAIRS = {
    "ivt": ["log", "pymovements I-VT", "peyes I-VT", "REMoDNaV", "I2MC"],
    "idt": ["log", "pymovements I-DT", "peyes I-DT", "REMoDNaV", "I2MC"],
    "adaptive": ["log", "peyes NH", "REMoDNaV", "I2MC"],
    "peyes I-VT": ["pymovements I-VT", "REMoDNaV", "I2MC"],
    "peyes I-DT": ["pymovements I-DT"], "peyes NH": ["REMoDNaV", "I2MC"], "I2MC": ["log", "REMoDNaV"],
}
ONLY_FIXATIONS = ("pymovements I-VT", "pymovements I-DT", "I2MC")


def labels_of(events, t, movement):
    labels = np.zeros(len(t), dtype=bool)
    for name, begin, end in events:
        if name == movement:
            labels[np.searchsorted(t, begin):np.searchsorted(t, end, "right")] = True
    return labels


def kappa(a, b):
    agree = np.mean(a == b)
    chance = np.mean(a) * np.mean(b) + (1 - np.mean(a)) * (1 - np.mean(b))
    return (agree - chance) / (1 - chance) if chance < 1 else math.nan


def f1(a, b, movement, step_ns=0.0):
    """Each event holds for one step behind its last sample, so that one of a single sample lasts."""
    a, b = ([(begin, end + step_ns) for name, begin, end in sorted(events, key=lambda e: e[1]) if name == movement] for events in (a, b))
    matches, used, first = 0, set(), 0
    for begin, end in a:
        while first < len(b) and b[first][1] <= begin:
            first += 1
        best, most = None, 0.0
        for k in range(first, len(b)):
            if b[k][0] >= end:
                break
            overlap = min(end, b[k][1]) - max(begin, b[k][0])
            if k not in used and overlap > most:
                best, most = k, overlap
        if best is not None and most > 0.5 * (max(end, b[best][1]) - min(begin, b[best][0])):
            used.add(best)
            matches += 1
    return 2 * matches / (len(a) + len(b)) if a or b else math.nan


def agreement(gaze, a, b, fixations_only):
    """kappa and F1 of fixations, then of saccades. Pursuit counts as fixation where one side knows no pursuit."""
    merged = [[("fixation" if name == "pursuit" else name, *times) for name, *times in events] for events in (a, b)]
    values = []
    for movement in ("fixation", "saccade"):
        if movement == "saccade" and fixations_only:
            values += [math.nan, math.nan]
            continue
        values.append(kappa(*(labels_of(events, gaze.t, movement)[gaze.seen] for events in merged)))
        values.append(f1(*merged, movement, gaze.step_ns))
    return values


def cell(values):
    text = lambda value: "-" if math.isnan(value) else f"{value:.2f}"
    return f"{text(values[0])} {text(values[1])}" if math.isnan(values[2]) and math.isnan(values[3]) else " ".join(map(text, values))


def peers_part(program, samples, table):
    print("Each cell: kappa and F1 of fixations, then, where both know them, kappa and F1 of saccades.\n")
    print("| recording | rate, samples seen | method | fixations, saccades, doubts | " + " | ".join(["its own events", "pymovements", "peyes", "REMoDNaV", "I2MC"]) + " |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    refused, found_by_pair = [], {}
    for name, options in RECORDINGS:
        log = str(pathlib.Path(__file__).parents[2] / name) if name.startswith("gazelogs/") else str(samples / name)
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/gaze.csv"
            result = subprocess.run([program, "gaze", "import", log, "-o", path, "--keep-ids", *options], capture_output=True, text=True, check=False)
            if result.returncode != 0:
                refused.append((name, result.stderr.strip().splitlines()[-1].split(": ", 3)[-1][:150]))
                continue
            gaze = Gaze(path)
            if gaze.seen.sum() < LEAST_SAMPLES:
                refused.append((name, f"{gaze.seen.sum()} samples in which the eye was seen"))
                continue
            found, doubts = {}, {}
            for method in ("ivt", "idt", "adaptive"):
                found[method], doubts[method] = gazetrace(program, path, method, "--device", "desktop")
            found["log"], _ = gazetrace(program, path, "log")
            if not found["log"] or not any(movement == "fixation" for movement, *_ in found["log"]):
                found["log"] = None
            for peer, detect in PEERS.items():
                try:
                    found[peer] = detect(gaze)
                except Exception as problem:  # what a peer cannot do is no failure of the comparison
                    found[peer] = None
                    refused.append((name, f"{peer}: {type(problem).__name__}: {str(problem)[:100]}"))
        values = {}
        for one, others in PAIRS.items():
            for other in others:
                if found.get(one) is not None and found.get(other) is not None:
                    only = one in ONLY_FIXATIONS or other in ONLY_FIXATIONS or \
                        (other == "log" and not any(movement == "saccade" for movement, *_ in found["log"]))
                    values[one, other] = agreement(gaze, found[one], found[other], only)
                    found_by_pair.setdefault((one, other), []).append(values[one, other])
                    table.append({"recording": name, "one": one, "other": other,
                                  **dict(zip(("kappa_fixation", "f1_fixation", "kappa_saccade", "f1_saccade"), values[one, other]))})
        for method in ("ivt", "idt", "adaptive"):
            if found[method] is None:
                continue
            counts = [sum(movement == m for movement, *_ in found[method]) for m in ("fixation", "saccade")]
            kinds = {"ivt": ("pymovements I-VT", "peyes I-VT"), "idt": ("pymovements I-DT", "peyes I-DT"), "adaptive": (None, "peyes NH")}[method]
            columns = [values.get((method, other)) if other else None for other in ("log", *kinds, "REMoDNaV", "I2MC")]
            first = method == "ivt"
            print(f"| {name.split('/')[0] + ': ' + name.split('/')[-1] if first else ''} | "
                  f"{f'{1e9 / gaze.step_ns:.0f} Hz, {gaze.seen.sum()}' if first else ''} | `{method}` | {counts[0]}, {counts[1]}, {doubts[method]} | "
                  + " | ".join(cell(c) if c else "" for c in columns) + " |", flush=True)
    print("\nMedians over the recordings, and over how many:\n")
    print("| one | other | fixations: kappa, F1 | saccades: kappa, F1 | recordings |\n| --- | --- | --- | --- | --- |")
    for (one, other), rows in found_by_pair.items():
        middle = lambda k: statistics.median([row[k] for row in rows if not math.isnan(row[k])] or [math.nan])
        pair = lambda a, b: "" if math.isnan(middle(a)) else f"{middle(a):.2f}, {middle(b):.2f}"
        ours = one in ("ivt", "idt", "adaptive")
        print(f"| {f'`{one}`' if ours else one} | {'the log itself' if other == 'log' else other} | {pair(0, 1)} | {pair(2, 3)} | {len(rows)} |")
    print("\nNot compared:\n")
    for name, why in refused:
        print(f"- {name}: {why}")


NOISE_DEG = (0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1, 2)
FAILS_BELOW, DROPS_BY = 0.9, 0.1


def measured_noise(path):
    """SD and RMS from sample to sample over fixations, by a detrended SD that drift and saccades do not reach: medians of windows."""
    gaze = Gaze(path)
    size = max(4, round(100e6 / gaze.step_ns))
    sds, rms = [], []
    for i in range(0, len(gaze.t) - size, size):
        x, y = gaze.azimuth[i:i + size], gaze.elevation[i:i + size]
        sds.append(math.hypot(np.std(x), np.std(y)))
        rms.append(math.sqrt(np.mean(np.diff(x) ** 2 + np.diff(y) ** 2)))
    return np.median(sds), np.median(rms)


def noise_part(program, seconds, table):
    print("F1 of fixations, of saccades (microsaccades and saccades for `microsaccades`), and the doubts that detection has of its events.\n")
    methods = ("ivt", "idt", "adaptive", "ivdt", "microsaccades")
    print("| rate | noise SD an axis | measured SD, RMS-S2S | " + " | ".join(f"`{m}`" for m in methods) + " |")
    print("| --- | --- | --- |" + " --- |" * len(methods))
    states = {}
    with tempfile.TemporaryDirectory() as folder:
        log, truth_file = f"{folder}/log.csv", f"{folder}/truth.tsv"
        for rate in (60, 300, 1000):
            for noise in NOISE_DEG:
                subprocess.run([program, "gaze", "synth", "-o", log, "--truth", truth_file, "--duration", f"{seconds}s", "--rate", str(rate),
                                "--noise", str(noise), "--overwrite"], check=True, capture_output=True)
                with open(truth_file, encoding="utf-8") as file:
                    truth = [(r["movement"], int(r["onset_ns"]), int(r["offset_ns"])) for r in csv.DictReader(file, delimiter="\t")]
                sd, rms = measured_noise(log)
                cells = []
                for method in methods:
                    found, doubts = gazetrace(program, log, method)
                    if found is None:
                        cells.append("refused")
                        continue
                    found = [("saccade" if movement == "microsaccade" else movement, *times) for movement, *times in found]
                    scores = [f1(truth, found, movement, 1e9 / rate) for movement in ("fixation", "saccade")]
                    cells.append(f"{scores[0]:.2f} {scores[1]:.2f} ({doubts})")
                    states.setdefault((method, rate), []).append((noise, scores[0], doubts))
                    table.append({"rate_hz": rate, "noise_deg": noise, "method": method, "f1_fixation": scores[0], "f1_saccade": scores[1], "doubts": doubts})
                print(f"| {rate} Hz | {noise} | {sd:.3g}, {rms:.3g} | " + " | ".join(cells) + " |", flush=True)
    print(f"\nWhere it fails (F1 of fixations below {FAILS_BELOW} or, where a method does not reach that on clean gaze, {DROPS_BY} below what it\n"
          "reaches there) and where it first says so, standard deviation in degrees:\n")
    print("| method | rate | fails from | says so from | in time |\n| --- | --- | --- | --- | --- |")
    for (method, rate), rows in states.items():
        clean = rows[0][1]
        limit = FAILS_BELOW if clean >= FAILS_BELOW or rows[0][2] else clean - DROPS_BY
        fails = next((noise for noise, score, _ in rows if score < limit), None)
        says = next((noise for noise, _, doubts in rows if doubts), None)
        in_time = fails is None or (says is not None and says <= fails)
        print(f"| `{method}` | {rate} Hz | {fails if fails is not None else 'never'} | {says if says is not None else 'never'} | {'yes' if in_time else 'NO'} |")


def ivdt_of_the_paper(gaze, velocity_deg_s=70.0, dispersion_deg=2.0, window_ms=110.0):
    """I-VDT as Komogortsev & Karpov 2013 describe it, written anew: samples at or above the velocity threshold are saccades and
    leave the trace; a window of the temporal length slides over what is left. Where its dispersion, extent of x plus extent of
    y, is below the threshold it grows until it no longer is, and is a fixation; else its first sample is pursuit and leaves it."""
    x, y, t = gaze.azimuth, gaze.elevation, gaze.t * 1e-9
    speed = np.full(len(t), np.nan)
    speed[1:] = np.hypot(np.diff(x) * np.cos(np.radians(y[1:])), np.diff(y)) / np.diff(t)
    labels = np.full(len(t), "", dtype=object)
    labels[speed >= velocity_deg_s] = "saccade"
    left = np.flatnonzero((labels == "") & gaze.seen)
    begin = 0
    extent = lambda a, b: np.ptp(x[left[a:b]]) + np.ptp(y[left[a:b]])
    while begin < len(left):
        end = begin + 1
        while end < len(left) and t[left[end - 1]] - t[left[begin]] < window_ms * 1e-3:
            end += 1
        if extent(begin, end) >= dispersion_deg:
            labels[left[begin]] = "pursuit"
            begin += 1
            continue
        while end < len(left) and extent(begin, end + 1) < dispersion_deg:
            end += 1
        labels[left[begin:end]] = "fixation"
        begin = end
    return gaze.events_of_labels(labels)


def pursuit_part(program, table):
    print("Kappa of fixation, saccade and pursuit: `ivdt` here beside the method written anew from the paper's description, beside\n"
          "peyes' I-DVT with the same constants, and all three beside the truth (60 s, 500 Hz, half of the fixations follow something).\n")
    print("| pursuit, noise SD | pair | fixation | saccade | pursuit |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        log, truth_file = f"{folder}/log.csv", f"{folder}/truth.tsv"
        for speed, noise in ((25, 0.0), (25, 0.005), (25, 0.01), (25, 0.05), (40, 0.01)):
            subprocess.run([program, "gaze", "synth", "--rate", "500", "--noise", str(noise), "--pursuit-share", "0.5", "--pursuit-speed", str(speed),
                            "--fixation", "600ms", "--duration", "60s", "-o", log, "--truth", truth_file, "--overwrite"], check=True, capture_output=True)
            gaze = Gaze(log)
            with open(truth_file, encoding="utf-8") as file:
                truth = [(r["movement"], int(r["onset_ns"]), int(r["offset_ns"])) for r in csv.DictReader(file, delimiter="\t")]
            found = {"ours": gazetrace(program, log, "ivdt")[0], "the paper's": ivdt_of_the_paper(gaze), "peyes": peyes_events(gaze, "idvt"), "truth": truth}
            for a, b in (("ours", "the paper's"), ("ours", "peyes"), ("the paper's", "peyes"), ("ours", "truth"), ("the paper's", "truth"), ("peyes", "truth")):
                values = [kappa(labels_of(found[a], gaze.t, m), labels_of(found[b], gaze.t, m)) for m in ("fixation", "saccade", "pursuit")]
                table.append({"pursuit_deg_s": speed, "noise_deg": noise, "one": a, "other": b, "kappa": values})
                print(f"| {speed} deg/s, {noise} | {a}, {b} | " + " | ".join(f"{v:.3f}" for v in values) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--samples", default="../shared/gaze-samples", type=pathlib.Path)
    parser.add_argument("--part", choices=["peers", "noise", "pursuit"], help="default: all three")
    parser.add_argument("--seconds", type=int, default=40, help="of each synthetic log with noise")
    parser.add_argument("--json", help="the numbers for programs")
    arguments = parser.parse_args()
    logging.disable(logging.INFO)
    warnings.simplefilter("ignore")
    program = str(pathlib.Path(arguments.program).resolve())
    tables = {"peers": [], "noise": [], "pursuit": []}
    for part, run in (("peers", lambda: peers_part(program, arguments.samples, tables["peers"])),
                      ("noise", lambda: noise_part(program, arguments.seconds, tables["noise"])),
                      ("pursuit", lambda: pursuit_part(program, tables["pursuit"]))):
        if arguments.part in (None, part):
            print(f"\n## {part}\n")
            run()
    if arguments.json:
        pathlib.Path(arguments.json).write_text(json.dumps(tables, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()

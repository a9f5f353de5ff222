# SPDX-License-Identifier: Apache-2.0
"""What a report is made from: results.json of a few runs of the box, rendered and compared here, or of stated scores."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import harness

METRICS = {"flip": "lower", "mse": "lower", "psnr": "higher", "fovvideovdp": "higher"}
BANDS_DEG = [0, 2.6, 5.2, 8.5, 17, 30, 60]
RUNS = [  # id, role, of, label, options
    ("fov", "test", None, "foveated, 32/16/8", []),
    ("uni", "uniform-reference-rate", None, "uniform, 32 spp", ["--sampling", "uniform", "--spp", "32"]),
    ("few", "equal-samples", "fov", "uniform, 2 spp <equal samples>", ["--sampling", "uniform", "--spp", "2"]),
]


def run(folder, *arguments):
    subprocess.run([harness.PROGRAM, *map(str, arguments)], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def around(value, share):
    low, high = sorted((value * (1 - share), value * (1 + share)))
    return {"mean": value, "low": low, "high": high}


def make(folder, size="64x36", frames=3):
    """Writes box.gltf, gaze.csv, the frames of all runs and results.json into `folder`; returns the latter's content."""
    folder = Path(folder)
    (folder / "box.gltf").write_text(json.dumps(harness.box_gltf()))
    (folder / "gaze.csv").write_text(harness.moving_gaze())
    width, height = map(int, size.split("x"))
    common = ["render", "box.gltf", "--gaze", "gaze.csv", "--size", size, "--frames", f"1-{frames}", "--fps", "24", "--quiet", *harness.SCREEN]
    run(folder, *common, "-o", "ref/p.####.exr", "-o", "ref/p.####.png", "--sampling", "uniform", "--spp", "64", "--seed", "9")
    rows = []
    for name, role, of, label, options in RUNS:
        run(folder, *common, "-o", f"{name}/p.####.exr", "-o", f"{name}/p.####.png", "--seed", "1", *options)
        run(folder, "compare", "ref/p.####.exr", f"{name}/p.####.exr", "--metrics", ",".join(METRICS), "--json", f"{name}.json")
        with open(folder / name / "p.timing.csv", newline="") as file:
            timing = list(csv.DictReader(file))
        scores = json.loads((folder / f"{name}.json").read_text())
        seconds = sum(float(row["total_ms"]) for row in timing) / 1000 / frames
        row = {"id": name, "scene": "box", "gaze": "glide", "role": role, "of": of, "label": label, "settings": {"options": " ".join(options)},
               "time_s": {**around(seconds, 0.05), "values": [seconds]}, "samples": sum(int(row["samples"]) for row in timing),
               "spp_mean": sum(int(row["samples"]) for row in timing) / frames / width / height, "rays": None, "peak_mib": None,
               "speed_up": around(1, 0.05), "end_to_end": None, "efficiency": None, "scores": {}, "frames": []}
        for score in scores["sequence"][0]["scores"]:
            parts = {"whole": score["value"], **score["bands"]}
            row["scores"][score["metric"]] = {
                part: {**(around(value, 0.1) if value is not None else {"mean": None, "low": None, "high": None}), "resolved": part != "2.6-5.2"}
                for part, value in parts.items()}
        for index, (times, compared) in enumerate(zip(timing, scores["frames"])):
            row["frames"].append({
                "index": index + 1, "t_s": (index + 0.5) / 24, "time_s": float(times["total_ms"]) / 1000, "event": times["gaze_event"],
                "gaze_px": [width * (0.2 + 0.6 * (index + 0.5) / 24), height / 2], "rings_px": [width / 12, width / 5], "png": f"{name}/p.{index + 1:04}.png",
                "scores": {score["metric"]: score["value"] for score in compared["scores"]}})
        rows.append(row)
    uniform = rows[1]["time_s"]["mean"]
    for row in rows:
        row["speed_up"] = around(uniform / row["time_s"]["mean"], 0.05)
        row["end_to_end"] = (uniform + 0.01) / (row["time_s"]["mean"] + 0.01)
    rows[0]["baselines"] = {"uniform-reference-rate": "uni", "equal-samples": "few"}
    results = {
        "format": "gazetrace-sweep-1", "title": "Box & <glide>", "plan_file": "box.toml", "build": {"version": "0.1.0"}, "machine": {"threads": 2},
        "viewing": {"size_px": [width, height]}, "color": {"view": "ACES SDR"}, "common_settings": {"bounces": 3, "filter": "linear"}, "varied": ["sampling"],
        "bands_deg": BANDS_DEG, "band_pixel_share": {"glide": [0.01, 0.03, 0.05, 0.2, 0.4, 0.31, 0]},
        "metrics": [{"name": name, "unit": "", "better": better, "note": ""} for name, better in METRICS.items()],
        "scenes": [{"name": "box", "reference": {"spp": 64, "seeds": [9], "scramblings": 1, "png": "ref/p.####.png",
                                                 "floor": {"flip": {"whole": rows[1]["scores"]["flip"]["whole"]["mean"] / 2}}}}],
        "rows": rows, "pareto": {"flip": {"box/glide": ["fov", "uni"]}},
        "fixed_quality": [{"metric": "flip", "at": 0.05, "scene": "box", "gaze": "glide", "speed_up": None, "bound": "", "why": "no curve reaches it"}],
        "controls": [{"scene": "box", "gaze": "glide", "metric": "fovvideovdp", "wrong": "mirrored", "right_score": 9.1, "wrong_score": 9.2, "sensitive": False}],
        "notes": ["Intervals of this file are made up; its values are measured."]}
    (folder / "results.json").write_text(json.dumps(results))
    return results


def estimate(mean, low, high, resolved=True):
    return {"mean": mean, "low": low, "high": high, "resolved": resolved}


def row(name, role, flip):
    return {"id": name, "scene": "box", "gaze": "glide", "role": role, "of": None if role == "test" else "t", "label": f"run {name}", "settings": {},
            "time_s": {"mean": 2, "low": 1.9, "high": 2.1}, "samples": 1e6, "spp_mean": None, "rays": None, "peak_mib": None,
            "speed_up": {"mean": 4, "low": 3.8, "high": 4.2}, "efficiency": None, "scores": {"flip": {"whole": flip}}, "frames": []}


def results(*rows):
    return {"format": "gazetrace-sweep-1", "title": "a sweep", "bands_deg": [0, 2.6, 60], "metrics": [{"name": "flip", "better": "lower"}],
            "scenes": [{"name": "box", "reference": {"spp": 64, "floor": {"flip": {"whole": 0.01}}}}], "rows": list(rows)}


if __name__ == "__main__":
    Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
    make(sys.argv[1], *sys.argv[2:3], *map(int, sys.argv[3:4]))

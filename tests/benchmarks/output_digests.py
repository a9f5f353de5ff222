#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a program makes of a fixed set of jobs, so that two builds of it can be held against each other.

  output_digests.py PROGRAM --out FOLDER                     runs every job and writes FOLDER/digests.json
  output_digests.py PROGRAM --out FOLDER --against EARLIER   also compares with EARLIER/digests.json

Pictures are digests of their pixels (oiiotool --hash), never of their headers, which name versions and settings. Texts
are kept whole beside their digests, with times, digests and folders blanked, so that a difference can be read. A change
that moves code and is meant to change nothing shows no difference; whatever it shows is to be explained, line by line.
Needs oiiotool (Debian: openimageio-tools). Jobs on recordings and scenes outside the repository are left out, with a
message, where they are absent.
"""
import argparse
import difflib
import hashlib
import json
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared"
COURTYARD = ["scenes/courtyard/courtyard.gltf", "--env", "scenes/courtyard/dusk.hdr"]
STILL = [*COURTYARD, "--camera", "still", "--screen", "paper", "--size", "160x90", "--exposure", "0"]
GAZE_AT = ["--gaze-at", "0.4,0.55"]
WALK = [*COURTYARD, "--camera", "walk", "--gaze", "gazelogs/tx300_left.csv", "--size", "128x72", "--fps", "10",
        "--frames", "1-3", "--exposure", "auto"]
SMALL = ["--region-samples", "8,4,2"]

# Every job: the options of `render`; {out} is its folder.
RENDERS = {
    "filter-none": [*STILL, *GAZE_AT, *SMALL, "--filter", "none"],
    "filter-linear": [*STILL, *GAZE_AT, *SMALL, "--filter", "linear", "--aov",
                      "albedo,normal,depth,samples,variance,eccentricity", "--map", "{out}/map.####.exr"],
    "filter-guided": [*STILL, *GAZE_AT, *SMALL, "--filter", "guided"],
    "filter-auto": [*STILL, *GAZE_AT, *SMALL],
    "filter-auto-uniform": [*STILL, "--spp", "4"],
    "guided-uniform": [*STILL, "--spp", "2", "--filter", "guided"],
    "preset-paper": [*STILL, *GAZE_AT, "--preset", "paper", "--region-samples", "8,4,2"],
    "preset-default": [*STILL, *GAZE_AT, "--preset", "default"],
    "density-acuity": [*STILL, *GAZE_AT, "--density", "acuity", "--spp", "2", "--filter", "linear"],
    "density-log-polar": [*STILL, *GAZE_AT, "--density", "log-polar"],
    "density-geisler-perry": [*STILL, *GAZE_AT, "--density", "geisler-perry", "--spp", "8"],
    "walk": [*WALK, *SMALL, "--filter", "linear"],
    "walk-guided": [*WALK, *SMALL],
    "accumulate-window": [*WALK, *SMALL, "--accumulate", "window"],
    "accumulate-past": [*WALK, *SMALL, "--accumulate", "window", "--accumulate-future", "0s"],
    "accumulate-at-rest": [*COURTYARD, "--camera", "still", "--gaze", "gazelogs/tx300_left.csv", "--size", "96x54",
                           "--fps", "10", "--frames", "1-4", *SMALL, "--accumulate", "window"],
    "motion-blur": [*WALK, *SMALL, "--shutter", "180deg"],
    "lens": [*STILL, *GAZE_AT, *SMALL, "--aperture", "f/1.4", "--focus-distance", "4"],
    "gaze-linear-latency": [*WALK, *SMALL, "--gaze-mode", "linear", "--gaze-latency", "60ms", "--gaze-process",
                            "median:samples=5"],
    "clamp-roulette-blackman": [*STILL, *GAZE_AT, *SMALL, "--clamp-indirect", "4", "--russian-roulette", "--bounces", "5",
                                "--pixel-filter", "blackman-harris"],
}
OUTSIDE_RENDERS = {
    "sponza": [str(SHARED / "scenes/sponza/Sponza.gltf"), "--env", str(SHARED / "hdri/kiara_1_dawn_1k.hdr"), "--eye",
               "8,2,-0.3", "--target", "-8,3,-0.3", "--yfov", "50", "--size", "160x90", "--screen", "paper", "--exposure",
               "0", *GAZE_AT, *SMALL],
}
PLANS = {
    "plan": [*WALK[:-2], "--json"],
    "plan-text": WALK[:-2],
    "plan-counts": ["--counts", "--gaze-at", "0.3,0.6", "--screen", "paper", "--size", "3840x2160"],
    "plan-counts-model": ["--counts", "--density", "geisler-perry", "--spp", "1", "--gaze-at", "0.3,0.6",
                          "--screen", "paper", "--size", "1280x720"],
}
SWEEP = """title = "Two rates"
[common]
screen = "paper"
size = "64x36"
fps = 24
frames = "1-2"
exposure = "0"
threads = 2
[[scene]]
name = "courtyard"
path = "scenes/courtyard/courtyard.gltf"
environment = "scenes/courtyard/dusk.hdr"
camera = "still"
[[gaze]]
name = "center"
at = [0.5, 0.5]
[grid]
region-samples = [[4, 2, 1], [8, 4, 2]]
filter = ["linear", "guided"]
[reference]
go-on = true
spp = 16
[measure]
repeats = 2
reference-rate = 8
uniform-rates = [1, 4]
baselines = ["uniform-reference-rate", "equal-samples"]
metrics = ["flip", "relmse", "fovvideovdp"]
quality = ["fovvideovdp=8"]
"""


def run(program, words, log, check=True):
    done = subprocess.run([program, *words], cwd=ROOT, capture_output=True, text=True)
    log.append(f"$ gazetrace {' '.join(words)}\n{done.stderr}")
    if check and done.returncode != 0:
        sys.exit(f"exit {done.returncode}: gazetrace {' '.join(words)}\n{done.stderr}")
    return done


def pixels(path):
    text = subprocess.run(["oiiotool", "--hash", str(path)], capture_output=True, text=True, check=True).stdout
    return re.search(r"SHA-1: (\w+)", text)[1]


# What differs from run to run, or from build to build without meaning anything.
BLANK = [(re.compile(r"\b[0-9a-f]{32,64}\b"), "DIGEST"), (re.compile(r"\d+(\.\d+)? (ms|s|MiB)\b"), "TIME"),
         (re.compile(r"(?<=in )\d+\.\d+ ?s"), "TIME")]


def blanked(text, folder):
    text = text.replace(str(folder), "OUT").replace(str(SHARED), "SHARED").replace(str(ROOT), "ROOT")
    for pattern, word in BLANK:
        text = pattern.sub(word, text)
    return text


class Book:
    def __init__(self, folder):
        self.folder = folder
        self.digests = {}
        (folder / "texts").mkdir(parents=True, exist_ok=True)

    def picture(self, name, path):
        self.digests[f"{name}: {path.name}"] = pixels(path)

    def text(self, name, text, exact=False):
        text = text if exact else blanked(text, self.folder)
        self.digests[name] = hashlib.sha1(text.encode()).hexdigest()
        (self.folder / "texts" / (name.replace("/", "_") + ".txt")).write_text(text)


def render_jobs(program, book, jobs):
    for name, words in jobs.items():
        folder = book.folder / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        words = [w.replace("{out}", str(folder)) for w in words]
        run(program, ["render", *words, "-o", f"{folder}/f.####.exr", "-o", f"{folder}/f.####.png", "--seed", "3", "--quiet"],
            [])
        for path in sorted([*folder.glob("*.exr"), *folder.glob("*.png")]):
            book.picture(name, path)


# Columns of timing.csv and of scores that are counted or computed, not timed.
def counted_columns(path):
    lines = path.read_text().splitlines()
    rows = [line.split(",") for line in lines if line and not line.startswith("#")]
    keep = [i for i, word in enumerate(rows[0]) if not re.search(r"_ms|_s$|_ns|mib|time|seconds", word)]
    return "\n".join(",".join(row[i] for i in keep if i < len(row)) for row in rows)


def compare_job(program, book):
    a, b = book.folder / "filter-linear/f.####.exr", book.folder / "filter-auto-uniform/f.####.exr"
    scores = book.folder / "scores.csv"
    run(program, ["compare", str(b), str(a), "--csv", str(scores), "--json", str(book.folder / "scores.json"), "--overwrite",
                  "--maps", str(book.folder / "maps")], [])
    book.text("compare scores", scores.read_text())
    for path in sorted((book.folder / "maps").rglob("*.png")):
        book.picture("compare", path)


def timing_job(book):
    for name in ["walk", "accumulate-window", "density-acuity"]:
        for path in sorted((book.folder / name).glob("*timing*.csv")):
            book.text(f"counts of {name}", counted_columns(path), exact=True)


def sweep_job(program, book):
    plan = book.folder / "two-rates.toml"
    plan.write_text(SWEEP)
    out = book.folder / "sweep"
    shutil.rmtree(out, ignore_errors=True)
    run(program, ["sweep", str(plan), "-o", str(out), "--quiet"], [])
    rows = json.loads((out / "results.json").read_text())

    def scores_of(value, path=""):
        if isinstance(value, dict):
            return [line for key in sorted(value) for line in scores_of(value[key], f"{path}.{key}")]
        if isinstance(value, list):
            return [line for i, item in enumerate(value) for line in scores_of(item, f"{path}[{i}]")]
        return [f"{path} = {value}"] if re.search(r"flip|relmse|fovvideovdp|samples|score", path) else []

    lines = [line for line in scores_of(rows) if not re.search(r"_ms|speed|time|seconds|efficien|per_s|digest|pareto|fixed_quality|sentence|finding", line)]
    book.text("sweep scores", "\n".join(lines))


def gaze_jobs(program, book):
    logs = sorted((ROOT / "gazelogs").glob("*.csv")) + sorted(p for p in (ROOT / "tests/fuzz/seeds").rglob("*")
                                                               if p.is_file() and p.parent.name.startswith("gaze-"))
    logs = [p for p in logs if "truth" not in p.name]
    samples = SHARED / "gaze-samples"
    if samples.is_dir():
        # Folders of recordings are read as a whole.
        logs += [p for p in sorted(samples.rglob("*")) if p.is_file() and p.suffix not in {".md", ".json", ".dtype"}]
        logs += [samples / "pupil-neon-native"]
    else:
        print("recordings outside the repository are absent: left out")
    for path in logs:
        name = str(path.relative_to(ROOT if path.is_relative_to(ROOT) else SHARED))
        out = book.folder / "log.csv"
        out.unlink(missing_ok=True)
        inspected = run(program, ["gaze", "inspect", str(path)], [], check=False)
        book.text(f"inspect {name}", inspected.stdout + inspected.stderr)
        converted = run(program, ["gaze", "import", str(path), "-o", str(out)], [], check=False)
        book.text(f"convert {name}", (out.read_text() if out.exists() else "nothing") , exact=True)
        book.text(f"convert says {name}", converted.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--against", type=pathlib.Path)
    parser.add_argument("--only", choices=["render", "gaze"], help="a part of the jobs")
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    book = Book(options.out.resolve())
    if options.only != "gaze":
        render_jobs(program, book, RENDERS)
        if SHARED.is_dir():
            render_jobs(program, book, OUTSIDE_RENDERS)
        else:
            print("scenes outside the repository are absent: left out")
        for name, words in PLANS.items():
            book.text(name, run(program, ["plan", *words], []).stdout)
        compare_job(program, book)
        timing_job(book)
        sweep_job(program, book)
    if options.only != "render":
        gaze_jobs(program, book)
    (book.folder / "digests.json").write_text(json.dumps(book.digests, indent=1))
    print(f"{len(book.digests)} digests in {book.folder / 'digests.json'}")
    if options.against:
        before = json.loads((options.against / "digests.json").read_text())
        if options.only:
            before = {key: value for key, value in before.items() if key in book.digests}
        differing = sorted(key for key in before.keys() | book.digests.keys() if before.get(key) != book.digests.get(key))
        for key in differing:
            print(f"differs: {key}")
            texts = [folder / "texts" / (key.replace("/", "_") + ".txt") for folder in (options.against, book.folder)]
            if all(t.exists() for t in texts):
                lines = difflib.unified_diff(*(t.read_text().splitlines() for t in texts), lineterm="", n=0)
                for line in list(lines)[2:12]:
                    print("    " + line[:180])
        print(f"{len(differing)} of {len(before)} differ")


if __name__ == "__main__":
    main()

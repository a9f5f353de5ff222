#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The source paper's two figures again, from the folder of a finished sweep of paper.toml, with FLIP as numbers.

    paper_figures.py FOLDER [--gaze center] [--figure-scene sponza] [--out FOLDER]

Writes scenes.png (32/16/8 on every scene) and settings.png (every setting on one scene). A row each: uniform at the
reference rate, foveated, and their FLIP maps against the reference, with mean FLIP and the times under them. Needs Pillow.
"""
import argparse
import json
import pathlib

from PIL import Image, ImageDraw

WIDTH, LABEL = 640, 18


def panel(folder, row, picture):
    """A picture of a row's first frame, or None where the sweep kept none."""
    path = row["frames"][0].get(picture)
    if not path:
        return None
    with Image.open(folder / path) as image:
        return image.convert("RGB").resize((WIDTH, WIDTH * image.height // image.width), Image.LANCZOS)


def score(row, metric):
    found = row["scores"].get(metric, {}).get("whole")
    if not found:
        return "-"
    return f"{found['mean']:.4f}" + ("" if found.get("resolved", True) else " (unresolved)")


def line_of(folder, row, title, uniform):
    time_s = row["time_s"]["mean"]
    ratio = "" if row is uniform else f", {uniform['time_s']['mean'] / time_s:.1f} times faster"
    return [(panel(folder, row, "png"), f"{title}: {row['spp_mean']:.3g} samples a pixel, {time_s:.2f} s{ratio}"),
            (panel(folder, row, "flip_png"), f"FLIP {score(row, 'flip')}, {score(row, 'fovvideovdp')} JOD")]


def sheet(lines, path):
    lines = [[cell for cell in line if cell[0]] for line in lines]
    height = max(picture.height for line in lines for picture, _ in line) + LABEL
    image = Image.new("RGB", (max(map(len, lines)) * WIDTH, len(lines) * height), "white")
    draw = ImageDraw.Draw(image)
    for y, line in enumerate(lines):
        for x, (picture, text) in enumerate(line):
            image.paste(picture, (x * WIDTH, y * height))
            draw.text((x * WIDTH + 4, y * height + height - LABEL + 3), text, fill="black")
    image.save(path)
    print(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--gaze", default="center")
    parser.add_argument("--figure-scene", default="sponza")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("."))
    arguments = parser.parse_args()
    rows = json.loads((arguments.folder / "results.json").read_text())["rows"]
    by_id = {row["id"]: row for row in rows}
    tests = [row for row in rows if row["role"] == "test" and row["gaze"] == arguments.gaze]

    def line(test):
        uniform = by_id[test["baselines"]["uniform-reference-rate"]]
        return (line_of(arguments.folder, uniform, f"{test['scene']}, uniform", uniform)
                + line_of(arguments.folder, test, f"{test['scene']}, {test['label']}", uniform))

    arguments.out.mkdir(parents=True, exist_ok=True)
    sheet([line(t) for t in tests if t["label"] == tests[0]["label"]], arguments.out / "scenes.png")
    sheet([line(t) for t in tests if t["scene"] == arguments.figure_scene], arguments.out / "settings.png")


if __name__ == "__main__":
    main()

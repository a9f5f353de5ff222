# SPDX-License-Identifier: Apache-2.0
"""Scenes of other programs through `gazetrace import`, against the same scene as glTF: cameras, the light of a patch, and what
the command says is lost.

    python3 tests/benchmarks/imports.py --program build/release/bin/gazetrace --bpy PYTHON --others PYTHON [--folder DIR]

PYTHON has bpy, and usd-core and trimesh; assimp's program is on the PATH. The scene is that of tests/blender/files.py: a box with
a texture on a floor, a camera that moves for five frames, and a panel of light or a constant sky. Prints a table.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/cli"))
from exr_reader import Exr  # noqa: E402  a reader of the tests' own

ABOVE = ["--env", "constant:1,1,1"]
EYE = [*ABOVE, "--eye", "3,2,3", "--target", "0,0.5,0"]
NONE = ["--env", "none"]
# What a file states that differs from the scene of its name: USD has the gloss of its surfaces' index of refraction, and Blender
# writes a temperature for every light.
SAME = {"lit.usdc": "warm.glb", "others.usda": "gloss.glb", "others.usdz": "gloss.glb"}
# Assimp writes metres as FBX's centimetres, and keys a thousand times later.
SMALL = {"coloured.assimp.fbx": [*ABOVE, "--eye", "0.03,0.02,0.03", "--target", "0,0.005,0"]}
# File, who wrote it, options of both renders.
FILES = [("lit.blend", "bpy", NONE), ("lit.usdc", "bpy", NONE), ("others.usda", "usd-core", NONE), ("others.usdz", "usd-core", NONE),
         ("coloured.fbx", "bpy", ABOVE), ("coloured.assimp.fbx", "assimp", ABOVE), ("bare.abc", "bpy", ABOVE),
         ("coloured.obj", "bpy", EYE), ("coloured.trimesh.obj", "trimesh", EYE), ("coloured.assimp.obj", "assimp", EYE),
         ("bare.ply", "bpy", EYE), ("bare.trimesh.ply", "trimesh", EYE), ("bare.stl", "bpy", EYE)]
# Blender's exporter has frame f at f / 24 s, and an import has it in the middle of the video's frame f.
START = ["--start", "20833333ns", "--camera-extrapolation", "hold"]


class Runs:
    def __init__(self, arguments, folder):
        self.folder, self.program = folder, str(arguments.program.resolve())
        self.environment = {**os.environ, "GAZETRACE_BPY_PYTHON": str(arguments.bpy)}
        self.environment.pop("GAZETRACE_IMPORT_TRIED", None)

    def run(self, *words):
        done = subprocess.run([self.program, *words], cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: {done.stderr.strip().splitlines()[-1:]}")
        return done.stdout

    def cameras(self, scene, *options):
        told = self.run("plan", scene, "--size", "64x36", "--fps", "24", "--frames", "1-5", *options, "--json", "-")
        return [frame["camera"] for frame in json.loads(told)["frames"]]

    def patch(self, scene, *options):
        """The mean light of a patch in the middle, and its standard error, for red, green and blue, by two renders."""
        pictures = []
        for seed in ("1", "2"):
            self.run("render", scene, "-o", "patch.exr", "--overwrite", "--size", "64x36", "--fps", "24", "--frames", "2", "--spp", "64",
                     "--exr-compression", "zip", "--sampling", "uniform", "--filter", "none", "--accumulate", "off", "--diffuse", "lambert", "--seed", seed, "--quiet",
                     *options)
            exr = Exr(self.folder / "patch.exr")
            pictures.append({name: [value for row in exr.channel(name)[10:26] for value in row[20:44]] for name in "RGB"})
        a, b = pictures
        return {name: (math.fsum(a[name] + b[name]) / 2 / len(a[name]),
                       math.sqrt(math.fsum((x - y) ** 2 for x, y in zip(a[name], b[name]))) / 2 / len(a[name])) for name in "RGB"}


def angle_deg(a, b):
    """Between two orientations."""
    return math.degrees(2 * math.acos(min(1, abs(math.fsum(x * y for x, y in zip(a, b))))))


def row(runs, name, by, options):
    told = json.loads(runs.run("import", name, "-o", "import.glb", "--overwrite", "--json", "-"))
    same = SAME.get(name, f"{name.partition('.')[0]}.glb")
    camera = "given"
    if "--eye" not in options:
        if not told["cameras"]:
            camera, options = "none", [*EYE]
        else:
            pairs = list(zip(runs.cameras("import.glb"), runs.cameras(same, *START), strict=True))
            far = max(math.dist(a["position_m"], b["position_m"]) for a, b in pairs) * 1000
            turned = max(angle_deg(a["orientation_xyzw"], b["orientation_xyzw"]) for a, b in pairs)
            wide = max(abs(a["yfov_deg"] - b["yfov_deg"]) for a, b in pairs)
            camera = f"{far:.3f} mm, {turned:.4f} deg, {wide:.4f} deg"
    ours, theirs = runs.patch("import.glb", *SMALL.get(name, options)), runs.patch(same, *options, *START)
    ratios = [f"{ours[name][0] / theirs[name][0]:.4f}" for name in "RGB"]
    error = max(math.hypot(ours[name][1], theirs[name][1]) / theirs[name][0] for name in "RGB")
    worst = max(abs(ours[name][0] - theirs[name][0]) / math.hypot(ours[name][1], theirs[name][1]) for name in "RGB")
    return f"| {name} | {by} | {camera} | {' '.join(ratios)} | {error:.4f} | {worst:.1f} | {' '.join(told['lost']) or 'nothing'} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--bpy", required=True, help="a Python with bpy")
    parser.add_argument("--others", required=True, help="a Python with usd-core and trimesh")
    parser.add_argument("--folder", type=Path, help="keeps the files")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gazetrace_imports_") as made:
        folder = (arguments.folder or Path(made)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run([arguments.bpy, "-B", ROOT / "tests/blender/files.py", folder], check=True, capture_output=True)
        subprocess.run([arguments.others, "-B", ROOT / "tests/blender/files_of_others.py", folder], check=True)
        runs = Runs(arguments, folder)
        print("| file | by | camera: place, direction, field | patch: R G B over glTF's | error | in errors | lost |")
        print("| --- | --- | --- | --- | --- | --- | --- |")
        for name, by, options in FILES:
            if (folder / name).exists():
                try:
                    print(row(runs, name, by, options), flush=True)
                except RuntimeError as problem:
                    print(f"| {name} | {by} | {problem} |", flush=True)


if __name__ == "__main__":
    main()

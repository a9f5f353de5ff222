#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes tests/data/mitsuba: small scenes and the window means that Mitsuba 3 renders from them, for a test without Mitsuba.

  write_mitsuba_reference.py [--out tests/data/mitsuba]

Every number comes from Mitsuba; gazetrace takes no part.
"""

import argparse
import base64
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import matched_scenes

SIZE, WINDOW, SPP, SEEDS, FIRST_SEED, BOUNCES = 32, 16, 1024, 12, 7000, 6
HERE = pathlib.Path(__file__).parent


def write_sky(path):
    """A lat-long sky of 32 x 16 pixels with a sun, as a flat Radiance picture: both programs read the same bytes."""
    height, width = 16, 32
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    up = np.cos(np.pi * v)
    rgb = np.stack([0.35 + 0.25 * up, 0.5 + 0.2 * up, 0.6 + 0.4 * up], -1) * (1 + 0.4 * np.cos(2 * np.pi * u))[..., None]
    rgb[3:5, 9:11] = (14, 12, 9)
    exponent = np.ceil(np.log2(rgb.max(-1) * 256 / 255)).astype(int)
    mantissa = np.round(rgb * np.exp2(8.0 - exponent)[..., None]).clip(0, 255)
    texels = np.concatenate([mantissa, (exponent + 128)[..., None]], -1).astype(np.uint8)
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    path.write_bytes(header.encode() + texels.tobytes())


def embed(path):
    """Moves the buffer of a glTF file into it."""
    document = json.loads(path.read_text())
    binary = path.with_suffix(".bin")
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary.read_bytes()).decode()
    binary.unlink()
    path.write_text(json.dumps(document, separators=(",", ":")) + "\n")


def render(scene, view, materials, scratch):
    out = pathlib.Path(scratch) / "out.npy"
    words = [sys.executable, str(HERE / "mitsuba_render.py"), str(scene), str(out), "--variant", "llvm_ad_rgb", "--size",
             f"{SIZE}x{SIZE}", "--spp", str(SPP), "--seed", str(FIRST_SEED), "--seeds", str(SEEDS), "--bounces",
             str(BOUNCES), "--materials", materials, "--matched", *view]
    subprocess.run(words, check=True)
    cut = np.load(out).astype(np.float64).reshape(SEEDS, SIZE // WINDOW, WINDOW, SIZE // WINDOW, WINDOW, 3)
    return cut.mean((2, 4)).reshape(SEEDS, -1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default=str(HERE.parents[1] / "data" / "mitsuba"))
    folder = pathlib.Path(parser.parse_args().out)
    folder.mkdir(parents=True, exist_ok=True)
    sky = folder / "sky.hdr"
    write_sky(sky)
    scenes = [("matte", matched_scenes.cornell(folder)), ("matte", matched_scenes.punctual(folder)),
              ("gltf", matched_scenes.slab(folder, str(sky))),
              ("gltf", matched_scenes.ball_on_floor(folder, str(sky), 1, 0.35)),
              ("gltf", matched_scenes.ball_on_floor(folder, str(sky), 0, 0.45))]
    entries = []
    with tempfile.TemporaryDirectory() as scratch:
        for materials, (path, view) in scenes:
            embed(pathlib.Path(path))
            option = dict(word[2:].split("=", 1) for word in view)
            means = render(path, view, materials, scratch)
            triple = lambda text: [float(x) for x in text.split(",")]
            entries.append({
                "file": pathlib.Path(path).name, "materials": materials, "bounces": BOUNCES, "eye": triple(option["eye"]),
                "target": triple(option["target"]), "yfov_deg": float(option["yfov"]),
                "environment": None if option["env"] == "none" else sky.name,
                "mean": [float(f"{x:.7g}") for x in means.mean(0)],
                "standard_error": [float(f"{x:.4g}") for x in means.std(0, ddof=1) / math.sqrt(SEEDS)]})
            print(pathlib.Path(path).name, "largest relative standard error",
                  f"{(means.std(0, ddof=1) / math.sqrt(SEEDS) / means.mean(0)).max():.5f}", flush=True)
    import drjit
    import mitsuba

    reference = {
        "written_by": "tests/benchmarks/peers/write_mitsuba_reference.py",
        "mitsuba": mitsuba.__version__, "drjit": drjit.__version__, "variant": "llvm_ad_rgb", "spp": SPP, "seeds": SEEDS,
        "first_seed": FIRST_SEED, "size_px": SIZE, "window_px": WINDOW, "order": "window by window, row by row: r, g, b",
        "scenes": entries}
    (folder / "reference.json").write_text(json.dumps(reference, indent=1) + "\n")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do gazetrace and Mitsuba 3 compute the same light? Window means of independent renders, tested at one family-wise level.

  compare_with_mitsuba.py --gazetrace build/release/bin/gazetrace --sponza Sponza.gltf --env FILE.hdr

Each scene is rendered several times with other random numbers by both. A picture is cut into windows of 32 x 32 pixels; per window and channel
Welch's t over the repeats asks whether the means differ. Where the models coincide, no window may be significant at the
family-wise level of 1e-3 (Holm) over all its windows; a scene whose models differ shows by how much instead.

Prints per scene: the ratio of the whole pictures' means with its standard error, windows tested, the smallest Holm-adjusted
p, the largest difference of a window relative to the picture's mean, and the verdict. Then, where the models differ, the
ratio per ball beside the one that the models' directional albedos predict (predicted_ratio.py); and an absorbing pane of
glass beside the closed form. Exit code 1 if a scene of coinciding models differs.
"""

import argparse
import dataclasses
import math
import pathlib
import sys
import tempfile
import types

import numpy as np
import scipy.stats

import matched_scenes
import predicted_ratio
from peers import command, read_picture, run_words

LEVEL = 1e-3
WINDOW = 32
TINTS = {1: (0.95, 0.64, 0.54), 0: (0.2, 0.4, 0.6)}


@dataclasses.dataclass
class Case:
    """A scene to compare. `materials` is mitsuba_render.py's; `ours` and `theirs` are options for one program alone."""

    name: str
    materials: str
    coincide: bool
    made: tuple  # (file, view options)
    ours: tuple = ()
    theirs: tuple = ()


def windows(picture):
    height, width = (n // WINDOW * WINDOW for n in picture.shape[:2])
    cut = picture[:height, :width].reshape(height // WINDOW, WINDOW, width // WINDOW, WINDOW, 3)
    return cut.mean((1, 3)).reshape(-1)


def compare(ours, theirs):
    """Arrays (seed, window). Smallest Holm-adjusted p, number of windows with light."""
    lit = (ours.std(0) + theirs.std(0) > 0) | (ours.mean(0) != theirs.mean(0))
    p = scipy.stats.ttest_ind(ours[:, lit], theirs[:, lit], equal_var=False).pvalue
    order = np.sort(p)
    return float(np.min(order * np.arange(len(order), 0, -1))), len(order)


def ratio_of_means(a, b):
    """(ratio, standard error) from one mean a seed."""
    ratio = a.mean() / b.mean()
    return ratio, ratio * math.hypot(a.std(ddof=1) / a.mean(), b.std(ddof=1) / b.mean()) / math.sqrt(len(a))


def render_both(case, arguments, folder, size=None, spp=None):
    """Two arrays (seed, y, x, rgb)."""
    path, view = case.made
    options = types.SimpleNamespace(gazetrace=arguments.gazetrace, mitsuba_python=arguments.mitsuba_python,
                                    materials=case.materials, bounces=arguments.bounces)
    size, spp = size or arguments.size, spp or arguments.spp
    # All repeats in one process each, so that scenes are loaded and kernels compiled once: a frame's number seeds its
    # samples as --seed does.
    frames = [folder / f"gazetrace.{i + 1:04d}.exr" for i in range(arguments.seeds)]
    words = command("gazetrace", options, path, folder / "gazetrace.####.exr", size, spp, 100, [*view, *case.ours])
    run_words([*words, "--frames", f"1-{arguments.seeds}"], frames[-1])
    out = folder / "mitsuba.npy"
    words = command("mitsuba-llvm", options, path, out, size, spp, 100, [*view, *case.theirs])
    run_words([*words, "--seeds", str(arguments.seeds)], out)
    return np.stack([read_picture(frame) for frame in frames]), read_picture(out)


def cases(arguments, folder):
    made = [Case("cornell", "matte", True, matched_scenes.cornell(folder)),
            Case("punctual", "matte", True, matched_scenes.punctual(folder))]
    if arguments.env:
        env = arguments.env
        if arguments.sponza:
            view = ["--eye=8,2,-0.3", "--target=-8,3,-0.3", "--yfov=50", f"--env={env}"]
            full = ("--pixel-cone=0", "--bounce-cone=0")
            scene = (arguments.sponza, view)
            made += [Case("sponza", "matte", True, scene, ours=full),
                     Case("sponza, mip", "matte", False, scene),
                     Case("sponza, stock", "matte", False, scene, ours=full,
                          theirs=("--own-environment", "--own-masks", "--own-normals"))]
        made += [Case("conductors", "gltf", True, matched_scenes.balls(folder, env, 1)),
                 Case("dielectrics", "gltf", True, matched_scenes.balls(folder, env, 0)),
                 Case("glass", "gltf", True, matched_scenes.glass_balls(folder, env, 0.0)),
                 Case("slab", "gltf", True, matched_scenes.slab(folder, env)),
                 Case("rough glass", "gltf", True, matched_scenes.glass_balls(folder, env, 0.4)),
                 Case("stock glass", "principled", False, matched_scenes.glass_balls(folder, env, 0.4))]
    return made


def compare_scenes(arguments, folder):
    print(f"{arguments.size}, {arguments.spp} spp, {arguments.seeds} seeds, {arguments.bounces} bounces")
    print(f"{'scene':15}{'materials':>10}{'ratio':>9}{'+-':>8}{'windows':>9}{'least p':>10}{'largest':>9}  verdict")
    failed = False
    for case in cases(arguments, folder):
        if arguments.only and case.name not in arguments.only.split(";"):
            continue
        ours, theirs = render_both(case, arguments, folder)
        ratio, error = ratio_of_means(ours.mean((1, 2, 3)), theirs.mean((1, 2, 3)))
        ours_w, theirs_w = np.stack([windows(x) for x in ours]), np.stack([windows(x) for x in theirs])
        p, count = compare(ours_w, theirs_w)
        largest = np.max(np.abs(ours_w.mean(0) - theirs_w.mean(0))) / theirs.mean()
        differs = p < LEVEL
        failed |= case.coincide and differs
        verdict = "differ" if differs else "no difference found"
        verdict += "" if case.coincide else " (models differ)"
        print(f"{case.name:15}{case.materials:>10}{ratio:9.5f}{error:8.5f}{count:9d}{p:10.2g}{largest:9.4f}  {verdict}",
              flush=True)
        if arguments.keep:
            np.save(pathlib.Path(arguments.keep) / f"{case.name}_gazetrace.npy", ours.mean(0))
            np.save(pathlib.Path(arguments.keep) / f"{case.name}_mitsuba.npy", theirs.mean(0))
    return failed


def compare_balls(arguments, folder):
    size = 64
    mask, _ = predicted_ratio.inner_cosines(size)
    print("\na ball in even light: gazetrace over Mitsuba's principled (green)")
    print(f"{'metallic':>8}{'roughness':>10}{'measured':>10}{'+-':>9}{'predicted':>10}{'ours':>9}{'predicted':>10}")
    for metallic, tint in TINTS.items():
        for roughness in (0.1, 0.25, 0.5, 0.75, 1.0):
            case = Case("ball", "principled", False, matched_scenes.one_ball(folder, metallic, roughness, tint))
            ours, theirs = (x[:, mask, 1].mean(1) for x in render_both(case, arguments, folder, f"{size}x{size}", 64))
            ratio, error = ratio_of_means(ours, theirs)
            a, b = predicted_ratio.predicted(metallic, roughness, tint, size)
            print(f"{metallic:8d}{roughness:10.2f}{ratio:10.5f}{error:9.5f}{a[1] / b[1]:10.5f}{ours.mean():9.5f}{a[1]:10.5f}",
                  flush=True)


def compare_slab(arguments, folder):
    """True where either program is off the closed form by more than 1e-3 of it."""
    case = Case("pane", "gltf", True, matched_scenes.slab_in_front_of_light(folder))
    ours, theirs = render_both(case, arguments, folder, "32x32", 256)
    exact = matched_scenes.slab_transmittance(arguments.bounces)
    print("\nan absorbing pane at normal incidence, rgb")
    rgb = lambda v: "  ".join(f"{x:.5f}" for x in v)
    error = lambda x: x.mean((1, 2)).std(0, ddof=1) / math.sqrt(len(x))
    print(f"closed form  {rgb(exact)}")
    for name, pictures in (("gazetrace", ours), ("Mitsuba", theirs)):
        print(f"{name:11}  {rgb(pictures.mean((0, 1, 2)))}  +-  {rgb(error(pictures))}")
    off = lambda x: np.abs(x.mean((0, 1, 2)) - exact) > 1e-3 * exact + 4 * error(x)
    return bool(off(ours).any() or off(theirs).any())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gazetrace", default="build/release/bin/gazetrace")
    parser.add_argument("--mitsuba-python", default=sys.executable)
    parser.add_argument("--sponza")
    parser.add_argument("--env", help="lat-long picture")
    parser.add_argument("--size", default="256x256")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--bounces", type=int, default=6)
    parser.add_argument("--only", help="names of scenes, semicolon separated; balls and pane are names, too")
    parser.add_argument("--keep", help="folder for the mean pictures, as .npy")
    arguments = parser.parse_args()
    wanted = lambda name: not arguments.only or name in arguments.only.split(";")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        failed = compare_scenes(arguments, folder)
        if wanted("balls"):
            compare_balls(arguments, folder)
        if wanted("pane"):
            failed |= compare_slab(arguments, folder)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

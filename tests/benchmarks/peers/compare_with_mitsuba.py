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
import concurrent.futures
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


class Renders:
    """Pictures by either program, each made once: an array (repeat, y, x, rgb)."""

    def __init__(self, arguments, folder):
        self.arguments, self.folder, self.done = arguments, folder, {}

    def both(self, case, size=None, spp=None):
        size, spp = size or self.arguments.size, spp or self.arguments.spp
        path, view = case.made
        # gazetrace knows its own model alone, whichever Mitsuba is asked for.
        model = "matte" if case.materials == "matte" else "gltf"
        keys = [("gazetrace", path, (*view, *case.ours), model, size, spp),
                ("mitsuba-llvm", path, (*view, *case.theirs), case.materials, size, spp)]
        with concurrent.futures.ThreadPoolExecutor() as both:
            return tuple(both.map(lambda key: self._once(*key), keys))

    def _once(self, *key):
        if key not in self.done:
            self.done[key] = self._render(*key)
        return self.done[key]

    def _render(self, program, path, view, materials, size, spp):
        options = types.SimpleNamespace(gazetrace=self.arguments.gazetrace, materials=materials,
                                        mitsuba_python=self.arguments.mitsuba_python, bounces=self.arguments.bounces)
        # All repeats in one process, so that scenes are loaded and kernels compiled once: a frame's number seeds its
        # samples as --seed does.
        n = self.arguments.seeds
        if program == "gazetrace":
            frames = [self.folder / f"gazetrace.{i + 1:04d}.exr" for i in range(n)]
            words = command(program, options, path, self.folder / "gazetrace.####.exr", size, spp, 100, view)
            run_words([*words, "--frames", f"1-{n}"], frames[-1])
            return np.stack([read_picture(frame) for frame in frames])
        out = self.folder / "mitsuba.npy"
        more = ["--matched", "--seeds", str(n), "--sampler", self.arguments.sampler]
        run_words([*command(program, options, path, out, size, spp, 100, view), *more], out)
        return read_picture(out)


def cases(arguments, folder):
    made = [Case("cornell", "matte", True, matched_scenes.cornell(folder)),
            Case("punctual", "matte", True, matched_scenes.punctual(folder))]
    if arguments.env:
        env = arguments.env
        made += [Case("conductors", "gltf", True, matched_scenes.balls(folder, env, 1)),
                 Case("dielectrics", "gltf", True, matched_scenes.balls(folder, env, 0)),
                 Case("glass", "gltf", True, matched_scenes.glass_balls(folder, env, 0.0)),
                 Case("slab", "gltf", True, matched_scenes.slab(folder, env)),
                 Case("rough glass", "gltf", True, matched_scenes.glass_balls(folder, env, 0.4)),
                 Case("stock glass", "principled", False, matched_scenes.glass_balls(folder, env, 0.4))]
        if arguments.sponza:
            view = ["--eye=8,2,-0.3", "--target=-8,3,-0.3", "--yfov=50", f"--env={env}"]
            scene = (matched_scenes.without_normal_maps(arguments.sponza, folder), view)
            made += [Case("sponza", "matte", True, scene),
                     # What each rule is worth: gazetrace's normal maps, Mitsuba's own ways.
                     Case("own masks", "matte", False, scene, theirs=("--own-masks",)),
                     Case("normal maps", "matte", False, (arguments.sponza, view)),
                     Case("own normals", "matte", False, scene, theirs=("--own-normals",)),
                     Case("own sky rows", "matte", False, scene, theirs=("--own-environment",))]
    return made


def compare_scenes(arguments, folder, renders):
    print(f"{arguments.size}, {arguments.spp} spp, {arguments.seeds} seeds, {arguments.bounces} bounces")
    print(f"{'scene':15}{'materials':>10}{'ratio':>9}{'+-':>8}{'windows':>9}{'least p':>10}{'largest':>9}  verdict")
    failed = False
    for case in cases(arguments, folder):
        if arguments.only and case.name not in arguments.only.split(";"):
            continue
        ours, theirs = renders.both(case)
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


def compare_balls(folder, renders):
    size = 64
    mask, _ = predicted_ratio.inner_cosines(size)
    print("\na ball in even light: gazetrace over Mitsuba's principled (green)")
    print(f"{'metallic':>8}{'roughness':>10}{'measured':>10}{'+-':>9}{'predicted':>10}{'ours':>9}{'predicted':>10}")
    for metallic, tint in TINTS.items():
        for roughness in (0.1, 0.25, 0.5, 0.75, 1.0):
            case = Case("ball", "principled", False, matched_scenes.one_ball(folder, metallic, roughness, tint))
            ours, theirs = (x[:, mask, 1].mean(1) for x in renders.both(case, f"{size}x{size}", 16))
            ratio, error = ratio_of_means(ours, theirs)
            a, b = predicted_ratio.predicted(metallic, roughness, tint, size)
            print(f"{metallic:8d}{roughness:10.2f}{ratio:10.5f}{error:9.5f}{a[1] / b[1]:10.5f}{ours.mean():9.5f}{a[1]:10.5f}",
                  flush=True)


def compare_pane(bounces, folder, renders):
    """True where either program is off the closed form by more than 1e-3 of it."""
    case = Case("pane", "gltf", True, matched_scenes.slab_in_front_of_light(folder))
    ours, theirs = renders.both(case, "32x32", 256)
    exact = matched_scenes.slab_transmittance(bounces)
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
    parser.add_argument("--sampler", default="independent", help="of Mitsuba; multijitter is less noisy")
    parser.add_argument("--only", help="names of scenes, semicolon separated; balls and pane are names, too")
    parser.add_argument("--keep", help="folder for the mean pictures, as .npy")
    arguments = parser.parse_args()
    wanted = lambda name: not arguments.only or name in arguments.only.split(";")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        renders = Renders(arguments, folder)
        failed = compare_scenes(arguments, folder, renders)
        if wanted("balls"):
            compare_balls(folder, renders)
        if wanted("pane"):
            failed |= compare_pane(arguments.bounces, folder, renders)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is a renderer's sample less noisy, or is its picture only darker?

  noise_by_brightness.py SCENE --gazetrace build/release/bin/gazetrace --env FILE.hdr [--programs gazetrace-plain,cycles]

A relative error divides by the brightness of a reference. Where programs do not agree on how bright a place is, the darker
one has less noise by the reference that all share, and by its own wherever a pixel is darker than the floor of the division.
So the variance of the luminance over the seeds is divided here by what the program itself shows around the pixel:

  mean    of the luminance, by that of the first program
  dim     the same over the darker half of the pixels
  common  mean over the pixels of the variance by (s^2 + f^2), s the smoothed mean of all programs and f a tenth of its mean,
          by that of the first program
  own     the same with s and f of the program's own pictures

Smoothed by a Gaussian, since single pixels of few pictures are noise themselves. Behind each ratio stands its standard error,
by the jackknife over the seeds.
"""

import argparse
import pathlib
import tempfile

import numpy as np
from scipy.ndimage import gaussian_filter

import peers

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
SIGMA_PX = 3


def relative_variance(pictures, bright):
    """Mean over the pixels; `pictures` by seed, `bright` is what they are relative to."""
    floor = 0.1 * bright.mean()
    return float(np.mean(pictures.var(0, ddof=1) / (bright**2 + floor**2)))


def pictures_of(program, options, scene, folder, view):
    shown = (peers.run(program, options, scene, folder, options.size, options.spp, 1 + s, view) for s in range(options.seeds))
    return np.stack([peers.read_picture(out) @ LUMINANCE for _, out in shown])


def ratios_of(shown):
    """The columns of every program, by those of the first one."""
    smooth = {p: gaussian_filter(pictures.mean(0), SIGMA_PX) for p, pictures in shown.items()}
    common = sum(smooth.values()) / len(smooth)
    dim = common < np.median(common)
    rows = {p: np.array((smooth[p].mean(), smooth[p][dim].mean(), relative_variance(pictures, common),
                         relative_variance(pictures, smooth[p]))) for p, pictures in shown.items()}
    first = next(iter(rows.values()))
    return {p: row / first for p, row in rows.items()}


def standard_errors(shown):
    seeds = len(next(iter(shown.values())))
    without = [ratios_of({p: np.delete(pictures, s, 0) for p, pictures in shown.items()}) for s in range(seeds)]
    return {p: np.sqrt((seeds - 1) * np.var([ratios[p] for ratios in without], axis=0)) for p in shown}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    peers.add_view_arguments(parser, "gazetrace-plain,cycles,mitsuba-llvm")
    parser.add_argument("--size", default="192x108")
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--seeds", type=int, default=8)
    options = parser.parse_args()
    options.materials = "matte"
    programs, view = peers.programs_and_view(parser, options)

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene").mkdir()
        scene = peers.without_normal_maps(options.scene, folder / "scene")
        shown = {p: pictures_of(p, options, scene, folder, view) for p in programs}

    ratios = ratios_of(shown)
    errors = standard_errors(shown)
    print(f"{pathlib.Path(options.scene).name}, {options.bounces} bounces, {options.size}, {options.spp} spp, "
          f"{options.seeds} seeds, {options.env.split('/')[-1]}")
    print(f"{'program':16}" + "".join(f"{name:>17}" for name in ("mean", "dim", "common", "own")))
    for p in programs:
        print(f"{p:16}" + "".join(f"{value:9.3f} +- {error:.3f}" for value, error in zip(ratios[p], errors[p])), flush=True)


if __name__ == "__main__":
    main()

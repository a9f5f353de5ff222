#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gazetrace beside Mitsuba 3 and Blender's Cycles: CPU time per sample, error, and the product of both.

  peers.py SCENE --gazetrace build/release/bin/gazetrace --env FILE.hdr [--programs gazetrace,mitsuba-llvm,cycles]

Every program renders the same glTF, camera, light, bounces and samples. In one run, interleaved:

  us          CPU time (user + system) per sample: the difference of a run with many and a run with few samples a pixel,
              over the difference in samples, so that loading, building and writing cancel; median over --rounds
  own         relative MSE at one sample a pixel (measured at --error-spp, times it) against a converged picture of the
              program's own, its noise taken out: mean over seeds, with a 95 % interval of that mean
  common      the same against one reference, the mean of all programs' converged pictures (matte materials only: there
              the models coincide; normal maps are taken out of the scene)
  cost        us * own: time to a given error
  ratio       cost over that of the first program, usually gazetrace
  (common)    the same ratio of us * common
  furnace     radiance inside a closed box of albedo 1/2 that shines 1: 1 + 1/2 + ... + 2^-bounces if paths are equally long

`gazetrace-plain` is gazetrace with --no-guiding. What path guiding gains depends on the size of the frame: measure
errors at the size of the timed pictures.

With --rates 1,4,16,64 a table for each rate instead: `us` is the time per sample of a picture of so many samples a pixel,
what gazetrace learns from included, and the error is that of such a picture, at the size of the timed ones. For Mitsuba
and Cycles `us` is that of --steady-spp samples a pixel; what counts as time is in picture_times.py.

Relative MSE: mean of (x - r)^2 / (r^2 + (0.1 mean r)^2) over pixels and channels.
"""

import argparse
import json
import math
import os
import pathlib
import resource
import statistics
import struct
import subprocess
import sys
import tempfile

import numpy as np

import picture_times

HERE = pathlib.Path(__file__).parent
VARIANTS = {"mitsuba-scalar": "scalar_rgb", "mitsuba-llvm": "llvm_ad_rgb"}
PROGRAMS = ("gazetrace", "gazetrace-plain", "cycles", *VARIANTS)


def read_picture(path):
    if path.suffix == ".npy":
        picture = np.load(path)
    else:
        import OpenEXR

        channels = OpenEXR.File(str(path)).channels()
        picture = channels["RGB"].pixels if "RGB" in channels else np.dstack([channels[c].pixels for c in "RGB"])
        picture = picture[:, :, :3]
    if not np.isfinite(picture).all():
        sys.exit(f"{path}: a pixel is not finite, so that no mean of errors exists")
    return np.asarray(picture, np.float64)


def command(program, options, scene, out, size, spp, seed, view):
    """The command line of one render; `view` holds environment, camera and materials."""
    common = ["--size", size, "--spp", str(spp), "--seed", str(seed), "--bounces", str(options.bounces), *view]
    if program in ("gazetrace", "gazetrace-plain"):
        common += ["--no-russian-roulette"]
        common += ["--no-guiding"] if program == "gazetrace-plain" else []
        materials = ["--diffuse", "matte" if options.materials == "matte" else "burley"]
        # The scene without normal maps links to the files of the one that was given.
        return [options.gazetrace, "render", scene, *common, *materials, "--allow-outside", "--filter", "none",
                "--exr-pixels", "float", "--quiet", "--overwrite", "-o", str(out)]
    if program == "cycles":
        return [options.blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python",
                str(HERE / "cycles_render.py"), "--", scene, str(out), "--threads", str(os.cpu_count()), *common,
                "--materials", options.materials]
    variant = VARIANTS[program]
    return [options.mitsuba_python, str(HERE / "mitsuba_render.py"), scene, str(out), "--variant", variant, *common,
            "--materials", options.materials]


def run(program, options, scene, folder, size, spp, seed, view):
    """(CPU seconds, picture path)"""
    out = folder / f"{program}.{'npy' if program.startswith('mitsuba') else 'exr'}"
    return run_words(command(program, options, scene, out, size, spp, seed, view), out), out


def run_words(words, out):
    """CPU seconds of a command that writes the picture `out`."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0 or not out.exists():
        sys.exit(f"{' '.join(words)}\nfailed:\n{done.stdout[-2000:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def relative_mse(picture, reference):
    floor = 0.1 * reference.mean()
    return float(np.mean((picture - reference) ** 2 / (reference**2 + floor**2)))


def interval(values):
    """Half the width of a 95 % interval of the mean (Student's t)."""
    t = {2: 12.71, 3: 4.303, 4: 3.182, 5: 2.776, 6: 2.571, 7: 2.447, 8: 2.365, 12: 2.201, 16: 2.131}
    if len(values) < 2:
        return math.nan
    near = max(n for n in t if n <= len(values))
    return t[near] * statistics.stdev(values) / math.sqrt(len(values))


def glowing_box(path):
    """A closed box about the origin with albedo 1/2 and emission 1, normals inwards, as glTF."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    facing = [np.cross(np.subtract(corners[b], corners[a]), np.subtract(corners[c], corners[a])) @ corners[a]
              for a, b, c in triangles]
    triangles = [t if f < 0 else t[::-1] for t, f in zip(triangles, facing)]
    data = b"".join(struct.pack("<3f", *c) for c in corners) + b"".join(struct.pack("<3H", *t) for t in triangles)
    pathlib.Path(path).with_suffix(".bin").write_bytes(data)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0},
                       "emissiveFactor": [1, 1, 1], "doubleSided": True}],
        "buffers": [{"uri": pathlib.Path(path).with_suffix(".bin").name, "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}
    pathlib.Path(path).write_text(json.dumps(document))


def without_normal_maps(scene, folder):
    """The same scene beside links to its files; Mitsuba's matte surfaces have no normal maps."""
    scene = pathlib.Path(scene).resolve()
    document = json.loads(scene.read_text())
    for material in document.get("materials", []):
        material.pop("normalTexture", None)
    for file in scene.parent.iterdir():
        (folder / file.name).symlink_to(file)
    out = folder / f"{scene.stem}-matte.gltf"
    out.write_text(json.dumps(document))
    return str(out)


def furnace(program, options, folder):
    scene = folder / "box.gltf"
    glowing_box(scene)
    view = ["--eye", "0,0,0", "--target", "0.3,0.2,-1", "--yfov", "60", "--env", "none"]
    _, out = run(program, options, str(scene), folder, "32x18", 256, 1, view)
    return read_picture(out).mean()


def add_view_arguments(parser, programs):
    """What is rendered, and by which programs."""
    parser.add_argument("scene")
    parser.add_argument("--gazetrace", default="build/release/bin/gazetrace")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--mitsuba-python", default=sys.executable, help="a Python that has mitsuba")
    parser.add_argument("--programs", default=programs)
    parser.add_argument("--env", default="none")
    parser.add_argument("--eye", default="8,2,-0.3")
    parser.add_argument("--target", default="-8,3,-0.3")
    parser.add_argument("--yfov", default="50")
    parser.add_argument("--bounces", type=int, default=3)


def programs_and_view(parser, options):
    """The programs by name, and the options of the view for each."""
    programs = options.programs.split(",")
    if unknown := [p for p in programs if p not in PROGRAMS]:
        parser.error(f"--programs: '{unknown[0]}' is none of {', '.join(PROGRAMS)}")
    if len(set(programs)) < len(programs):
        parser.error("--programs: name each program once")
    # With =, since a value may begin with a minus.
    view = [f"--env={options.env}", f"--eye={options.eye}", f"--target={options.target}", f"--yfov={options.yfov}"]
    return programs, view


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_view_arguments(parser, "gazetrace,mitsuba-scalar,mitsuba-llvm,cycles")
    parser.add_argument("--materials", default="matte", choices=["matte", "principled"])
    parser.add_argument("--size", default="960x540", help="of the timed pictures")
    parser.add_argument("--spp", default="4,20", help="few and many samples a pixel of the timed pictures")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--error-size", default="192x108")
    parser.add_argument("--error-spp", type=int, default=64)
    parser.add_argument("--reference-spp", type=int, default=2048)
    parser.add_argument("--seeds", default="8", help="pictures of each error; with --rates also one number for each rate")
    parser.add_argument("--steady-spp", type=int, default=64)
    parser.add_argument("--rates",
                        help="samples a pixel, with a table for each, in place of --spp, --error-spp and --error-size")
    options = parser.parse_args()
    programs, view = programs_and_view(parser, options)
    options.seeds = [int(seeds) for seeds in options.seeds.split(",")]
    if len(options.seeds) not in (1, len(options.rates.split(",")) if options.rates else 1):
        parser.error("--seeds: one number, or one for each of --rates")

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if options.materials == "matte":
            (folder / "scene").mkdir()
            options.scene = without_normal_maps(options.scene, folder / "scene")
        shine = {p: furnace(p, options, folder) if options.materials == "matte" else math.nan for p in programs}

        measure = measure_rates if options.rates else measure_one_rate
        times, own, shared, error_size = measure(programs, options, folder, view)

    target = sum(0.5**k for k in range(options.bounces + 1))
    for rate, seeds in zip(times, seeds_of(options, times)):
        timed = f"{rate} (others {options.steady_spp})" if options.rates else options.spp.replace(",", " and ")
        print(f"{pathlib.Path(options.scene).name}, {options.materials}, {options.bounces} bounces, {options.size}, "
              f"{options.rounds} rounds of {timed} spp; error at {error_size}, {rate} spp, "
              f"reference {options.reference_spp} spp, {seeds} seeds; furnace {target}")
        print_table(programs, times[rate], own[rate], shared[rate], shine)


def seeds_of(options, rates):
    """The number of pictures for each of the rates."""
    return options.seeds if len(options.seeds) == len(rates) else options.seeds * len(rates)


def measure_one_rate(programs, options, folder, view):
    """Times as differences of whole processes, errors at a size of their own: {rate: {program: values}} of each."""
    few, many = map(int, options.spp.split(","))
    times = {p: [] for p in programs}
    for r in range(options.rounds):
        for p in programs:
            times[p].append(sample_us(p, options, folder, view, few, many, r))
    picture = lambda p, spp, seed: read_picture(
        run(p, options, options.scene, folder, options.error_size, spp, seed, view)[1])
    own, shared = measure_errors(programs, options, [options.error_spp], picture)
    return {options.error_spp: times}, own, shared, options.error_size


def measure_rates(programs, options, folder, view):
    """Times and errors of pictures of each rate: {rate: {program: values}} of each."""
    rates = [int(rate) for rate in options.rates.split(",")]
    width, height = map(int, options.size.split("x"))
    open_programs = {p: opened(p, options, folder, view) for p in programs}
    times = {rate: {p: [] for p in programs} for rate in rates}
    for r in range(options.rounds):
        for p in programs:
            # The others take as long for each sample, which many samples tell best.
            for spp in rates if p.startswith("gazetrace") else [options.steady_spp]:
                seconds, _ = open_programs[p].picture(spp, r)
                for rate in [spp] if p.startswith("gazetrace") else rates:
                    times[rate][p].append(seconds / (width * height * spp) * 1e6)
    print("times are measured, errors follow", file=sys.stderr, flush=True)
    picture = lambda p, spp, seed: read_picture(open_programs[p].picture(spp, seed)[1])
    own, shared = measure_errors(programs, options, rates, picture)
    for program in open_programs.values():
        program.close()
    return times, own, shared, options.size


def opened(program, options, folder, view):
    """The program with the scene, ready to render pictures of options.size."""
    words = lambda out, spp, seed: command(program, options, options.scene, out, options.size, spp, seed, view)
    if program.startswith("gazetrace"):
        return picture_times.Gazetrace(words, folder)
    out = folder / f"{program}.{'npy' if program.startswith('mitsuba') else 'exr'}"
    return picture_times.Served([*words(out, 1, 0), "--serve"], out)


def measure_errors(programs, options, rates, picture):
    """Errors of one sample, against each program's own reference and against the common one, by rate and program."""
    reference = {}
    if any(options.seeds):
        # Each with a seed of its own: the two variants of gazetrace may trace the very same paths with the same one.
        reference = {p: picture(p, options.reference_spp, 1000 + k) for k, p in enumerate(programs)}
        common = sum(reference.values()) / len(programs)
    own = {rate: {p: [] for p in programs} for rate in rates}
    shared = {rate: {p: [] for p in programs} for rate in rates}
    for rate, seeds in zip(rates, seeds_of(options, rates)):
        # What the reference's own noise adds: a share spp / reference spp of the picture's.
        noise = 1 + rate / options.reference_spp
        for s in range(seeds):
            for p in programs:
                x = picture(p, rate, 2000 + s)
                own[rate][p].append(relative_mse(x, reference[p]) / noise * rate)
                shared[rate][p].append(relative_mse(x, common) * rate)
        shared[rate] = without_noise_of_mean(shared[rate], rate / options.reference_spp)
    return own, shared


def without_noise_of_mean(errors, share):
    """Errors per sample against the mean of all programs' references, without what the noise of that mean adds.

    `share` is samples of a picture over samples of a reference. Of n programs with errors v, the mean of their references
    adds share / n^2 * sum(v) to each. So the sum of what was measured is sum(v) * (1 + share / n), which gives sum(v).
    It is taken out seed by seed, so that the scatter over the seeds is that of the result.

    This assumes independent references, errors that fall as 1 / samples, and programs that converge to the same picture:
    where they do not, a part of the difference between them is taken for noise.
    """
    n = len(errors)
    totals = [sum(of_seed) / (1 + share / n) for of_seed in zip(*errors.values())]
    return {p: [x - share / n**2 * total for x, total in zip(v, totals)] for p, v in errors.items()}


def sample_us(program, options, folder, view, few, many, r):
    """CPU time per sample of the round `r`, us, from whole processes."""
    width, height = map(int, options.size.split("x"))
    # What a frame learns from takes time once: against a run without, all of it counts.
    without = "gazetrace-plain" if program == "gazetrace" else program
    low, _ = run(without, options, options.scene, folder, options.size, few, 2 * r, view)
    high, _ = run(program, options, options.scene, folder, options.size, many, 2 * r + 1, view)
    return (high - low) / (width * height * (many - few)) * 1e6


def print_table(programs, times, own, shared, shine):
    print(f"{'program':16}{'us':>8}{'least':>8}{'most':>8}{'own':>9}{'+-':>8}{'common':>9}{'+-':>8}{'cost':>9}{'ratio':>7}"
          f"{'(common)':>9}{'furnace':>9}")
    mean = lambda v: statistics.mean(v) if v else math.nan
    median = lambda v: statistics.median(v) if v else math.nan
    cost = {p: median(times[p]) * mean(own[p]) for p in programs}
    common_cost = {p: median(times[p]) * mean(shared[p]) for p in programs}
    for p in programs:
        t = times[p] or [math.nan]
        print(f"{p:16}{median(times[p]):8.3f}{min(t):8.3f}{max(t):8.3f}{mean(own[p]):9.3f}"
              f"{interval(own[p]):8.3f}{mean(shared[p]):9.3f}{interval(shared[p]):8.3f}{cost[p]:9.3f}"
              f"{cost[p] / cost[programs[0]]:7.2f}{common_cost[p] / common_cost[programs[0]]:9.2f}{shine[p]:9.4f}",
              flush=True)


if __name__ == "__main__":
    main()

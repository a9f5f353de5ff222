# SPDX-License-Identifier: Apache-2.0
"""The little job that farms, parts and faults are tried on: a box before a camera that glides, and a gaze that moves. And
what its tests and benchmarks look at besides: pictures, and processes that are at work in a folder."""

import json
import os
from pathlib import Path

import harness

JOB = """
scene = "glide.gltf"
gaze = "log.csv"
size = "{size}"
frame-rect = [0, 0, 64, 36]
region-samples = [{samples}]
exposure = 0.5
"""


def job_toml(size="48x27", samples="4, 2, 1", frames=None, folder=None, more=""):
    """`folder`: where the job says that its pictures go, as f.####.exr and f.####.png. `more` may state another exposure."""
    text = JOB.format(size=size, samples=samples)
    if "exposure = " in more:
        text = text.replace("exposure = 0.5\n", "")
    if frames is not None:
        text += f'frames = "1-{frames}"\n'
    if folder is not None:
        text += f'output = ["{folder}/f.####.exr", "{folder}/f.####.png"]\n'
    return text + more


def write_inputs(folder, seconds=1.0):
    """The scene and the gaze of so many seconds of video."""
    Path(folder, "glide.gltf").write_text(json.dumps(harness.box_gltf(camera_seconds=seconds)))
    Path(folder, "log.csv").write_text(harness.moving_gaze(samples=int(seconds * 100)))


def pictures(folder):
    return {path.name: path.read_bytes() for path in Path(folder).glob("f.*") if path.suffix in (".exr", ".png")}


def processes_in(folder):
    """Processes whose working directory this is, but for this one: number -> words of the command."""
    folder = os.path.realpath(folder)
    found = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and int(entry.name) != os.getpid() and os.readlink(entry / "cwd") == folder:
                found[int(entry.name)] = (entry / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
    return found

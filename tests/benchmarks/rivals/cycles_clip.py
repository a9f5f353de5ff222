#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A clip through Blender's Cycles as a user would render it: adaptive sampling at 0.01 and Open Image Denoise.

  python cycles_clip.py SCENE FOLDER --env FILE.hdr --yfov 50 --spp 16 --seed 1 [--raw]

Runs in a Python that has bpy 5.0. FOLDER holds poses.json, which rivals.py writes: for each frame eye and target in
glTF's axes. Writes f.####.exr and seconds.json, the processor time of a frame on one thread, the first left out, since
it builds the tree. --raw: no adaptive sampling, no denoiser.
"""

import argparse
import json
import math
import pathlib
import statistics
import time

import bpy
import mathutils

parser = argparse.ArgumentParser()
parser.add_argument("scene")
parser.add_argument("folder")
parser.add_argument("--env", required=True)
parser.add_argument("--yfov", type=float, required=True)
parser.add_argument("--spp", type=int, required=True)
parser.add_argument("--seed", type=int, required=True)
parser.add_argument("--raw", action="store_true")
options = parser.parse_args()
folder = pathlib.Path(options.folder).resolve()


def from_gltf(v):
    """glTF has y up, Blender z."""
    return mathutils.Vector((v[0], -v[2], v[1]))


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=str(pathlib.Path(options.scene).resolve()))
scene = bpy.context.scene
for node in [o for o in scene.objects if o.type == "CAMERA"]:
    bpy.data.objects.remove(node)
data = bpy.data.cameras.new("view")
data.sensor_fit, data.angle_y, data.clip_start, data.clip_end = "VERTICAL", math.radians(options.yfov), 1e-3, 1e6
camera = bpy.data.objects.new("view", data)
scene.collection.objects.link(camera)
scene.camera = camera

scene.world = world = bpy.data.worlds.new("sky")
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
sky, mapping, place = nodes.new("ShaderNodeTexEnvironment"), nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
sky.image = bpy.data.images.load(str(pathlib.Path(options.env).resolve()))
# The middle of the picture is -z of glTF, +y of Blender, for gazetrace; -x in Blender's own reading.
mapping.inputs["Rotation"].default_value = (0, 0, math.radians(-90))
links.new(place.outputs["Generated"], mapping.inputs["Vector"])
links.new(mapping.outputs["Vector"], sky.inputs["Vector"])
links.new(sky.outputs["Color"], nodes["Background"].inputs["Color"])

render, cycles = scene.render, scene.cycles
render.engine, cycles.device = "CYCLES", "CPU"
cycles.samples, cycles.seed = options.spp, options.seed
cycles.use_animated_seed = True
cycles.use_adaptive_sampling, cycles.adaptive_threshold = not options.raw, 0.01
cycles.use_denoising, cycles.denoiser = not options.raw, "OPENIMAGEDENOISE"
cycles.denoising_input_passes, cycles.denoising_prefilter = "RGB_ALBEDO_NORMAL", "ACCURATE"
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 15
cycles.transparent_max_bounces = 64
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
render.threads_mode, render.threads = "FIXED", 2 if options.raw else 1
render.use_persistent_data = True
render.resolution_x, render.resolution_y, render.resolution_percentage = 320, 180, 100
image = render.image_settings
image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"

seconds = []
for frame, numbers in json.loads((folder / "poses.json").read_text()).items():
    camera.location = from_gltf(numbers[:3])
    camera.rotation_euler = (from_gltf(numbers[3:]) - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.frame_set(int(frame))
    render.filepath = str(folder / f"f.{int(frame):04d}.exr")
    begin = time.process_time()
    bpy.ops.render.render(write_still=True)
    seconds.append(time.process_time() - begin)
(folder / "seconds.json").write_text(json.dumps({"median": statistics.median(seconds[1:]), "all": seconds}))

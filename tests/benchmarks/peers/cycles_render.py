# SPDX-License-Identifier: Apache-2.0
"""Renders a glTF scene with Blender's Cycles so that it means the same as to gazetrace; writes a float EXR.

  blender -b --factory-startup --python-exit-code 1 --python cycles_render.py -- SCENE OUT.exr --size 960x540
      --eye 8,2,-0.3 --target -8,3,-0.3 --yfov 50 --env FILE.hdr --bounces 3 --spp 32 --seed 0 --materials matte|principled

Clamping, glossy blur, denoising, adaptive sampling and the light threshold are off, caustics on. matte replaces every
surface by a diffuse one of its base colour, as gazetrace's `--diffuse matte`; principled keeps Blender's own import of the
material. Bounces count scattering events: Cycles' own setting is one less. Cycles has no mip levels.

--serve loads the scene once, and then renders what lines of the standard input ask for, `OUT.exr SPP SEED`. It answers each
with `served SECONDS`, the processor time of that picture over all threads; a first picture, of one sample, goes
to OUT. The scene and its tree stay in memory from one picture to the next.
"""

import argparse
import math
import pathlib
import sys
import time

import bpy
import mathutils
import numpy

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Blender 3.4's glTF importer was written for an older numpy

triple = lambda text: [float(x) for x in text.split(",")]


def from_gltf(v):
    """glTF has y up, Blender z."""
    return mathutils.Vector((v[0], -v[2], v[1]))


def set_camera(scene, options):
    data = bpy.data.cameras.new("view")
    data.sensor_fit = "VERTICAL"
    data.angle_y = math.radians(options.yfov)
    data.clip_start, data.clip_end = 1e-3, 1e6
    camera = bpy.data.objects.new("view", data)
    camera.location = from_gltf(triple(options.eye))
    ahead = from_gltf(triple(options.target)) - camera.location
    camera.rotation_euler = ahead.to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera


def set_environment(scene, options):
    world = bpy.data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    background.inputs["Strength"].default_value = 1
    if options.env == "none":
        background.inputs["Color"].default_value = (0, 0, 0, 1)
    elif options.env.startswith("constant:"):
        background.inputs["Color"].default_value = (*triple(options.env[9:]), 1)
    else:
        picture = nodes.new("ShaderNodeTexEnvironment")
        picture.image = bpy.data.images.load(str(pathlib.Path(options.env).resolve()))
        mapping, place = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
        # The middle of the picture is -z of glTF, +y of Blender, for gazetrace; -x in Blender's own reading.
        mapping.inputs["Rotation"].default_value = (0, 0, math.radians(-90 - options.env_rotation))
        links.new(place.outputs["Generated"], mapping.inputs["Vector"])
        links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
        links.new(picture.outputs["Color"], background.inputs["Color"])
    # The importance table at the picture's own resolution, as the other programs have it.
    world.cycles.sampling_method = "AUTOMATIC"


def make_matte(material):
    nodes, links = material.node_tree.nodes, material.node_tree.links
    source = next((n for n in nodes if n.type == "BSDF_PRINCIPLED"), None)
    output = next(n for n in nodes if n.type == "OUTPUT_MATERIAL")
    if source is None:
        return
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Roughness"].default_value = 0
    base = source.inputs["Base Color"]
    diffuse.inputs["Color"].default_value = base.default_value
    if base.links:
        links.new(base.links[0].from_socket, diffuse.inputs["Color"])
    shader = diffuse.outputs["BSDF"]
    emission = source.inputs["Emission"]
    if emission.links or any(emission.default_value[:3]):
        shine, both = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeAddShader")
        shine.inputs["Color"].default_value = emission.default_value
        shine.inputs["Strength"].default_value = source.inputs["Emission Strength"].default_value
        if emission.links:
            links.new(emission.links[0].from_socket, shine.inputs["Color"])
        links.new(shader, both.inputs[0])
        links.new(shine.outputs["Emission"], both.inputs[1])
        shader = both.outputs["Shader"]
    alpha = source.inputs["Alpha"]
    if alpha.links or alpha.default_value < 1:  # holes of leaves and chains
        hole, part = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
        part.inputs["Fac"].default_value = alpha.default_value
        if alpha.links:
            cover = alpha.links[0].from_socket
            if material.blend_method == "CLIP":  # glTF's MASK: the importer leaves the cutoff to Blender's other renderer
                cut = nodes.new("ShaderNodeMath")
                cut.operation = "GREATER_THAN"
                cut.inputs[1].default_value = material.alpha_threshold
                links.new(cover, cut.inputs[0])
                cover = cut.outputs["Value"]
            links.new(cover, part.inputs["Fac"])
        links.new(hole.outputs["BSDF"], part.inputs[1])
        links.new(shader, part.inputs[2])
        shader = part.outputs["Shader"]
    links.new(shader, output.inputs["Surface"])


def set_cycles(scene, options):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = options.spp
    cycles.seed = options.seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.light_sampling_threshold = 0
    cycles.min_light_bounces = cycles.min_transparent_bounces = 1024  # no Russian roulette
    bounces = options.bounces - 1
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.transparent_max_bounces = 64
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1
    scene.render.threads_mode = "FIXED"
    scene.render.threads = options.threads
    scene.render.use_persistent_data = False
    width, height = map(int, options.size.split("x"))
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.film_transparent = False
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = str(pathlib.Path(options.output).resolve())


def serve(scene):
    """Renders each `OUT.exr SPP SEED` of the standard input, until it ends."""
    scene.render.use_persistent_data = True
    scene.cycles.samples = 1
    bpy.ops.render.render(write_still=True)  # builds the tree, which is no picture's time
    for line in sys.stdin:
        out, spp, seed = line.split()
        scene.cycles.samples, scene.cycles.seed = int(spp), int(seed)
        scene.render.filepath = out
        begin = time.process_time()
        bpy.ops.render.render(write_still=True)  # without a file to write, Blender renders nothing anew
        print(f"served {time.process_time() - begin}", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("output")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--eye", default="8,2,-0.3")
    parser.add_argument("--target", default="-8,3,-0.3")
    parser.add_argument("--yfov", type=float, default=50)
    parser.add_argument("--env", default="none")
    parser.add_argument("--env-rotation", type=float, default=0)
    parser.add_argument("--bounces", type=int, default=3)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--materials", default="matte", choices=["matte", "principled"])
    parser.add_argument("--serve", action="store_true")
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.import_scene.gltf(filepath=str(pathlib.Path(options.scene).resolve()))
    if options.materials == "matte":
        for material in bpy.data.materials:
            if material.use_nodes:
                make_matte(material)
    set_camera(scene, options)
    set_environment(scene, options)
    set_cycles(scene, options)
    if options.serve:
        serve(scene)
    else:
        bpy.ops.render.render(write_still=True)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the courtyard: courtyard.gltf, courtyard.bin, textures/*.png and dusk.hdr.

    make_courtyard.py [--out FOLDER] [--keep-textures]

Python 3, standard library only; the same bytes every time. Metres, +y up, the camera walks towards -z.
"""
import argparse
import math
import os
import random

from courtyard_maker import building, objects
from courtyard_maker.gltf_writer import GltfWriter
from courtyard_maker.noise import fractal_noise
from courtyard_maker.shapes import Shape, rectangle
from courtyard_maker.sky import write_sky
from courtyard_maker.textures import write_textures
from courtyard_maker.vec import add, look_rotation, mix, random_rotation, scale, smoothstep, sub

TREE_AT = (-2.35, 0.0, -3.55)
WALK_SECONDS = 5.0


def make_materials(out):
    texture = {name: out.texture(f"textures/{name}.png") for name in (
        "tiles_color", "clay_color", "tiles_normal", "tiles_roughness", "plaster_color", "plaster_normal",
        "wood_color", "ripples_normal")}  # fmt: skip
    chart = out.texture("textures/chart_color.png", clamp=True)
    leaves = out.texture("textures/foliage.png", clamp=True)
    # Walls and floors carry texture coordinates in metres; the transform says how often a picture repeats in one.
    tiles, walls = (1.25, 1.25), (0.42, 0.42)
    floor = {
        "metallicRoughnessTexture": out.texture_info(texture["tiles_roughness"], tiles),
        "normalTexture": out.texture_info(texture["tiles_normal"], tiles),
    }
    plaster = {
        "baseColorTexture": out.texture_info(texture["plaster_color"], walls),
        "normalTexture": out.texture_info(texture["plaster_normal"], walls, scale=0.7),
    }
    return {
        "tiles": out.material("tiles", baseColorTexture=out.texture_info(texture["tiles_color"], tiles), **floor),
        "clay tiles": out.material("clay tiles", baseColorTexture=out.texture_info(texture["clay_color"], tiles), **floor),
        "plaster": out.material("plaster", base=(0.86, 0.74, 0.58), roughness=0.9, doubleSided=True, **plaster),
        "niche": out.material("niche", base=(0.045, 0.155, 0.20), roughness=0.75, **plaster),
        "stone": out.material("stone", base=(0.66, 0.58, 0.47), roughness=0.62, **plaster),
        "chart": out.material("chart", roughness=0.34, baseColorTexture=out.texture_info(chart)),
        "wood": out.material("wood", roughness=0.7, baseColorTexture=out.texture_info(texture["wood_color"], (0.5, 2.0))),
        "earth": out.material("earth", base=(0.30, 0.21, 0.14), roughness=1.0),
        "hills": out.material("hills", base=(0.13, 0.135, 0.11), roughness=1.0),
        "water": out.material(
            "water", base=(0.008, 0.030, 0.034), roughness=0.2,
            normalTexture=out.texture_info(texture["ripples_normal"], (1.4, 1.4), scale=0.25),
        ),
        "brass": out.material("brass", base=(0.90, 0.66, 0.30), roughness=0.16, metallic=1.0),
        "aged brass": out.material("aged brass", base=(0.52, 0.37, 0.19), roughness=0.48, metallic=1.0),
        "steel": out.material("steel", base=(0.60, 0.61, 0.63), roughness=0.38, metallic=1.0),
        "glaze": out.material("glaze", roughness=0.2),
        "terracotta": out.material("terracotta", base=(0.50, 0.225, 0.125), roughness=0.8),
        "roof": out.material("roof", base=(0.46, 0.215, 0.125), roughness=0.85),
        "soil": out.material("soil", base=(0.055, 0.038, 0.026), roughness=1.0),
        "bark": out.material("bark", base=(0.22, 0.17, 0.125), roughness=0.95),
        "leaves": out.material(
            "leaves", roughness=0.55, baseColorTexture=out.texture_info(leaves), alphaMode="MASK", alphaCutoff=0.5,
            doubleSided=True,
        ),
        # Half-transparent, and not transmissive: a path finds the bulb behind it by rays to lights, with few samples.
        "lantern glass": out.material(
            "lantern glass", base=(0.62, 0.42, 0.20), alpha=0.22, roughness=0.12, alphaMode="BLEND", doubleSided=True
        ),
        "lantern light": out.material("lantern light", base=(0, 0, 0), emissive=(1.0, 0.56, 0.22), strength=330.0),
        "neon teal": out.material("neon teal", base=(0, 0, 0), emissive=(0.10, 0.78, 1.0), strength=19.0),
        "neon rose": out.material("neon rose", base=(0, 0, 0), emissive=(1.0, 0.28, 0.30), strength=15.0),
    }  # fmt: skip


def place_building(out, material):
    carpet, border = building.floor()
    out.node("floor", mesh=out.mesh("floor", (carpet, material["tiles"]), (border, material["clay tiles"])))
    out.node("walls", mesh=out.mesh("walls", (building.plaster_walls(), material["plaster"])))
    out.node("niche", mesh=out.mesh("niche", (building.niche_lining(), material["niche"])))
    out.node("stone trim", mesh=out.mesh("stone trim", (building.stone_trim(), material["stone"])))
    out.node("beams", mesh=out.mesh("beams", (building.beams(), material["wood"])))
    out.node("ground", mesh=out.mesh("ground", (building.ground(), material["earth"])))
    ridge = lambda turn: max(1.0, 20.0 * fractal_noise(turn, 0.5, 16, 2, 4, seed=83) - 4.5)  # noqa: E731
    out.node("hills", mesh=out.mesh("hills", (building.hills(ridge), material["hills"])))
    stone, water = building.basin()
    out.node("basin", mesh=out.mesh("basin", (stone, material["stone"]), (water, material["water"])))
    places = building.roof_tile_places()
    tile = out.mesh("roof tile", (building.roof_tile(), material["roof"]))
    out.instances("roof tiles", tile, [p for p, _ in places], [q for _, q in places], [(1.0, 1.0, 1.0)] * len(places))


def place_chart(out, material):
    """A panel of 1.44 m in the niche, 5 cm in front of its back, with the neon eye above."""
    size, z = 1.44, building.BACK - building.NICHE["depth"] + 0.05
    shape = Shape()
    corners = ((-size / 2, 0.52), (size / 2, 0.52), (size / 2, 0.52 + size), (-size / 2, 0.52 + size))
    uvs = ((0, 1), (1, 1), (1, 0), (0, 0))
    for (x, y), uv in zip(corners, uvs):
        shape.vertex((x, y, z), (0, 0, 1), uv)
    shape.indices += (0, 1, 2, 0, 2, 3)
    edge, w = Shape(), 0.035
    low, high = 0.52, 0.52 + size
    for box_low, box_high in (
        ((-size / 2 - w, low - w, z - 0.05), (size / 2 + w, low, z + 0.012)),
        ((-size / 2 - w, high, z - 0.05), (size / 2 + w, high + w, z + 0.012)),
        ((-size / 2 - w, low, z - 0.05), (-size / 2, high, z + 0.012)),
        ((size / 2, low, z - 0.05), (size / 2 + w, high, z + 0.012)),
    ):
        objects.box(edge, box_low, box_high)
    out.node("chart", mesh=out.mesh("chart", (shape, material["chart"]), (edge, material["stone"])))
    outline, iris, supports = objects.neon_eye()
    eye = out.mesh(
        "neon eye", (outline, material["neon teal"]), (iris, material["neon rose"]), (supports, material["aged brass"])
    )
    out.node("neon eye", mesh=eye, translation=[0.0, 2.44, building.BACK - building.NICHE["depth"] + 0.10])


def place_objects(out, material):
    top = objects.BENCH["top"]
    out.node("bench", mesh=out.mesh("bench", (objects.bench(), material["stone"])))
    out.node("vase", mesh=out.mesh("vase", (objects.vase(), material["glaze"])), translation=[0.82, top, -0.13])
    turn = math.radians(-18)
    out.node(
        "knot", mesh=out.mesh("knot", (objects.knot(), material["steel"])), translation=[1.68, top, -0.13],
        rotation=[0.0, math.sin(turn / 2), 0.0, math.cos(turn / 2)],
    )  # fmt: skip
    out.node("ball", mesh=out.mesh("ball", (objects.ball(), material["brass"])), translation=[2.40, top, -0.10])
    metal, glass, light = objects.lantern()
    lantern = out.mesh(
        "lantern", (metal, material["aged brass"]), (glass, material["lantern glass"]), (light, material["lantern light"])
    )
    out.node("lantern", mesh=lantern, translation=[1.55, 2.86, -1.30])


def foliage_node(out, random_state, name, mesh, places, size, tilt_deg):
    rotations = [random_rotation(random_state, direction, math.radians(tilt_deg)) for _, direction in places]
    sizes = [size * random_state.uniform(0.75, 1.25) for _ in places]
    out.instances(name, mesh, [p for p, _ in places], rotations, [(s, s, s) for s in sizes])


def place_plants(out, material):
    state = random.Random(4711)
    olive, flowers = (out.mesh(name, (shape, material["leaves"])) for name, shape in zip(("sprig", "blossom"), objects.sprig()))

    clay, soil = objects.pot(0.36, 0.52)
    pot = out.mesh("pot", (clay, material["terracotta"]), (soil, material["soil"]))
    out.node("tree pot", mesh=pot, translation=list(TREE_AT))
    wood, places = objects.tree(state)
    root = add(TREE_AT, (0.0, 0.42, 0.0))
    out.node("tree", mesh=out.mesh("tree", (wood, material["bark"])), translation=list(root))
    foliage_node(out, state, "tree leaves", olive, [(add(root, p), d) for p, d in places], 0.27, 40)

    leaves, blossom = objects.bougainvillea(state)
    foliage_node(out, state, "climber leaves", olive, leaves, 0.27, 30)
    foliage_node(out, state, "climber blossom", flowers, blossom, 0.25, 30)

    # Two more pots by plain node reuse, planted with a tuft of sprigs each.
    for name, at, size in (("shrub by the niche", (2.45, 0.0, -4.35), 0.8), ("shrub by the column", (-3.0, 0.0, 1.1), 0.7)):
        group = out.node(name, translation=list(at), scale=[size, size, size])
        out.node(f"{name}: pot", parent=group, mesh=pot)
        for k in range(34):
            out_angle, lean = k * 2.39996, 0.25 + 0.55 * state.random()
            direction = (lean * math.cos(out_angle), 1.0, lean * math.sin(out_angle))
            position = (0.16 * direction[0], 0.44 + 0.35 * state.random(), 0.16 * direction[2])
            q = random_rotation(state, scale(direction, 1.0 / math.dist((0, 0, 0), direction)), 0.2)
            s = 0.55 * state.uniform(0.8, 1.2)
            mesh = flowers if size < 0.75 and k % 3 == 0 else olive
            out.node(f"{name}: {k}", parent=group, mesh=mesh, translation=list(position), rotation=list(q), scale=[s, s, s])

    # Cypresses outside, seen through the arcade.
    cypresses = []
    stem = Shape()
    objects.tube(stem, [(0, -0.1, 0), (0.02, 0.5, 0.01), (0, 1.2, 0)], lambda t: 0.11 - 0.03 * t, 10)
    stem = out.mesh("cypress stem", (stem, material["bark"]))
    for x, z, height in ((-9.5, -7.5, 5.2), (-11.5, -4.6, 6.0), (-8.6, -11.0, 4.6)):
        out.node("cypress stem", mesh=stem, translation=[x, 0.0, z])
        for _ in range(280):
            y = 0.03 + 0.97 * state.random()
            angle = state.uniform(0.0, 2.0 * math.pi)
            radius = 0.62 * math.sin(math.pi * min(1.0, 0.12 + 0.88 * y)) ** 0.7
            cypresses.append(
                ((x + radius * math.cos(angle), y * height, z + radius * math.sin(angle)),
                 (0.35 * math.cos(angle), 0.94, 0.35 * math.sin(angle)))
            )  # fmt: skip
    foliage_node(out, state, "cypresses", olive, cypresses, 0.5, 18)


def walk_position(t):
    """Eye height, forward and a little to the left; eased at both ends."""
    s = smoothstep(-0.15, 1.15, t)
    return mix((0.98, 1.62, 4.15), (0.52, 1.50, 3.35), s)


def walk_target(t):
    return mix((0.62, 1.22, -2.6), (0.34, 1.16, -2.6), smoothstep(-0.1, 1.1, t))


def place_cameras(out):
    lens = {"aspectRatio": 16 / 9, "yfov": math.radians(44.0), "znear": 0.05}
    walk = out.append("cameras", {"type": "perspective", "name": "walk", "perspective": rounded_lens(lens)})
    still = out.append("cameras", {"type": "perspective", "name": "still", "perspective": rounded_lens(lens)})
    # The walker carries the camera: positions on the parent, looking on the child.
    start = walk_position(0.0)
    walker = out.node("walker", translation=list(start))
    camera = out.node("walk", parent=walker, camera=walk, rotation=list(look_rotation(start, walk_target(0.0))))
    middle = walk_position(0.45)
    out.node("still", camera=still, translation=list(middle), rotation=list(look_rotation(middle, walk_target(0.45))))

    keys, step = 5, 1e-3
    spline = []
    for k in range(keys):
        t = k / (keys - 1)
        tangent = scale(sub(walk_position(t + step), walk_position(t - step)), 1.0 / (2 * step * WALK_SECONDS))
        spline += [tangent, walk_position(t), tangent]
    looks = 21
    rotations = [look_rotation(walk_position(k / (looks - 1)), walk_target(k / (looks - 1))) for k in range(looks)]
    out.animation("walk", [
        (walker, "translation", "CUBICSPLINE", [WALK_SECONDS * k / (keys - 1) for k in range(keys)], spline),
        (camera, "rotation", "LINEAR", [WALK_SECONDS * k / (looks - 1) for k in range(looks)], rotations),
    ])  # fmt: skip


def rounded_lens(lens):
    return {key: round(value, 6) for key, value in lens.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--out", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "courtyard"))
    parser.add_argument("--keep-textures", action="store_true", help="only the geometry, the cameras and the materials")
    args = parser.parse_args()
    os.makedirs(args.out, exist_ok=True)
    out = GltfWriter("make_courtyard.py of gazetrace", "CC0 1.0, made for gazetrace")
    material = make_materials(out)
    place_building(out, material)
    place_chart(out, material)
    place_objects(out, material)
    place_plants(out, material)
    place_cameras(out)
    out.json["scenes"][0]["extras"] = {"gazetrace": {"environment": "dusk.hdr"}}  # for renderers that choose one
    out.write(args.out, "courtyard")
    if not args.keep_textures:
        write_textures(os.path.join(args.out, "textures"))
        write_sky(os.path.join(args.out, "dusk.hdr"))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders a glTF scene with Mitsuba 3, converted so that it means the same as to gazetrace; writes a .npy picture.

  mitsuba_render.py SCENE OUT.npy --variant llvm_ad_rgb --size 960x540 --eye 8,2,-0.3 --target -8,3,-0.3 --yfov 50
                    --env FILE.hdr --bounces 3 --spp 32 --seed 0 --materials matte|principled

Materials. matte: base colour / pi, as gazetrace renders with `--diffuse matte`: the models coincide. principled: Mitsuba's
Disney BSDF with glTF's base colour, roughness, metalness and normal map: Schlick's Fresnel and GGX as in gazetrace, without
its compensation of multiple scattering and with another diffuse lobe.
Bounces count scattering events. Textures are bilinear and repeat; Mitsuba has no mip levels.
"""

import argparse
import pathlib
import tempfile

import mitsuba as mi
import numpy as np

from gltf_meshes import Gltf, write_ply


def texture_node(path, factor, raw, channel=None):
    """A bitmap times a factor; `channel` picks one channel of the file."""
    bitmap = mi.Bitmap(str(path))
    if channel is not None or not np.allclose(factor, 1) or bitmap.channel_count() not in (1, 3):
        kind = mi.Bitmap.PixelFormat.RGB
        values = np.array(bitmap.convert(kind, mi.Struct.Type.Float32, srgb_gamma=raw and bitmap.srgb_gamma()))
        if channel is not None:
            values = values[:, :, channel : channel + 1]
        bitmap = mi.Bitmap(np.ascontiguousarray(values * np.asarray(factor, np.float32)))
        raw = True
    return {"type": "bitmap", "bitmap": bitmap, "raw": raw, "filter_type": "bilinear", "wrap_mode": "repeat"}


def color(rgb):
    return {"type": "rgb", "value": [float(c) for c in rgb]}


def surface(gltf, index, model):
    """The BSDF of a glTF material."""
    material = gltf.materials[index] if index >= 0 else {}
    pbr = material.get("pbrMetallicRoughness", {})
    factor = pbr.get("baseColorFactor", [1, 1, 1, 1])
    base = color(factor[:3])
    if "baseColorTexture" in pbr:
        base = texture_node(gltf.image_path(pbr["baseColorTexture"]["index"]), factor[:3], raw=False)
    if model == "matte":
        bsdf = {"type": "diffuse", "reflectance": base}
    else:
        roughness, metallic = pbr.get("roughnessFactor", 1.0), pbr.get("metallicFactor", 1.0)
        bsdf = {"type": "principled", "base_color": base, "roughness": roughness, "metallic": metallic, "specular": 0.5}
        if "metallicRoughnessTexture" in pbr:
            path = gltf.image_path(pbr["metallicRoughnessTexture"]["index"])
            bsdf["roughness"] = texture_node(path, roughness, True, channel=1)
            bsdf["metallic"] = texture_node(path, metallic, True, channel=2)
    bsdf = {"type": "twosided", "bsdf": bsdf}
    if model != "matte" and "normalTexture" in material:
        path = gltf.image_path(material["normalTexture"]["index"])
        bsdf = {"type": "normalmap", "normalmap": texture_node(path, 1, True), "bsdf": bsdf}
    if material.get("alphaMode", "OPAQUE") != "OPAQUE" and "baseColorTexture" in pbr:
        alpha = np.array(mi.Bitmap(str(gltf.image_path(pbr["baseColorTexture"]["index"]))))
        if alpha.shape[2] == 4:
            values = alpha[:, :, 3:].astype(np.float32) / 255
            if material["alphaMode"] == "MASK":
                values = (values >= material.get("alphaCutoff", 0.5)).astype(np.float32)
            opacity = {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(values)), "raw": True}
            bsdf = {"type": "mask", "opacity": opacity, "bsdf": bsdf}
    return bsdf


def emission(gltf, index):
    material = gltf.materials[index] if index >= 0 else {}
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    return np.array(material.get("emissiveFactor", [0, 0, 0])) * strength


def punctual_lights(gltf):
    lights = gltf.json.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    for node, matrix in gltf.nodes():
        index = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
        if index is None:
            continue
        light = lights[index]
        power = np.array(light.get("color", [1, 1, 1])) * light.get("intensity", 1.0)
        toward = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        if light["type"] == "directional":
            yield {"type": "directional", "direction": toward.tolist(), "irradiance": color(power)}
        elif light["type"] == "point" and "range" not in light:
            yield {"type": "point", "position": matrix[:3, 3].tolist(), "intensity": color(power)}
        else:
            raise ValueError(f"{light['type']} lights with glTF's fall-off have no counterpart in Mitsuba")


def convert(options, scratch):
    gltf = Gltf(options.scene)
    width, height = map(int, options.size.split("x"))
    transform = mi.ScalarTransform4f()
    triple = lambda text: [float(x) for x in text.split(",")]
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": options.bounces + 1, "rr_depth": 1000000},
        "sensor": {
            "type": "perspective", "fov": options.yfov, "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e6,
            "to_world": transform.look_at(triple(options.eye), triple(options.target), [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": options.sampler},
        },
    }
    if options.env.startswith("constant:"):
        scene["environment"] = {"type": "constant", "radiance": color(triple(options.env[9:]))}
    elif options.env != "none":
        # The middle of the picture is -z for gazetrace and +z for Mitsuba.
        scene["environment"] = {"type": "envmap", "filename": options.env,
                                "to_world": transform.rotate([0, 1, 0], 180 + options.env_rotation)}
    for i in sorted({mesh.material for mesh in gltf.meshes()}):
        scene[f"material{i}"] = surface(gltf, i, options.materials) | {"id": f"material{i}"}
    for i, mesh in enumerate(gltf.meshes()):
        path = pathlib.Path(scratch) / f"{i}.ply"
        write_ply(mesh, path, normals=True)
        shape = {"type": "ply", "filename": str(path), "face_normals": mesh.normals is None,
                 "bsdf": {"type": "ref", "id": f"material{mesh.material}"}}
        if emission(gltf, mesh.material).any():
            shape["emitter"] = {"type": "area", "radiance": color(emission(gltf, mesh.material))}
        scene[f"mesh{i}"] = shape
    for i, light in enumerate(punctual_lights(gltf)):
        scene[f"light{i}"] = light
    return mi.load_dict(scene)


def render(scene, spp, seed, per_pass):
    """The mean of passes, each with a seed of its own, in double precision: memory stays bounded."""
    total, done, step = None, 0, 0
    while done < spp:
        count = min(per_pass, spp - done)
        # Seeds of different runs must not meet.
        image = np.array(mi.render(scene, spp=count, seed=seed * 65536 + step), np.float64)
        total = image * count if total is None else total + image * count
        done, step = done + count, step + 1
    return (total / spp).astype(np.float32)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("output")
    parser.add_argument("--variant", default="scalar_rgb")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--eye", default="8,2,-0.3")
    parser.add_argument("--target", default="-8,3,-0.3")
    parser.add_argument("--yfov", type=float, default=50)
    parser.add_argument("--env", default="none")
    parser.add_argument("--env-rotation", type=float, default=0)
    parser.add_argument("--bounces", type=int, default=3)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--sampler", default="independent")
    parser.add_argument("--materials", default="matte", choices=["matte", "principled"])
    parser.add_argument("--per-pass", type=int, default=8, help="samples a pixel held in memory at once (llvm)")
    options = parser.parse_args()
    mi.set_variant(options.variant)
    with tempfile.TemporaryDirectory() as scratch:
        scene = convert(options, scratch)
        per_pass = options.spp if options.variant.startswith("scalar") else options.per_pass
        np.save(options.output, render(scene, options.spp, options.seed, per_pass))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders a glTF scene with Mitsuba 3, converted so that it means the same as to gazetrace; writes .npy pictures.

  mitsuba_render.py SCENE OUT.npy --variant llvm_ad_rgb --size 960x540 --eye 8,2,-0.3 --target -8,3,-0.3 --yfov 50
                    --env FILE.hdr --bounces 3 --spp 32 --seed 0 --materials matte|gltf|principled

Materials. matte: base colour / pi, as gazetrace renders with `--diffuse matte`. gltf: gazetrace's own documented model,
as plugins (mitsuba_metallic_roughness.py); in both the models coincide. principled: Mitsuba's own Disney BSDF with glTF's
base colour, roughness and metalness: Schlick's Fresnel and GGX as in gazetrace, but separable masking, no compensation of
multiple scattering and another diffuse lobe. Smooth bodies of glass are Mitsuba's `dielectric`, rough ones with
principled its `roughdielectric`, which differs as principled does.
Bounces count scattering events. Textures are bilinear and repeat; Mitsuba has no mip levels.

--matched (LLVM variants alone; slower) takes out three things that Mitsuba does otherwise; each has an option that leaves
it in, to see its share:
  --own-environment   its envmap has rows at v = i / (rows - 1), not at pixel centres; matched, the picture gets twice as
                      many rows, so that both interpolate the same function
  --own-masks         its `path` counts a hole in a mask as a scattering event and lets it stop light samples, and a mask's
                      opacity is interpolated after the cutoff; matched, `volpath`, which does neither, and alpha_cutoff
  --own-normals       it knows no bent normals and lets light through where shading normal and triangle disagree; matched,
                      surface_sides

--serve loads the scene once, and then renders what lines of the standard input ask for, `OUT.npy SPP SEED`. It answers each
with `served SECONDS`, the processor time of that picture over all threads; OUT and --spp on the command line are not used.
"""

import argparse
import pathlib
import sys
import tempfile
import time

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
    return {"type": "bitmap", "bitmap": bitmap, "raw": raw, "filter_type": "bilinear", "wrap_mode": "repeat",
            "format": "variant"}


def color(rgb):
    return {"type": "rgb", "value": [float(c) for c in rgb]}


def is_glass(material):
    """A solid body that light passes through, with nothing else on it."""
    extensions = material.get("extensions", {})
    pbr = material.get("pbrMetallicRoughness", {})
    if extensions.get("KHR_materials_transmission", {}).get("transmissionFactor", 0) == 0:
        return False
    if (not extensions.get("KHR_materials_volume", {}).get("thicknessFactor") or pbr.get("metallicFactor", 1)
            or extensions["KHR_materials_transmission"]["transmissionFactor"] != 1
            or pbr.get("baseColorFactor", [1, 1, 1])[:3] != [1, 1, 1]):
        raise ValueError("of transmission only white solid bodies have a counterpart")
    return True


def glass(material, materials):
    roughness = material["pbrMetallicRoughness"].get("roughnessFactor", 1.0)
    ior = material["extensions"].get("KHR_materials_ior", {}).get("ior", 1.5)
    if roughness == 0:
        return {"type": "dielectric", "int_ior": ior, "ext_ior": 1.0}
    if materials == "gltf":
        return {"type": "rough_glass", "roughness": roughness, "ior": ior}
    return {"type": "roughdielectric", "distribution": "ggx", "alpha": roughness**2, "int_ior": ior, "ext_ior": 1.0}


def absorption(material):
    """The medium inside a body of glass, or None: light is absorbed, never scattered."""
    volume = material.get("extensions", {}).get("KHR_materials_volume", {})
    distance = volume.get("attenuationDistance")
    if not distance:
        return None
    sigma = -np.log(np.array(volume.get("attenuationColor", [1, 1, 1]), float)) / distance
    most = float(sigma.max())  # colours above 1 are refused
    return {"type": "homogeneous", "albedo": 0.0, "sigma_t": {"type": "rgb", "value": (sigma / most).tolist()}, "scale": most}


def has_alpha(gltf, material):
    texture = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    if material.get("alphaMode", "OPAQUE") == "OPAQUE" or texture is None:
        return False
    return mi.Bitmap(str(gltf.image_path(texture["index"]))).channel_count() == 4


def surface(gltf, index, options):
    """The BSDF of a glTF material."""
    material = gltf.materials[index] if index >= 0 else {}
    pbr = material.get("pbrMetallicRoughness", {})
    factor = pbr.get("baseColorFactor", [1, 1, 1, 1])
    base = color(factor[:3])
    if "baseColorTexture" in pbr:
        base = texture_node(gltf.image_path(pbr["baseColorTexture"]["index"]), factor[:3], raw=False)
    roughness, metallic = pbr.get("roughnessFactor", 1.0), pbr.get("metallicFactor", 1.0)
    transmits = options.materials != "matte" and is_glass(material)
    if transmits:
        bsdf = glass(material, options.materials)
    elif options.materials == "matte":
        bsdf = {"type": "diffuse", "reflectance": base}
    elif options.materials == "gltf":
        if "metallicRoughnessTexture" in pbr or "normalTexture" in material:
            raise ValueError("--materials gltf takes numbers for roughness and metalness, and no normal maps")
        bsdf = {"type": "metallic_roughness", "base_color": base, "roughness": roughness, "metallic": metallic}
    else:
        bsdf = {"type": "principled", "base_color": base, "roughness": roughness, "metallic": metallic, "specular": 0.5}
        if "metallicRoughnessTexture" in pbr:
            path = gltf.image_path(pbr["metallicRoughnessTexture"]["index"])
            bsdf["roughness"] = texture_node(path, roughness, True, channel=1)
            bsdf["metallic"] = texture_node(path, metallic, True, channel=2)
    if options.materials != "principled" and not options.own_normals:
        bsdf = {"type": "surface_sides", "bsdf": bsdf, "transmits": transmits}
    elif not transmits:
        bsdf = {"type": "twosided", "bsdf": bsdf}
    if options.materials == "principled" and "normalTexture" in material:
        path = gltf.image_path(material["normalTexture"]["index"])
        bsdf = {"type": "normalmap", "normalmap": texture_node(path, 1, True), "bsdf": bsdf}
    if has_alpha(gltf, material):
        alpha = np.array(mi.Bitmap(str(gltf.image_path(pbr["baseColorTexture"]["index"]))))[:, :, 3:]
        values, cutoff = alpha.astype(np.float32) / 255, material.get("alphaCutoff", 0.5)
        if options.own_masks and material["alphaMode"] == "MASK":
            values = (values >= cutoff).astype(np.float32)
        opacity = {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(values)), "raw": True, "format": "variant"}
        if material["alphaMode"] == "MASK" and not options.own_masks:
            opacity = {"type": "alpha_cutoff", "alpha": opacity, "cutoff": cutoff}
        bsdf = {"type": "mask", "opacity": opacity, "bsdf": bsdf}
    return bsdf


def environment(options):
    """Rows at pixel centres: with the means of neighbours between them, nodes at v = i / (2 rows) are the same function."""
    picture = np.array(mi.Bitmap(options.env).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    if not options.own_environment:
        rows = np.empty((2 * len(picture) + 1, *picture.shape[1:]), np.float32)
        rows[1::2] = picture
        rows[2:-1:2] = 0.5 * (picture[:-1] + picture[1:])
        rows[0], rows[-1] = picture[0], picture[-1]
        picture = rows
    # The middle of the picture is -z for gazetrace and +z for Mitsuba.
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(picture)),
            "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 180 + options.env_rotation)}


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
    materials = {i: gltf.materials[i] if i >= 0 else {} for i in sorted({mesh.material for mesh in gltf.meshes()})}
    media = {} if options.materials == "matte" else {
        i: absorption(m) for i, m in materials.items() if absorption(m) is not None}
    through = bool(media) or (not options.own_masks and any(has_alpha(gltf, m) for m in materials.values()))
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath" if through else "path", "max_depth": options.bounces + 1, "rr_depth": 1000000},
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
        scene["environment"] = environment(options)
    for i in materials:
        scene[f"material{i}"] = surface(gltf, i, options) | {"id": f"material{i}"}
    for i, mesh in enumerate(gltf.meshes()):
        path = pathlib.Path(scratch) / f"{i}.ply"
        write_ply(mesh, path, normals=True)
        shape = {"type": "ply", "filename": str(path), "face_normals": mesh.normals is None,
                 "bsdf": {"type": "ref", "id": f"material{mesh.material}"}}
        if mesh.material in media:
            shape["interior"] = media[mesh.material]
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


def serve(scene, per_pass):
    """Renders each `OUT.npy SPP SEED` of the standard input, until it ends."""
    if per_pass:
        render(scene, per_pass + 1, 0, per_pass)  # compiles the kernels, which is no picture's time
    for line in sys.stdin:
        out, spp, seed = line.split()
        begin = time.process_time()
        picture = render(scene, int(spp), int(seed), per_pass or int(spp))
        seconds = time.process_time() - begin
        np.save(out, picture)
        print(f"served {seconds}", flush=True)


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
    parser.add_argument("--materials", default="matte", choices=["matte", "gltf", "principled"])
    parser.add_argument("--matched", action="store_true")
    parser.add_argument("--own-environment", action="store_true")
    parser.add_argument("--own-masks", action="store_true")
    parser.add_argument("--own-normals", action="store_true")
    parser.add_argument("--seeds", type=int, default=0, help="so many pictures from --seed on, as one array; 0: a picture")
    parser.add_argument("--per-pass", type=int, default=0,
                        help="samples a pixel held in memory at once (llvm); 0: 8, more for small pictures")
    parser.add_argument("--serve", action="store_true")
    options = parser.parse_args()
    mi.set_variant(options.variant)
    if not options.matched:
        options.own_normals = options.own_masks = options.own_environment = True
    if options.variant.startswith("llvm"):  # in scalar variants plugins in Python would be called ray by ray
        import mitsuba_metallic_roughness

        mitsuba_metallic_roughness.register()
    with tempfile.TemporaryDirectory() as scratch:
        scene = convert(options, scratch)
        width, height = map(int, options.size.split("x"))
        per_pass = options.per_pass or max(8, 2**21 // (width * height))
        if options.variant.startswith("scalar"):
            per_pass = options.spp
        if options.serve:
            return serve(scene, 0 if options.variant.startswith("scalar") else per_pass)
        pictures = [render(scene, options.spp, options.seed + s, per_pass) for s in range(max(options.seeds, 1))]
        np.save(options.output, np.stack(pictures) if options.seeds else pictures[0])


if __name__ == "__main__":
    main()

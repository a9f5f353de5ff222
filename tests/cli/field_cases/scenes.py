# SPDX-License-Identifier: Apache-2.0
"""Scenes far from the origin, mirrored joints, backs of faces, morph targets, files that others draw, and extremes."""

import base64
import json
import math
import struct

import harness


def _same(bench, scene, other, flip, *options):
    """Whether FLIP between the pictures of two scenes is below a number."""
    pictures = []
    for name, of in (("a", scene), ("b", other)):
        result = bench.run_program("render", bench.scene(of), "--size", "192x108", "--spp", "64", "--sampling", "uniform", "--filter", "none",
                                   "--threads", "1", "--quiet", "--overwrite", "-o", f"{name}.exr", *options)
        if result.returncode:
            return False, bench.last_line(result)
        pictures.append(f"{name}.exr")
    result = bench.run_program("compare", *pictures, "--metrics", "flip", "--json")
    if result.returncode:
        return False, bench.last_line(result)
    score = json.loads(result.stdout)["sequence"][0]["scores"][0]["value"]
    return score < flip, f"FLIP {score:.6f}"


def _quad(**members):
    """A quad of 2 m across in front of the camera, lit by nothing but its emission of 0.5."""
    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    data = struct.pack("<12f", *(x for corner in corners for x in corner)) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    gltf = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "translation": [0, 0, -4]}, {"camera": 0}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.4, "znear": 0.01}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [0.5, 0.5, 0.5]}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    }
    gltf.update(members)
    return gltf


def _middle_of(bench, gltf, *options):
    result, picture = bench.render(bench.write("quad.gltf", json.dumps(gltf)), "--spp", "4", "--env", "none", *options)
    return result, picture.pixel(picture.width // 2, picture.height // 2) if picture else None


def _said(bench, gltf, *words):
    """Whether the scene is drawn, with a warning that has these words, and refused under --strict."""
    path = bench.write("quad.gltf", json.dumps(gltf))
    result, picture = bench.render(path, "--spp", "1", "--env", "none", "--frames", "1")
    report = bench.run_program("scene", path).stdout
    missing = [word for word in words if word not in report]
    strict, line = bench.refused(bench.run_program("scene", path, "--strict"), "strict")
    return picture is not None and not missing and strict, f"drawn {picture is not None}, lacks {missing}; strict: {line}"


# Far from the origin: a rigid shift of everything shows the same picture.


def far_by_1e5_m(bench):
    "FLIP to the scene at the origin below 0.001"
    return _same(bench, "far/far5.gltf", "far/far0.gltf", 0.001)


def far_by_1e6_m(bench):
    "FLIP to the scene at the origin below 0.001"
    return _same(bench, "far/far6.gltf", "far/far0.gltf", 0.001)


def far_by_the_radius_of_the_earth(bench):
    "FLIP to the scene at the origin below 0.001"
    return _same(bench, "far/ecef.gltf", "far/far0.gltf", 0.001)


def far_by_an_offset_of_cesium(bench):
    "an emission of 0.5 fills the middle, without a warning"
    offset = {"extensionsUsed": ["CESIUM_RTC"], "extensions": {"CESIUM_RTC": {"center": [4e6, 5e5, 4.8e6]}}}
    path = bench.write("rtc.gltf", json.dumps(_quad(**offset)))
    result, picture = bench.render(path, "--spp", "4", "--env", "none")
    quiet = "warning" not in bench.run_program("scene", path).stdout
    return quiet and bench.near(picture.pixel(48, 27), [0.5] * 3, 1e-6)[0], f"quiet {quiet}, {picture.pixel(48, 27)}"


def far_vertices_are_told_of(bench):
    "vertices 1e6 m from their own origin: float's step there is 2^-23 * 1e6 = 0.12 m, and the scene says so"
    far = _quad(nodes=[{"mesh": 0, "translation": [-1e6, 0, -4]}, {"camera": 0}])
    corners = [(1e6 + x, y, 0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    data = struct.pack("<12f", *(x for corner in corners for x in corner)) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    far["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    del far["accessors"][0]["min"], far["accessors"][0]["max"]
    report = bench.run_program("scene", bench.write("far.gltf", json.dumps(far))).stdout
    told = [line for line in report.splitlines() if "0.12 m" in line]
    return len(told) == 1, told[0] if told else report


# Mirrors and backs.


def joints_mirror_each_by_itself(bench):
    "one mesh with an ordinary and a mirrored joint, as two nodes: FLIP below 0.001 (Blender 5.0.1 draws two equal pictures)"
    return _same(bench, "mirrored-joint/one_skin.gltf", "mirrored-joint/two_nodes.gltf", 0.001)


def _is_red(pixel):
    return pixel[0] > 0.02 and pixel[0] > 3 * max(pixel[1], pixel[2])


def backs_are_seen_and_told_of(bench):
    "by default the near wall is drawn, with a warning that names the share and --cull-back-faces"
    result, picture = bench.render(bench.scene("backface/doll_ss.gltf"), "--spp", "16")
    told = [line for line in result.stderr.splitlines() if "--cull-back-faces" in line and "%" in line]
    return picture is not None and not _is_red(picture.pixel(48, 38)) and len(told) == 1, f"{picture.pixel(48, 38)} {told}"


def backs_are_culled(bench):
    "--cull-back-faces: the red ball behind the near, single-sided wall is seen (glTF 2.0, 3.9.5), without the warning"
    result, picture = bench.render(bench.scene("backface/doll_ss.gltf"), "--spp", "64", "--cull-back-faces")
    quiet = "cull-back-faces" not in result.stderr
    return quiet and _is_red(picture.pixel(48, 38)), f"{picture.pixel(48, 38)}, quiet {quiet}"


def double_sided_walls_stay(bench):
    "--cull-back-faces: the double-sided wall hides the ball"
    result, picture = bench.render(bench.scene("backface/doll_ds.gltf"), "--spp", "16", "--cull-back-faces")
    return not _is_red(picture.pixel(48, 38)), f"{picture.pixel(48, 27)}"


# Morph targets.


def morphed_colours(bench):
    "weight 1 of a target of COLOR_0 / TEXCOORD_0: green"
    r, g, b = bench.picture(bench.scene("morph/morphcolor.gltf"), "--spp", "64").pixel(48, 27)
    return g > 0.02 and g > 3 * max(r, b), f"{r:.4f} {g:.4f} {b:.4f}"


def _with_values(gltf, *arrays):
    """The numbers of accessors that were added for arrays of floats, each of four elements."""
    added = []
    for values in arrays:
        data = struct.pack(f"<{len(values)}f", *values)
        gltf["buffers"].append({"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()})
        gltf["bufferViews"].append({"buffer": len(gltf["buffers"]) - 1, "byteLength": len(data)})
        gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, "count": 4,
                                  "type": {8: "VEC2", 12: "VEC3", 16: "VEC4"}[len(values)]})
        added.append(len(gltf["accessors"]) - 1)
    return added


def morphed_second_coordinates(bench):
    "weight 1 of a target of TEXCOORD_1, by which the picture is read, moves from its red half to its green one"
    bench.write("halves.png", harness.png(16, 16, lambda x, y: (255, 0, 0) if x < 8 else (0, 255, 0)))
    gltf = _quad(images=[{"uri": "halves.png"}], textures=[{"source": 0}])
    base, target = _with_values(gltf, [0.25, 0.5] * 4, [0.5, 0] * 4)
    gltf["meshes"][0].update(weights=[1])
    gltf["meshes"][0]["primitives"][0].update(targets=[{"TEXCOORD_1": target}])
    gltf["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = base
    gltf["materials"][0].update(emissiveFactor=[1, 1, 1], emissiveTexture={"index": 0, "texCoord": 1})
    return bench.near(_middle_of(bench, gltf)[1], (0, 1, 0), 0.01)


def morphed_colours_without_colours(bench):
    "a target of COLOR_0 of a primitive that has none, which glTF 3.7.2.2 forbids: drawn, and said"
    gltf = _quad()
    (target,) = _with_values(gltf, [0, -1, -1, 0] * 4)
    gltf["meshes"][0].update(weights=[1])
    gltf["meshes"][0]["primitives"][0].update(targets=[{"COLOR_0": target}])
    return _said(bench, gltf, "targets[0].COLOR_0")


# Files that other programs draw.


def weights_of_zero(bench):
    "drawn, with a warning; three.js, Babylon.js and Blender bind the vertex to the first joint"
    scene = bench.scene("refused/zero_weights.gltf")
    result, picture = bench.render(scene, "--spp", "4")
    told = "weights of 1 vertices are zero" in result.stderr
    strict, line = bench.refused(bench.run_program("scene", scene, "--strict"), "zero")
    return picture is not None and told and strict, f"{bench.last_line(result)}; strict: {line}"


def a_normal_that_is_no_number(bench):
    "drawn as with a normal of length 0, with a warning"
    scene = bench.scene("refused/nan_NORMAL.gltf")
    result, picture = bench.render(scene, "--spp", "4")
    told = "1 elements are not finite" in result.stderr
    strict, line = bench.refused(bench.run_program("scene", scene, "--strict"), "NORMAL")
    return picture is not None and told and strict, f"{bench.last_line(result)}; strict: {line}"


def a_colour_that_is_no_number(bench):
    "drawn, with a warning; the others stay as they are"
    gltf = _quad()
    (colors,) = _with_values(gltf, [1, 1, 1, 1, math.nan, 1, 1, 1] + [1, 1, 1, 1] * 2)
    gltf["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors
    return _said(bench, gltf, "COLOR_0: 1 elements are not finite")


def weights_of_rounding(bench):
    "weights of 1 and -1e-7, as programs round them: drawn, by the first joint"
    gltf = _quad()
    joints, weights = _with_values(gltf, [0] * 16, [1, -1e-7, 0, 0] * 4)
    gltf["accessors"][joints].update(componentType=5121)  # a float of 0 is four bytes of 0
    gltf["meshes"][0]["primitives"][0]["attributes"].update(JOINTS_0=joints, WEIGHTS_0=weights)
    gltf["nodes"][0]["skin"] = 0
    gltf["nodes"].append({"translation": [0, 0, -4]})
    gltf.update(scenes=[{"nodes": [0, 1, 2]}], skins=[{"joints": [2]}])
    result, pixel = _middle_of(bench, gltf)
    return pixel == (0.5, 0.5, 0.5), f"{pixel} {bench.last_line(result)}"


def a_backslash_by_its_number(bench):
    "tex%5Cgreen.png is tex/green.png: a warning, as of the backslash itself"
    gltf = json.loads(bench.scene("refused/backslash.gltf").read_text())
    (bench.folder / "tex").mkdir(exist_ok=True)
    (bench.folder / "tex/green.png").write_bytes(bench.scene("refused/tex/green.png").read_bytes())
    gltf["images"][0]["uri"] = "tex%5Cgreen.png"
    path = bench.write("number.gltf", json.dumps(gltf))
    report = bench.run_program("scene", path)
    return report.returncode == 0 and "backslash" in report.stdout, bench.last_line(report)


def pictures_on_other_machines(bench):
    "a drive, a file: and a web address: missing pictures, refused and allowed as those that are not there"
    gltf = json.loads(bench.scene("refused/missing.gltf").read_text())
    for uri in ("C:\\Users\\me\\green.png", "C:/Users/me/green.png", "file:///C:/Users/me/green.png", "https://example.com/green.png"):
        gltf["images"][0]["uri"] = uri
        path = bench.write("elsewhere.gltf", json.dumps(gltf))
        refused, line = bench.refused(bench.render(path)[0], "no picture", "green.png", "--allow-missing")
        result, picture = bench.render(path, "--spp", "1", "--allow-missing")
        if not refused or picture is None or "no picture" not in result.stderr:
            return False, f"{uri}: {line}; allowed: {bench.last_line(result)}"
    return True, line


def a_backslash_in_a_uri(bench):
    "tex\\green.png is tex/green.png: a green quad, with a warning"
    scene = bench.scene("refused/backslash.gltf")
    result, picture = bench.render(scene, "--spp", "16")
    if picture is None:
        return False, bench.last_line(result)
    r, g, b = picture.pixel(48, 27)
    return g > 0.02 and g > 3 * max(r, b) and "backslash" in result.stderr, f"{r:.4f} {g:.4f} {b:.4f}"


def a_missing_picture(bench):
    "refused in a line that names --allow-missing; with it, drawn with a warning that names the picture"
    scene = bench.scene("refused/missing.gltf")
    refused, line = bench.refused(bench.render(scene)[0], "no picture", "--allow-missing")
    result, picture = bench.render(scene, "--spp", "4", "--allow-missing")
    return refused and picture is not None and "no picture" in result.stderr, f"{line}; allowed: {bench.last_line(result)}"


def equal_key_times(bench):
    "keys at 0, 1, 1 s, 0 to 0 and from 3 on: at 0.5 s x = 0, from 1 s on x = 3, with a warning"
    data = struct.pack("<3f", 0, 1, 1) + struct.pack("<9f", 0, 0, 0, 0, 0, 0, 3, 0, 0)
    gltf = _quad()
    gltf["buffers"].append({"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()})
    gltf["bufferViews"] += [{"buffer": 1, "byteLength": 12}, {"buffer": 1, "byteOffset": 12, "byteLength": 36}]
    gltf["accessors"] += [{"bufferView": 2, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [1]},
                          {"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC3"}]
    gltf["nodes"].append({"children": [0]})
    gltf["scenes"] = [{"nodes": [1, 2]}]
    gltf["animations"] = [{"samplers": [{"input": 2, "output": 3}],
                           "channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}]}]
    said, text = _said(bench, gltf, "has the time of the one before it")
    shown = [_middle_of(bench, gltf, "--start", start, "--fps", "1000", "--frames", "1")[1] for start in ("0.5s", "1.5s")]
    return said and shown[0] == (0.5, 0.5, 0.5) and shown[1] == (0, 0, 0), f"{shown} {text}"


def extensions_that_change_no_picture(bench):
    "required variants, XMP, visibility, behaviours and avatars: drawn, named in a warning; refused under --strict"
    names = ["KHR_materials_variants", "KHR_xmp_json_ld", "KHR_xmp", "KHR_node_visibility", "KHR_interactivity", "VRMC_vrm",
             "KHR_physics_rigid_bodies", "AGI_articulations"]
    for name in names:
        good, got = _said(bench, _quad(extensionsUsed=[name], extensionsRequired=[name]), name)
        if not good:
            return False, f"{name}: {got}"
    return True, f"all {len(names)}"


def hidden_nodes(bench):
    "KHR_node_visibility, visible false: the quad is not drawn"
    gltf = _quad(extensionsUsed=["KHR_node_visibility"])
    gltf["nodes"].append({"mesh": 0, "translation": [0, 0, -9]})
    gltf["scenes"][0]["nodes"].append(2)
    gltf["nodes"][0]["extensions"] = {"KHR_node_visibility": {"visible": False}}
    gltf["nodes"][0]["scale"] = [0.1, 0.1, 0.1]
    report = bench.run_program("scene", bench.write("hidden.gltf", json.dumps(gltf))).stdout
    return "1 instances" in report, next(line for line in report.splitlines() if "instances" in line)


# Bounds, and extremes.


def bounds_of_a_turned_node(bench):
    "a square of 2 m, a diamond within it, turned by 45 degrees under a node: the corners of its vertices, sqrt(1/2) m"
    data = struct.pack("<12f", -1, 0, 0, 0, -1, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    gltf = _quad()
    gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    gltf["nodes"][0] = {"mesh": 0, "rotation": [0, 0, math.sin(math.pi / 8), math.cos(math.pi / 8)]}
    report = json.loads(bench.run_program("scene", bench.write("turned.gltf", json.dumps(gltf)), "--json").stdout)
    got = report["bounds_m"]["min"][:2] + report["bounds_m"]["max"][:2]
    half = math.sqrt(0.5)
    return bench.near(got, [-half, -half, half, half], 1e-6)


def lamps_of_1e38(bench):
    "no infinite pixel without a word: the intensity is said to be clamped"
    lamp = {"type": "point", "intensity": 1e38}
    gltf = _quad(extensionsUsed=["KHR_lights_punctual"], extensions={"KHR_lights_punctual": {"lights": [lamp]}})
    gltf["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [1, 1, 1, 1]
    gltf["nodes"].append({"translation": [0, 0, -3.9], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    gltf["scenes"][0]["nodes"].append(2)
    result, pixel = _middle_of(bench, gltf)
    return all(map(math.isfinite, pixel)) and "intensity is above 1e30" in result.stderr, f"{pixel} {bench.last_line(result)}"


def lamps_of_less_than_nothing(bench):
    "an intensity of -5: no light, and said"
    lamp = {"type": "point", "intensity": -5}
    gltf = _quad(extensionsUsed=["KHR_lights_punctual"], extensions={"KHR_lights_punctual": {"lights": [lamp]}})
    gltf["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [1, 1, 1, 1]
    gltf["nodes"].append({"translation": [0, 0, -3.9], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    gltf["scenes"][0]["nodes"].append(2)
    result, pixel = _middle_of(bench, gltf)
    return pixel == (0.5, 0.5, 0.5) and "intensity is negative" in result.stderr, f"{pixel} {bench.last_line(result)}"


def emission_of_1e38(bench):
    "rendered as 1e30, and said"
    gltf = _quad(extensionsUsed=["KHR_materials_emissive_strength"])
    gltf["materials"][0]["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": 1e38}}
    result, pixel = _middle_of(bench, gltf)
    return abs(pixel[0] / 1e30 - 1) < 1e-6 and "emission is above 1e30" in result.stderr, f"{pixel} {bench.last_line(result)}"


def an_index_of_refraction_below_1(bench):
    "0.5 is neither 0 nor at least 1 (KHR_materials_ior): said to be clamped"
    gltf = _quad(extensionsUsed=["KHR_materials_ior"])
    gltf["materials"][0]["extensions"] = {"KHR_materials_ior": {"ior": 0.5}}
    result = _middle_of(bench, gltf)[0]
    return "ior" in result.stderr and "clamped" in result.stderr, bench.last_line(result)


def samples_whose_sum_is_infinite(bench):
    "a radiance of 3e38 from all around, 4 samples: what cannot be summed is counted, and no pixel is infinite without a word"
    gltf = _quad()
    gltf["nodes"][0]["translation"] = [0, 0, 4]
    result, picture = bench.render(bench.write("quad.gltf", json.dumps(gltf)), "--spp", "4", "--env", "constant:3e38,3e38,3e38")
    pixel = picture.pixel(48, 27)
    return (all(map(math.isfinite, pixel)) or "not finite" in result.stderr) and "not finite" in result.stderr, f"{pixel} {bench.last_line(result)}"

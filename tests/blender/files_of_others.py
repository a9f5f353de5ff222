# SPDX-License-Identifier: Apache-2.0
"""Writes the scene of files.py by programs that are not Blender, from what files.py wrote into a folder.

    python3 files_of_others.py FOLDER        (a Python with usd-core and trimesh; assimp's program on the PATH)

others.usda, others.usdz                  by Pixar's usd-core, from the numbers below: a RectLight, a camera with time samples
coloured.trimesh.obj, bare.trimesh.ply    by trimesh, from the glTF
coloured.assimp.fbx, coloured.assimp.obj  by assimp, from the glTF
"""

import math
import shutil
import subprocess
import sys
from pathlib import Path

# As in files.py.
FRAMES, FPS = 5, 24
WATTS, WIDTH_M, HEIGHT_M = 80.0, 1.5, 1.0


def write_usd(folder: Path) -> None:
    """z up, metres."""
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdUtils

    import trimesh

    stage = Usd.Stage.CreateNew(str(folder / "others.usda"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(FRAMES)
    stage.SetTimeCodesPerSecond(FPS)
    root = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(root.GetPrim())
    made = trimesh.load(folder / "coloured.glb")
    for name in ("floor", "block"):
        transform, geometry = made.graph[name]
        mesh = made.geometry[geometry].copy()
        mesh.apply_transform(transform)
        points = [(float(x), float(-z), float(y)) for x, y, z in mesh.vertices]  # from y up
        prim = UsdGeom.Mesh.Define(stage, f"/World/{name}")
        prim.CreatePointsAttr(points)
        prim.CreateFaceVertexCountsAttr([3] * len(mesh.faces))
        prim.CreateFaceVertexIndicesAttr(mesh.faces.ravel().tolist())
        prim.CreateSubdivisionSchemeAttr("none")
        material = UsdShade.Material.Define(stage, f"/World/materials/{name}")
        surface = UsdShade.Shader.Define(stage, f"/World/materials/{name}/surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1)
        surface.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(0)
        colour = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
        if name == "block":
            uv = UsdGeom.PrimvarsAPI(prim).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
            uv.Set([(float(u), float(v)) for u, v in mesh.visual.uv])
            reader = UsdShade.Shader.Define(stage, f"/World/materials/{name}/st")
            reader.CreateIdAttr("UsdPrimvarReader_float2")
            reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
            texture = UsdShade.Shader.Define(stage, f"/World/materials/{name}/texture")
            texture.CreateIdAttr("UsdUVTexture")
            texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set("./checks.png")
            texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
            texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
                reader.CreateOutput("result", Sdf.ValueTypeNames.Float2))
            colour.ConnectToSource(texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
        else:
            colour.Set(Gf.Vec3f(0.5, 0.5, 0.5))
        material.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", Sdf.ValueTypeNames.Token))
        UsdShade.MaterialBindingAPI.Apply(prim.GetPrim()).Bind(material)
    light = UsdLux.RectLight.Define(stage, "/World/panel")  # shines along its -z
    light.CreateWidthAttr(WIDTH_M)
    light.CreateHeightAttr(HEIGHT_M)
    light.CreateIntensityAttr(WATTS / (math.pi * WIDTH_M * HEIGHT_M))
    UsdGeom.XformCommonAPI(light).SetTranslate((0.2, -0.3, 2.5))
    camera = UsdGeom.Camera.Define(stage, "/World/eye")
    camera.CreateFocalLengthAttr(35)
    camera.CreateHorizontalApertureAttr(36)
    camera.CreateVerticalApertureAttr(36 * 9 / 16)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    move = UsdGeom.XformCommonAPI(camera)
    move.SetRotate((65, 0, 45))
    for frame, place in enumerate(camera_places(folder), 1):
        move.SetTranslate(place, frame)
    stage.Save()
    UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(folder / "others.usda")), str(folder / "others.usdz"))


def camera_places(folder: Path) -> list:
    """Of each frame, as the glTF has them, which was keyed with an ease."""
    import json
    import struct

    data = (folder / "lit.glb").read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + size]), data[20 + size + 8 :]
    nodes = document["nodes"]
    for animation in document["animations"]:
        for channel in animation["channels"]:
            node = nodes[channel["target"]["node"]]
            if channel["target"]["path"] == "translation" and "camera" in str(node).lower():
                sampler = animation["samplers"][channel["sampler"]]
                accessor = document["accessors"][sampler["output"]]
                offset = document["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
                values = [struct.unpack_from("<3f", binary, offset + 12 * i) for i in range(accessor["count"])]
                return [(x, -z, y) for x, y, z in values]
    raise SystemExit("lit.glb: no camera moves")


def write_by_trimesh(folder: Path) -> None:
    import trimesh

    scene = trimesh.load(folder / "coloured.glb")
    scene.export(folder / "coloured.trimesh.obj")
    bare = trimesh.load(folder / "bare.glb").to_geometry()
    bare.apply_transform(trimesh.transformations.rotation_matrix(math.pi / 2, (1, 0, 0)))  # PLY states no axis; z is up in Blender
    bare.export(folder / "bare.trimesh.ply")


def write_by_assimp(folder: Path) -> None:
    for suffix, form in (("fbx", "-ffbxa"), ("obj", "-fobj")):  # its binary FBX is damaged by 5.2
        subprocess.run(["assimp", "export", folder / "coloured.glb", folder / f"coloured.assimp.{suffix}", form], check=True, capture_output=True)


def main(folder: Path) -> None:
    write_usd(folder)
    write_by_trimesh(folder)
    if shutil.which("assimp"):
        write_by_assimp(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

# SPDX-License-Identifier: Apache-2.0
"""`gazetrace import`: scenes of other programs as glTF, read by Blender's module (bpy) and written as the add-on for Blender
writes them: area lights as meshes, everything that moves as keys, the world as a picture."""

import argparse
import importlib.util
import json
import math
import os
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

from .command_line import Parser, add_json_option, check_output, say, with_json_joined, write
from .errors import Error
from .import_materials import settle

DESCRIPTION = """Turn a scene of another program into glTF by Blender's importers: USD, Alembic, OBJ, FBX, PLY, STL and .blend. The
video's frame 1 is the first frame of the file. What glTF cannot hold is listed. Blender's module is needed: 'pip install bpy'
in a Python of the version that it was made for, which GAZETRACE_BPY_PYTHON names if it is another one."""

# The operators that read a kind of file, newest first, with their arguments.
READERS = {
    ".usd": [("wm.usd_import", {})],
    ".abc": [("wm.alembic_import", {"as_background_job": False})],
    ".obj": [("wm.obj_import", {})],
    ".fbx": [("wm.fbx_import", {}), ("import_scene.fbx", {})],
    ".ply": [("wm.ply_import", {})],
    ".stl": [("wm.stl_import", {})],
}
# What a kind of file does not hold, or Blender does not read of it.
WITHOUT = {
    ".abc": "lights and materials",
    ".usd": "Blender's strength of gloss: surfaces reflect as their index of refraction says",
    ".obj": "cameras, lights and motion; the gloss of other programs than Blender is a guess after Phong's model",
    ".fbx": "the size of area lights, which are taken for points",
    ".ply": "cameras, lights, materials and motion",
    ".stl": "cameras, lights, materials and motion",
}
for suffix_of_usd in (".usda", ".usdc", ".usdz"):
    READERS[suffix_of_usd], WITHOUT[suffix_of_usd] = READERS[".usd"], WITHOUT[".usd"]


def parse(words):
    parser = Parser("gazetrace import", usage="gazetrace import FILE -o SCENE.glb [options]", description=DESCRIPTION,
                    formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="the scene")
    parser.add_argument("-o", "--output", required=True, type=Path, metavar="SCENE.glb", help="the scene as binary glTF")
    parser.add_argument("--overwrite", action="store_true", help="replaces an existing file")
    add_json_option(parser)
    return parser.parse_args(with_json_joined(words))


def blender():
    """Blender's module, in this Python or in the one that GAZETRACE_BPY_PYTHON names."""
    other = os.environ.get("GAZETRACE_BPY_PYTHON", "")
    if importlib.util.find_spec("bpy") is None:
        if other and not os.environ.get("GAZETRACE_IMPORT_TRIED"):
            os.execve(other, [other, *sys.argv], {**os.environ, "GAZETRACE_IMPORT_TRIED": "1"})
        version = f"{sys.version_info[0]}.{sys.version_info[1]}"
        raise Error(f"'gazetrace import' needs Blender's module: 'pip install bpy' in a Python that has one (this is {version}; bpy 5.0.1 "
                    "is for 3.11), and name that Python in GAZETRACE_BPY_PYTHON", "runtime")
    import bpy
    sources = Path(__file__).resolve().parents[2] / "blender"  # where the package lies in the sources
    if sources.is_dir():
        sys.path.insert(0, str(sources))
    return bpy


def read(bpy, path):
    """Replaces what is open in Blender by the file."""
    suffix = path.suffix.lower()
    whole = str(path.resolve())  # Blender takes relative paths from $PWD, which may be another folder
    if not path.is_file():
        raise Error(f"{path}: is not a file", "input")
    if suffix != ".blend" and suffix not in READERS:
        raise Error(f"{path}: is none of .blend, {', '.join(READERS)}; save it as one of them", "input")
    try:
        if suffix == ".blend":
            bpy.ops.wm.open_mainfile(filepath=whole, load_ui=False, use_scripts=False)
            return
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for name, options in READERS[suffix]:
            group, _, operator = name.partition(".")
            if operator in dir(getattr(bpy.ops, group)):
                if getattr(getattr(bpy.ops, group), operator)(filepath=whole, **options) != {"FINISHED"}:
                    raise RuntimeError("Blender's importer gave up")
                break
        else:
            raise Error(f"{path}: this Blender has no importer for it", "input")
    except RuntimeError as problem:
        raise Error(f"{path}: Blender cannot read it: {' '.join(str(problem).split())}", "input") from problem
    if not bpy.data.objects:
        raise Error(f"{path}: Blender finds nothing in it", "input")


def settle_frames(bpy, suffix):
    """The range of frames: of a .blend its own, else that of its keys, which importers do not all set."""
    scene = bpy.context.scene
    if suffix != ".blend":
        ends = [end for action in bpy.data.actions for end in action.frame_range]
        ends += [end for cache in bpy.data.cache_files for end in (scene.frame_start, scene.frame_end)]
        if suffix.startswith(".usd") and ends:
            ends += [scene.frame_start, scene.frame_end]
        scene.frame_start, scene.frame_end = (math.floor(min(ends)), math.ceil(max(ends))) if ends else (1, 1)
    return scene


def moments(scene):
    """The frames of the scene, with the first in the middle of the video's frame 1."""
    from gazetrace_blender.frames import FrameRange

    class Take(FrameRange):
        def seconds(self, frame):
            return float(max(frame - self.first + Fraction(1, 2), 0) / self.fps)

    base = Fraction(str(round(scene.render.fps_base, 6)))
    return Take(scene.frame_start, scene.frame_end, 1, scene.render.fps / base)


def place_cameras(scene, document):
    """Gives each camera the projection that Blender's own frame has; the names of those that have none, and why."""
    from gazetrace_blender.camera import picture_size, projection
    from gazetrace_blender.export import place_camera
    from gazetrace_blender.refusal import Refusal
    lost = []
    for item in scene.objects:
        if item.type == "CAMERA" and not item.hide_render:
            try:
                if item.data.type == "PANO":
                    raise Refusal("is panoramic", "")
                place_camera(document, item.name, projection(item.data, *picture_size(scene)), item.name)
            except Refusal as refusal:
                lost.append(f"Camera '{item.name}' is left out: {str(refusal).rstrip('; ')}.")
    return lost


def convert(scene, suffix, output, lost_of_materials):
    """The bytes of the glTF file, of the world's picture where there is one, and what is lost."""
    from gazetrace_blender import world
    from gazetrace_blender.export import export_moving, left_out
    take = moments(scene)
    lost = [f"{suffix[1:].upper()} comes without {WITHOUT[suffix]}."] if suffix in WITHOUT else []
    lost += lost_of_materials + left_out(scene)
    picture = None
    with tempfile.TemporaryDirectory(prefix="gazetrace_") as made:
        path = Path(made) / "scene.glb"
        glb = export_moving(scene, take, path)
        lost += place_cameras(scene, glb.document)
        if scene.world is not None:
            world.bake(scene, Path(made) / "world.exr")
            picture = (Path(made) / "world.exr").read_bytes()
            name = output.with_suffix(".world.exr").name
            of_scene = glb.document["scenes"][glb.document.get("scene", 0)]
            of_scene.setdefault("extras", {})["gazetrace"] = {"environment": name}
        glb.write(path)
        return path.read_bytes(), picture, lost, glb.document, take


def main(words):
    arguments = parse(words)
    output = arguments.output
    if output.suffix.lower() != ".glb":
        raise Error(f"{output}: is no name of binary glTF; give one that ends with .glb")
    check_output(output, arguments.overwrite, [arguments.file])
    bpy = blender()
    told = os.dup(1)  # Blender prints on the standard output whatever it does
    os.dup2(2, 1)
    try:
        read(bpy, arguments.file)
        suffix = arguments.file.suffix.lower()
        scene = settle_frames(bpy, suffix)
        content, picture, lost, document, take = convert(scene, suffix, output, settle(bpy, arguments.file))
    finally:
        os.dup2(told, 1)
    write(output, content)
    if picture is not None:
        write(output.with_suffix(".world.exr"), picture)
    cameras = [node["name"] for node in document.get("nodes", []) if "camera" in node]
    result = {"scene": str(output), "meshes": len(document.get("meshes", [])), "cameras": cameras, "frames": take.last - take.first + 1,
              "first_frame": take.first, "fps": str(take.fps), "environment": picture is not None, "lost": lost}
    text = f"{output}: {result['meshes']} meshes, {len(cameras)} cameras{': ' + ', '.join(cameras) if cameras else ''}\n"
    if result["frames"] > 1:
        text += f"frames 1 to {result['frames']} at {take.fps} a second are {take.first} to {take.last} of {arguments.file.name}: --fps {take.fps}\n"
    text += "".join(f"lost: {sentence}\n" for sentence in lost)
    say(text, result, arguments.json)
    sys.stdout.flush()
    os._exit(0)  # bpy can crash while Python takes itself down, after all is done

# SPDX-License-Identifier: Apache-2.0
"""A sample map of `gazetrace plan --write-sample-maps` in LuxCore: the error inside 5 degrees of the gaze and beyond 15, with the
map and without it, at equal samples.

    python3 tests/benchmarks/sample_maps_in_luxcore.py --program build/release/bin/gazetrace

In a Python with pyluxcore, openimageio, trimesh and pillow. The shipped courtyard, without what is instanced, all of it matte with
its colours, under its sky. The reference has as many samples in every pixel. Prints a table.
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pyluxcore
import trimesh

ROOT = Path(__file__).resolve().parents[2]
COURTYARD = ROOT / "scenes/courtyard"
SCREEN = ["--screen", "paper"]


def picture(path, channel=None):
    """Rows from the top."""
    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT)
    return pixels if channel is None else pixels[:, :, image.spec().channelnames.index(channel)]


def plan(program, arguments, folder):
    """Camera, map and eccentricity of the frame."""
    job = [*SCREEN, "--gaze-at", arguments.gaze_at, "--size", arguments.size, "--density", arguments.density]
    scene = [str(COURTYARD / "courtyard.gltf"), "--camera", "still"]
    subprocess.run([program, "plan", *job, "--write-sample-maps", folder / "map.exr"], check=True, capture_output=True)
    subprocess.run([program, "render", *scene, *job, "--spp", "1", "--filter", "none", "--map", folder / "seen.exr", "-o", folder / "seen.png",
                    "--quiet"], check=True, capture_output=True)
    told = json.loads(subprocess.run([program, "plan", *scene, *job, "--json", "-"], check=True, capture_output=True, text=True).stdout)
    return told["frames"][0]["camera"], picture(folder / "map.exr", "Y"), picture(folder / "seen.exr", "eccentricity")


def rows_of(array):
    """As LuxCore takes them."""
    return [tuple(row) for row in array.tolist()]


def turned(quaternion, vector):
    axis, w = np.array(quaternion[:3]), quaternion[3]
    crossed = 2 * np.cross(axis, vector)
    return vector + w * crossed + np.cross(axis, crossed)


def add_courtyard(scene, camera, folder):
    """y is up here, too."""
    prop = pyluxcore.Property
    position = np.array(camera["position_m"])
    target = position + turned(camera["orientation_xyzw"], np.array([0, 0, -1.0]))
    up = turned(camera["orientation_xyzw"], np.array([0, 1.0, 0]))
    # LuxCore's field of view is that of the shorter side.
    props = [prop("scene.camera.type", "perspective"), prop("scene.camera.lookat.orig", position.tolist()),
             prop("scene.camera.lookat.target", target.tolist()), prop("scene.camera.up", up.tolist()),
             prop("scene.camera.fieldofview", camera["yfov_deg"]), prop("scene.lights.sky.type", "infinite"),
             prop("scene.lights.sky.file", str(COURTYARD / "dusk.hdr")), prop("scene.lights.sky.gamma", 1.0),
             prop("scene.lights.sky.transformation", [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1])]
    made = trimesh.load(COURTYARD / "courtyard.gltf")
    images = {}
    for number, name in enumerate(made.graph.nodes_geometry):
        transform, geometry = made.graph[name]
        mesh = made.geometry[geometry]
        material = mesh.visual.material
        points = trimesh.transform_points(mesh.vertices, transform)
        uv = getattr(mesh.visual, "uv", None)
        colour = [float(x) / 255 for x in (material.baseColorFactor if material.baseColorFactor is not None else [204] * 4)[:3]]
        value = " ".join(map(str, colour))
        if material.baseColorTexture is not None and uv is not None:
            texture = f"texture{id(material.baseColorTexture)}"
            if texture not in images:
                images[texture] = folder / f"{texture}.png"
                material.baseColorTexture.convert("RGB").save(images[texture])
                props += [prop(f"scene.textures.{texture}.type", "imagemap"), prop(f"scene.textures.{texture}.file", str(images[texture]))]
            value = texture
        scene.DefineMesh(f"mesh{number}", rows_of(points), rows_of(mesh.faces), None,
                         None if uv is None else rows_of(uv), None, None)
        props += [prop(f"scene.materials.m{number}.type", "matte"), prop(f"scene.materials.m{number}.kd", value),
                  prop(f"scene.objects.o{number}.shape", f"mesh{number}"), prop(f"scene.objects.o{number}.material", f"m{number}")]
        if material.emissiveFactor is not None and max(material.emissiveFactor) > 0:
            props += [prop(f"scene.materials.m{number}.emission", [float(x) for x in material.emissiveFactor])]
    together = pyluxcore.Properties()
    for each in props:
        together.Set(each)
    scene.Parse(together)


def render(scene, width, height, spp, seed, importance=None):
    """Radiance, samples of each pixel, and the time."""
    prop, config = pyluxcore.Property, pyluxcore.Properties()
    for each in (prop("renderengine.type", "PATHCPU"), prop("renderengine.seed", seed), prop("sampler.type", "SOBOL"),
                 prop("film.width", width), prop("film.height", height), prop("film.filter.type", "NONE"),
                 prop("path.pathdepth.total", 8), prop("path.clamping.variance.maxvalue", 0), prop("batch.haltspp", spp),
                 prop("film.outputs.0.type", "RGB"), prop("film.outputs.0.filename", "rgb.exr"),
                 prop("film.outputs.1.type", "SAMPLECOUNT"), prop("film.outputs.1.filename", "samples.exr"),
                 prop("film.outputs.2.type", "USER_IMPORTANCE"), prop("film.outputs.2.filename", "importance.exr"),
                 prop("sampler.sobol.adaptive.strength", 0.0 if importance is None else 1.0),
                 prop("sampler.sobol.adaptive.userimportanceweight", 1.0)):
        config.Set(each)
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(config, scene))
    film = session.GetFilm()
    began = time.monotonic()
    session.Start()
    if importance is not None:  # whose channel is there from the start on only
        film.UpdateOutputFloat(pyluxcore.FilmOutputType.USER_IMPORTANCE, np.ascontiguousarray(importance[::-1], dtype=np.float32))
    while not session.HasDone():
        session.UpdateStats()
        time.sleep(0.05)
    session.Stop()
    took = time.monotonic() - began
    colour = np.zeros((height, width, 3), np.float32)
    samples = np.zeros((height, width), np.uint32)
    film.GetOutputFloat(pyluxcore.FilmOutputType.RGB, colour)
    film.GetOutputUInt(pyluxcore.FilmOutputType.SAMPLECOUNT, samples)
    return colour[::-1], samples[::-1], took


def relative_error(pictures, reference):
    """Of each pixel: squared error over squared luminance, the mean of pictures by different seeds."""
    luminance = reference @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    return np.mean([np.mean((one - reference) ** 2, axis=2) / (luminance**2 + 0.01) for one in pictures], axis=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--gaze-at", default="0.5,0.5")
    parser.add_argument("--density", default="geisler-perry")
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--pictures", type=Path, help="a folder for the first picture of each")
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    pyluxcore.Init(lambda text: None)
    with tempfile.TemporaryDirectory(prefix="gazetrace_lux_") as made:
        camera, density, eccentricity = plan(arguments.program.resolve(), arguments, Path(made))
        scene = pyluxcore.Scene()
        add_courtyard(scene, camera, Path(made))
        reference, _, _ = render(scene, width, height, arguments.reference_spp, 100)
        print(f"map: mean {density.mean():.3f}, least {density.min():.4f}, most {density.max():.3f}")
        print("| | samples a pixel: all | inside 5 degrees | beyond 15 | relative MSE: inside 5 degrees | beyond 15 | all | s |")
        print("| --- | --- | --- | --- | --- | --- | --- | --- |")
        near, far, whole = eccentricity < 5, eccentricity > 15, eccentricity >= 0
        for name, importance in (("without", None), ("with the map", density)):
            runs = [render(scene, width, height, arguments.spp, seed, importance) for seed in range(1, arguments.seeds + 1)]
            error = relative_error([run[0] for run in runs], reference)
            samples = np.mean([run[1] for run in runs], axis=0)
            numbers = [f"{samples[where].mean():.2f}" for where in (whole, near, far)]
            numbers += [f"{error[where].mean():.4g}" for where in (near, far, whole)]
            print(f"| {name} | {' | '.join(numbers)} | {np.mean([run[2] for run in runs]):.1f} |", flush=True)
            if arguments.pictures:
                shown = np.clip(runs[0][0] / (4 * np.median(runs[0][0])), 0, 1) ** (1 / 2.2)
                oiio.ImageBuf(np.ascontiguousarray(shown)).write(str(arguments.pictures / f"{'even' if importance is None else 'map'}.png"))
    pyluxcore.SetLogHandler(None)


if __name__ == "__main__":
    main()

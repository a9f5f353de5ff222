#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every glTF file below a folder rendered small and put on one sheet, to be looked at.

  contact_sheet.py GAZETRACE FOLDER OUT.png [options of `gazetrace render` ...]

Files with lights or strong emission of their own are shown in those; the others under the built-in sky unless --env says
otherwise. A file that is refused leaves its one-line reason. Needs Pillow.
"""

import argparse
import pathlib
import subprocess
import tempfile
import textwrap

from PIL import Image, ImageDraw

WIDTH, HEIGHT, LABEL = 320, 180, 16


def environment(scene):
    """Labels that shine a little are no light to see by."""
    text = scene.read_bytes()
    return "auto" if b"KHR_lights_punctual" in text or b"KHR_materials_emissive_strength" in text else "sky"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("output")
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--spp", default="64")
    arguments, extra = parser.parse_known_args()
    scenes = sorted([*arguments.folder.rglob("*.gltf"), *arguments.folder.rglob("*.glb")])
    rows = (len(scenes) + arguments.columns - 1) // arguments.columns
    sheet = Image.new("RGB", (arguments.columns * WIDTH, rows * (HEIGHT + LABEL)), "white")
    draw = ImageDraw.Draw(sheet)
    with tempfile.TemporaryDirectory() as name:
        picture = pathlib.Path(name) / "f.png"
        for i, scene in enumerate(scenes):
            x, y = i % arguments.columns * WIDTH, i // arguments.columns * (HEIGHT + LABEL)
            draw.text((x + 4, y + 2), scene.stem, fill="black")
            light = [] if "--env" in extra else ["--env", environment(scene)]
            done = subprocess.run(
                [arguments.program, "render", scene, "-o", picture, "--size", f"{WIDTH}x{HEIGHT}", "--spp", arguments.spp,
                 "--frames", "1", "--bounces", "8", "--quiet", "--overwrite", *light, *extra], stderr=subprocess.PIPE, text=True)
            if done.returncode == 0:
                sheet.paste(Image.open(picture), (x, y + LABEL))
            else:
                draw.multiline_text((x + 4, y + LABEL), "\n".join(textwrap.wrap(done.stderr.strip(), 48)), fill="black")
    sheet.save(arguments.output)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""Pictures within a page: as they are where they fit, else reduced, then as JPEG of fewer frames."""

import base64
import io
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy
from PIL import Image

from . import words

LEAST_WIDTH = 480  # pictures are not reduced below this
QUALITY, LEAST_QUALITY = 90, 75  # of JPEG
SAMPLED = 6        # pictures from which sizes are predicted
UNREADABLE = (OSError, ValueError, SyntaxError, Image.DecompressionBombError)  # as Pillow says it


@dataclass
class Form:
    block: int = 1  # pixels are averaged over blocks of so many pixels a side
    jpeg: bool = False
    step: int = 1   # every so-manyth frame
    quality: int = QUALITY


@dataclass
class Embedded:
    uri: str
    width: int
    height: int


@dataclass
class Pictures:
    of_path: dict
    statement: str
    warnings: list


def data_uri(data, kind):
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def averaged(image, block):
    """Averages blocks of pixels in linear light; the last block of a row or column may be smaller."""
    code = numpy.asarray(image, dtype=numpy.float64) / 255
    light = numpy.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    for axis in (0, 1):
        begins = numpy.arange(0, light.shape[axis], block)
        lengths = numpy.diff(numpy.append(begins, light.shape[axis]))
        light = numpy.add.reduceat(light, begins, axis) / lengths.reshape([-1 if i == axis else 1 for i in range(3)])
    code = numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return Image.fromarray(numpy.rint(255 * code.clip(0, 1)).astype(numpy.uint8))


def embed(path, form):
    data = path.read_bytes()
    image = Image.open(io.BytesIO(data))
    width, height = image.size
    if not form.jpeg and image.format in ("PNG", "JPEG"):
        image.load()  # a broken file is found here
        return Embedded(data_uri(data, image.format.lower()), width, height)
    image = image.convert("RGB")
    out = io.BytesIO()
    (averaged(image, form.block) if form.block > 1 else image).save(out, "JPEG" if form.jpeg else "PNG", **({"quality": form.quality, "subsampling": 0} if form.jpeg else {}))
    return Embedded(data_uri(out.getvalue(), "jpeg" if form.jpeg else "png"), width, height)


def forms(width, frames):
    """From the best to the smallest."""
    blocks = [block for block in (2, 3, 4, 6, 8, 12, 16) if width // block >= LEAST_WIDTH]
    yield from (Form(), Form(1, True), *(Form(block, True) for block in blocks))
    step = 1
    while step < 2 * frames:
        yield Form(blocks[-1] if blocks else 1, True, step, LEAST_QUALITY)
        step *= 2


def embed_all(paths_of_frames, most_bytes):
    """`paths_of_frames`: of each frame, in the order of time, its pictures. Warns of those that cannot be read."""
    every = list(dict.fromkeys(path for of_frame in paths_of_frames for path in of_frame))
    sampled, first = [], None
    for i in range(min(SAMPLED, len(every))):
        path = every[i * len(every) // min(SAMPLED, len(every))]
        try:
            size = embed(path, Form())
            sampled.append(path)
            first = first or size
        except UNREADABLE:
            pass  # warned about when all are read
    if not sampled:
        return Pictures({}, "There are no pictures.", [f"no picture could be read, such as {every[0]}"] if every else [])
    with ThreadPoolExecutor() as pool:
        for form in forms(first.width, len(paths_of_frames)):
            paths = list(dict.fromkeys(path for of_frame in paths_of_frames[::form.step] for path in of_frame))
            foretold = sum(len(embed(path, form).uri) for path in sampled) / len(sampled) * len(paths)
            if foretold > 1.3 * most_bytes:  # it is a guess
                continue
            done = list(pool.map(lambda path: _tried(path, form), paths))
            good = {path: one for path, one in zip(paths, done) if isinstance(one, Embedded)}
            if sum(len(one.uri) for one in good.values()) <= most_bytes:
                return Pictures(good, _statement(form, first, len(paths_of_frames)), [one for one in done if isinstance(one, str)])
    return Pictures({}, "No picture fits into the page's limit.", [])


def _tried(path, form):
    try:
        return embed(path, form)
    except UNREADABLE as problem:
        return f"{path}: cannot be read as a picture: {problem}"


def _statement(form, first, frames):
    size = f"{first.width} x {first.height} pixels"
    text = (f"Pictures are shown at full size, {size}" if form.block == 1 else
            f"Pictures are reduced from {size} by averaging {form.block} x {form.block} of them in linear light")
    text += f", as JPEG of quality {form.quality}: small differences are its own" if form.jpeg else ", without loss"
    return text + (f"; every {words.ordinal(form.step)} of {frames} frames" if form.step > 1 else "") + "."

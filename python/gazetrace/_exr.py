# SPDX-License-Identifier: Apache-2.0
"""The simplest EXR: channels of 32-bit floats, without compression.

The layout is that of "OpenEXR File Layout" (openexr.com): magic number and version, attributes, a table of offsets, and
one block a line.
"""

import struct

import numpy as np

from ._errors import Error


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def write_gray_exr(path, array):
    pixels = np.asarray(array)
    if pixels.ndim != 2 or pixels.size == 0:
        raise Error("`density`: is not an array of the shape (height, width)")
    write_exr(path, {"Y": pixels})


def write_exr(path, channels):
    """`channels`: arrays of one shape by their names."""
    names = sorted(channels)  # as the format wants them
    height, width = channels[names[0]].shape
    lines = np.stack([np.ascontiguousarray(channels[name], dtype="<f4") for name in names], 1)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    float_pixels, uncompressed, increasing_y = 2, b"\0", b"\0"
    header = struct.pack("<2i", 20000630, 2)
    header += _attribute("channels", "chlist", b"".join(name.encode() + b"\0" + struct.pack("<i4x2i", float_pixels, 1, 1) for name in names) + b"\0")
    header += _attribute("compression", "compression", uncompressed)
    header += _attribute("dataWindow", "box2i", window)
    header += _attribute("displayWindow", "box2i", window)
    header += _attribute("lineOrder", "lineOrder", increasing_y)
    header += _attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += _attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += b"\0"
    line_bytes = 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = first + np.arange(height, dtype="<u8") * (8 + line_bytes)
    with open(path, "wb") as file:
        file.write(header)
        file.write(offsets.tobytes())
        for y in range(height):
            file.write(struct.pack("<2i", y, line_bytes))
            file.write(lines[y].tobytes())

# SPDX-License-Identifier: Apache-2.0
"""Picture files from plain Python: PNG (8 bits, 1 to 4 channels) and Radiance HDR (run-length encoded)."""
import math
import struct
import zlib


def write_png(path, width, height, pixel):
    """`pixel(x, y)` -> a tuple of 1, 3 or 4 values 0..1, as they stand in the file (sRGB-encoded for colours)."""
    rows = []
    for y in range(height):
        row = bytearray()
        for x in range(width):
            for value in pixel(x, y):
                row.append(min(255, max(0, int(value * 255.0 + 0.5))))
        rows.append(bytes(row))
    channels = len(rows[0]) // width
    color_type = {1: 0, 3: 2, 4: 6}[channels]

    def chunk(tag, data):
        return struct.pack(">I", len(data)) + tag + data + struct.pack(">I", zlib.crc32(tag + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color_type, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(_filtered(rows, channels), 9)))
        file.write(chunk(b"IEND", b""))


def _filtered(rows, channels):
    """Each row by the PNG filter (none, left, up, average) with the least sum of absolute differences."""
    out = bytearray()
    above = bytes(len(rows[0]))
    for row in rows:
        left = bytes(channels) + row[:-channels]
        candidates = (
            row,
            bytes((a - b) & 255 for a, b in zip(row, left)),
            bytes((a - b) & 255 for a, b in zip(row, above)),
            bytes((a - ((b + c) >> 1)) & 255 for a, b, c in zip(row, left, above)),
        )
        costs = [sum(min(v, 256 - v) for v in candidate) for candidate in candidates]
        best = costs.index(min(costs))
        out.append(best)
        out += candidates[best]
        above = row
    return bytes(out)


def _rgbe(color):
    top = max(color)
    if top < 1e-32:
        return (0, 0, 0, 0)
    mantissa, exponent = math.frexp(top)
    factor = mantissa * 256.0 / top
    return tuple(min(255, int(c * factor)) for c in color) + (exponent + 128,)


def _run_lengths(values):
    """Radiance's new-style encoding of one channel of a line: runs of 4 or more, literal stretches of up to 128."""
    out = bytearray()
    start = 0
    while start < len(values):
        run_at, run = start, 0
        while run_at < len(values):
            run = 1
            while run < 127 and run_at + run < len(values) and values[run_at + run] == values[run_at]:
                run += 1
            if run >= 4:
                break
            run_at += run
        while start < run_at:
            count = min(128, run_at - start)
            out.append(count)
            out += bytes(values[start : start + count])
            start += count
        if run_at < len(values):
            out += bytes((128 + run, values[run_at]))
            start = run_at + run
    return out


def write_hdr(path, width, height, pixel):
    """`pixel(x, y)` -> linear RGB radiance; row 0 is straight up."""
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n")
        file.write(f"-Y {height} +X {width}\n".encode("ascii"))
        for y in range(height):
            line = [_rgbe(pixel(x, y)) for x in range(width)]
            file.write(bytes((2, 2, width >> 8, width & 255)))
            for channel in range(4):
                file.write(_run_lengths([texel[channel] for texel in line]))

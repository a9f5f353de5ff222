# SPDX-License-Identifier: Apache-2.0
"""Reads EXR files of scan lines, uncompressed or by zip, by the published layout of the format, with nothing but Python."""

import itertools
import struct
import zlib

NONE, ZIP = b"\0", b"\3"
ROWS_OF_A_BLOCK = {NONE: 1, ZIP: 16}
SIZES = {0: (4, "I"), 1: (2, "e"), 2: (4, "f")}  # uint, half, float


class Exr:
    """attributes: name -> (type, bytes); channels: name -> rows of numbers, floats of "f" channels also as their bits."""

    def __init__(self, path):
        self.data = path.read_bytes()
        magic, self.version = struct.unpack_from("<II", self.data)
        if magic != 20000630 or self.version & 0x1200:
            raise ValueError(f"{path} is no EXR of one part in scan lines")
        self.attributes, at = self._header(8)
        compression = self.attributes["compression"][1]
        if compression not in ROWS_OF_A_BLOCK:
            raise ValueError(f"{path} is compressed by other than zip")
        x0, y0, x1, y1 = struct.unpack("<4i", self.attributes["dataWindow"][1])
        self.width, self.height = x1 - x0 + 1, y1 - y0 + 1
        self.types = self._types(self.attributes["channels"][1])
        size = self.width * sum(SIZES[kind][0] for kind in self.types.values())
        self._rows, blocks = [], -(-self.height // ROWS_OF_A_BLOCK[compression])
        for place in struct.unpack_from(f"<{blocks}Q", self.data, at):
            count = min(ROWS_OF_A_BLOCK[compression], self.height - len(self._rows))
            block = self._block(place, count * size)
            self._rows += [block[i * size:(i + 1) * size] for i in range(count)]

    def _block(self, place, whole):
        """Rows of pixels. Of zip: bytes as differences of those before, all even ones before all odd ones."""
        (size,) = struct.unpack_from("<i", self.data, place + 4)
        block = self.data[place + 8:place + 8 + size]
        if size == whole:
            return block
        sums = bytes(itertools.accumulate(zlib.decompress(block), lambda a, b: (a + b - 128) % 256))
        half = (whole + 1) // 2
        return bytes(byte for pair in itertools.zip_longest(sums[:half], sums[half:]) for byte in pair if byte is not None)

    def _header(self, at):
        attributes = {}
        while self.data[at]:
            name, at = self._text(at)
            kind, at = self._text(at)
            (size,) = struct.unpack_from("<i", self.data, at)
            attributes[name] = (kind, self.data[at + 4:at + 4 + size])
            at += 4 + size
        return attributes, at + 1

    def _text(self, at):
        end = self.data.index(0, at)
        return self.data[at:end].decode(), end + 1

    def _types(self, block):
        types, at = {}, 0
        while block[at]:
            end = block.index(0, at)
            (types_of,) = struct.unpack_from("<i", block, end + 1)
            types[block[at:end].decode()] = types_of
            at = end + 17
        return types

    def text(self, name):
        return self.attributes[name][1].decode()

    def number(self, name):
        kind, value = self.attributes[name]
        return struct.unpack({"int": "<i", "float": "<f", "double": "<d"}[kind], value)[0]

    def channel(self, name, bits=False):
        """Rows of the channel, from the top; the bits of floats as whole numbers where `bits`."""
        offset = 0
        for other, kind in sorted(self.types.items()):
            if other == name:
                break
            offset += SIZES[kind][0] * self.width
        letter = "I" if bits else SIZES[self.types[name]][1]
        return [struct.unpack_from(f"<{self.width}{letter}", row, offset) for row in self._rows]

# SPDX-License-Identifier: Apache-2.0
"""Reads uncompressed EXR files of scan lines by the published layout of the format, with nothing but Python."""

import struct

SIZES = {0: (4, "I"), 1: (2, "e"), 2: (4, "f")}  # uint, half, float


class Exr:
    """attributes: name -> (type, bytes); channels: name -> rows of numbers, floats of "f" channels also as their bits."""

    def __init__(self, path):
        self.data = path.read_bytes()
        magic, self.version = struct.unpack_from("<II", self.data)
        if magic != 20000630 or self.version & 0x1200:
            raise ValueError(f"{path} is no EXR of one part in scan lines")
        self.attributes, at = self._header(8)
        if self.attributes["compression"][1] != b"\0":
            raise ValueError(f"{path} is compressed")
        x0, y0, x1, y1 = struct.unpack("<4i", self.attributes["dataWindow"][1])
        self.width, self.height = x1 - x0 + 1, y1 - y0 + 1
        self.types = self._types(self.attributes["channels"][1])
        self._rows = struct.unpack_from(f"<{self.height}Q", self.data, at)

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
        offset = 8
        for other, kind in sorted(self.types.items()):
            if other == name:
                break
            offset += SIZES[kind][0] * self.width
        letter = "I" if bits else SIZES[self.types[name]][1]
        return [struct.unpack_from(f"<{self.width}{letter}", self.data, row + offset) for row in self._rows]

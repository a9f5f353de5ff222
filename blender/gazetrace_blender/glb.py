# SPDX-License-Identifier: Apache-2.0
"""Binary glTF files: reading them, changing them and writing them back (glTF 2.0, section 4)."""

import json
import struct
from pathlib import Path

import numpy as np

MAGIC, VERSION = b"glTF", 2
JSON_CHUNK, BINARY_CHUNK = b"JSON", b"BIN\0"
FLOAT = 5126


class Glb:
    """A glTF document and the buffer that belongs to it."""

    def __init__(self, path: Path) -> None:
        content = path.read_bytes()
        json_size = struct.unpack_from("<I", content, 12)[0]
        self.document: dict = json.loads(content[20 : 20 + json_size])
        self.buffer = bytearray(content[20 + json_size + 8 :])

    def write(self, path: Path) -> None:
        """Writes the file; chunks are padded to four bytes."""
        self.document["buffers"] = [{"byteLength": len(self.buffer)}]
        text = json.dumps(self.document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.buffer) + b"\0" * (-len(self.buffer) % 4)
        chunks = struct.pack("<I4s", len(text), JSON_CHUNK) + text + struct.pack("<I4s", len(binary), BINARY_CHUNK) + binary
        path.write_bytes(struct.pack("<4sII", MAGIC, VERSION, 12 + len(chunks)) + chunks)

    def add_floats(self, values: np.ndarray, kind: str) -> int:
        """Appends rows of floats as an accessor of a kind such as VEC3, and returns its index."""
        rows = np.ascontiguousarray(values, np.float32).reshape(len(values), -1)
        self.buffer += b"\0" * (-len(self.buffer) % 4)
        views = self.document.setdefault("bufferViews", [])
        views.append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": rows.nbytes})
        self.buffer += rows.tobytes()
        accessors = self.document.setdefault("accessors", [])
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": FLOAT,
                "count": len(rows),
                "type": kind,
                "min": rows.min(axis=0).tolist(),
                "max": rows.max(axis=0).tolist(),
            }
        )
        return len(accessors) - 1

    def floats(self, accessor_index: int) -> np.ndarray:
        """The floats of an accessor as a writable view of the buffer."""
        accessor = self.document["accessors"][accessor_index]
        view = self.document["bufferViews"][accessor["bufferView"]]
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        return np.frombuffer(self.buffer, np.float32, accessor["count"] * width, begin)

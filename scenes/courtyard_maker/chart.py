# SPDX-License-Identifier: Apache-2.0
"""A tiled panel painted with an eye chart: letters that shrink from line to line, so that acuity shows.

The letters are strokes of our own on a 5 x 5 grid, one unit thick, as optotypes are.
"""
import math

from .noise import hash01
from .vec import clamp01, mix


def _arc(cx, cy, radius, from_deg, to_deg):
    steps = max(2, round(abs(to_deg - from_deg) / 15))
    angles = [math.radians(from_deg + (to_deg - from_deg) * k / steps) for k in range(steps + 1)]
    return [(cx + radius * math.cos(a), cy + radius * math.sin(a)) for a in angles]


# Polylines along the middle of the strokes; x right, y up, 0..5 with half a unit of margin.
_LETTERS = {
    "C": [_arc(2.5, 2.5, 2.0, 40, 320)],
    "D": [[(0.5, 0.5), (0.5, 4.5), (2.5, 4.5), *_arc(2.5, 2.5, 2.0, 90, -90), (0.5, 0.5)]],
    "E": [[(4.5, 0.5), (0.5, 0.5), (0.5, 4.5), (4.5, 4.5)], [(0.5, 2.5), (3.9, 2.5)]],
    "F": [[(0.5, 0.5), (0.5, 4.5), (4.5, 4.5)], [(0.5, 2.5), (3.9, 2.5)]],
    "H": [[(0.5, 0.5), (0.5, 4.5)], [(4.5, 0.5), (4.5, 4.5)], [(0.5, 2.5), (4.5, 2.5)]],
    "K": [[(0.5, 0.5), (0.5, 4.5)], [(4.5, 4.5), (0.9, 2.2)], [(1.9, 2.8), (4.5, 0.5)]],
    "L": [[(0.5, 4.5), (0.5, 0.5), (4.3, 0.5)]],
    "N": [[(0.5, 0.5), (0.5, 4.5), (4.5, 0.5), (4.5, 4.5)]],
    "O": [_arc(2.5, 2.5, 2.0, 0, 360)],
    "P": [[(0.5, 0.5), (0.5, 4.5), (3.2, 4.5), *_arc(3.2, 3.4, 1.1, 90, -90), (0.5, 2.3)]],
    "R": [[(0.5, 0.5), (0.5, 4.5), (3.2, 4.5), *_arc(3.2, 3.4, 1.1, 90, -90), (0.5, 2.3)], [(2.6, 2.3), (4.5, 0.5)]],
    "S": [[(0.5, 1.0), *_arc(3.0, 1.5, 1.0, -90, 90), *_arc(2.0, 3.5, 1.0, 270, 90), (4.4, 4.5)], [(0.5, 0.5), (3.0, 0.5)]],
    "T": [[(0.5, 4.5), (4.5, 4.5)], [(2.5, 4.5), (2.5, 0.5)]],
    "V": [[(0.5, 4.5), (2.5, 0.5), (4.5, 4.5)]],
    "Z": [[(0.5, 4.5), (4.5, 4.5), (0.5, 0.5), (4.5, 0.5)]],
}
# (line, height of its letters as a fraction of the panel, height of its middle)
_LINES = (
    ("E", 0.170, 0.775),
    ("N C", 0.108, 0.590),
    ("D S K", 0.075, 0.468),
    ("Z R H V", 0.053, 0.378),
    ("O F N T L", 0.037, 0.308),
    ("P E C K D Z", 0.026, 0.252),
    ("S T O R V H N", 0.0175, 0.209),
    ("L F D C E Z K P", 0.0115, 0.177),
)
_WHITE, _COBALT = (0.905, 0.890, 0.845), (0.085, 0.170, 0.430)


def _to_segment(px, py, a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy or 1.0  # arcs may begin where the line before them ended
    t = clamp01(((px - a[0]) * dx + (py - a[1]) * dy) / square)
    return math.hypot(px - a[0] - t * dx, py - a[1] - t * dy)


def _letter_ink(letter, x, y, texels_per_unit):
    distance = min(_to_segment(x, y, a, b) for line in _LETTERS[letter] for a, b in zip(line, line[1:]))
    return clamp01(0.5 + (0.5 - distance) * texels_per_unit)


def _border_ink(x, y, size):
    """A painted frame: two lines with a running wave of leaves between them."""
    edge = min(x, y, 1.0 - x, 1.0 - y)
    lines = max(clamp01(0.5 + (0.0035 - abs(edge - at)) * size) for at in (0.030, 0.105))
    if not 0.030 < edge < 0.105:
        return lines
    along = x if min(y, 1.0 - y) == edge else y
    period = 1.0 / 24.0
    phase = along / period - math.floor(along / period) - 0.5
    sign = 1.0 if math.floor(along / period) % 2 else -1.0
    wave = 0.0675 + 0.014 * math.cos(2.0 * math.pi * along / (2.0 * period))
    vine = clamp01(0.5 + (0.0028 - abs(edge - wave)) * size)
    u, v = phase * period, edge - 0.0675 - sign * 0.012
    leaf = clamp01(0.5 + (0.0085 - math.hypot(u * 0.8, v * 1.25)) * size)
    return max(lines, vine, leaf)


def draw_chart(size):
    ink = [[0.0] * size for _ in range(size)]
    for text, height, middle in _LINES:
        unit = height / 5.0
        letters = text.replace(" ", "")
        pitch = height * (1.0 if len(letters) == 1 else 2.0 if height > 0.03 else 1.75)
        for k, letter in enumerate(letters):
            x0 = 0.5 + (k - (len(letters) - 1) / 2.0) * pitch - height / 2.0
            y0 = middle - height / 2.0
            for row in range(int((1.0 - y0 - height) * size) - 1, int((1.0 - y0) * size) + 2):
                for col in range(int(x0 * size) - 1, int((x0 + height) * size) + 2):
                    x, y = ((col + 0.5) / size - x0) / unit, (1.0 - (row + 0.5) / size - y0) / unit
                    ink[row][col] = max(ink[row][col], _letter_ink(letter, x, y, unit * size))

    tile = size // 6

    def pixel(x, y):
        tx, ty = x % tile, y % tile
        shade = 0.955 + 0.06 * hash01(x // tile, y // tile, 91)
        amount = max(ink[y][x], _border_ink((x + 0.5) / size, (y + 0.5) / size, size))
        color = tuple(c * shade for c in mix(_WHITE, _COBALT, amount * (0.88 + 0.12 * hash01(x // tile, y // tile, 92))))
        seam = min(tx, tile - 1 - tx, ty, tile - 1 - ty)
        return mix((0.60, 0.57, 0.52), color, clamp01((seam + 0.4) / 1.2))

    return pixel

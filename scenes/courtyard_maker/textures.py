# SPDX-License-Identifier: Apache-2.0
"""The courtyard's textures, all procedural. Colours are sRGB-encoded; normal maps are +y up (glTF's convention)."""
import math
import os

from .chart import draw_chart
from .images import write_png
from .noise import fractal_noise, hash01
from .vec import clamp01, mix, normalize, smoothstep


def normal_pixel(height_at, size, strength):
    """pixel(x, y) of the normal map of a tiling height field `height_at(x, y)` in texels."""
    heights = [[height_at(x, y) for x in range(size)] for y in range(size)]

    def pixel(x, y):
        dx = (heights[y][(x + 1) % size] - heights[y][x - 1]) * strength
        dy = (heights[(y + 1) % size][x] - heights[y - 1][x]) * strength
        n = normalize((-dx, dy, 1.0))  # rows grow down, +y is up
        return tuple(0.5 + 0.5 * c for c in n)

    return pixel


# --- the floor: 2 x 2 cement tiles with an eight-pointed star, 0.8 m a side -------------------------------------

_CREAM, _INK, _CLAY, _SAGE = (0.86, 0.80, 0.69), (0.13, 0.20, 0.29), (0.70, 0.36, 0.22), (0.44, 0.55, 0.50)
_GROUT = (0.50, 0.46, 0.41)
_TILE = 256  # texels
_TEXELS = 512


def _star(x, y, size):
    """Signed distance of an eight-pointed star (two squares), negative inside."""
    square = max(abs(x), abs(y)) - size
    diamond = (abs(x) + abs(y)) * math.sqrt(0.5) - size
    return min(square, diamond)


def _edge(distance, width=0.006):
    return 1.0 - smoothstep(-width, width, distance)


def _tile_pattern(x, y):
    """x, y in -0.5..0.5 about the tile's middle; the corner motif joins with its neighbours'."""
    color = _CREAM
    cx, cy = 0.5 - abs(x), 0.5 - abs(y)
    color = mix(color, _SAGE, _edge(_star(cx, cy, 0.20)))
    color = mix(color, _CREAM, _edge(_star(cx, cy, 0.155)))
    color = mix(color, _CLAY, _edge(math.hypot(cx, cy) - 0.115))
    ring = abs(_star(x, y, 0.235)) - 0.017
    color = mix(color, _INK, _edge(_star(x, y, 0.20)))
    color = mix(color, _INK, _edge(ring))
    petal = math.hypot(x, y) - 0.125 * (1.0 + 0.28 * math.cos(8.0 * math.atan2(y, x)))
    color = mix(color, _CLAY, _edge(petal))
    color = mix(color, _CREAM, _edge(math.hypot(x, y) - 0.045))
    lozenge = (min(abs(x) / 0.045 + (0.5 - abs(y)) / 0.11, abs(y) / 0.045 + (0.5 - abs(x)) / 0.11) - 1.0) * 0.05
    return mix(color, _INK, _edge(lozenge))


def _from_grout(x, y):
    """Texels from the nearest joint."""
    tx, ty = x % _TILE, y % _TILE
    return min(tx, _TILE - tx, ty, _TILE - ty)


def floor_color(patterned):
    def pixel(x, y):
        tile = (x // _TILE, y // _TILE)
        u, v = (x + 0.5) / _TEXELS, (y + 0.5) / _TEXELS
        wear = fractal_noise(u, v, 6, 6, 3, seed=3)
        tint = 0.94 + 0.10 * hash01(*tile, 7) if patterned else 0.84 + 0.28 * hash01(*tile, 8)
        if patterned:
            color = _tile_pattern((x % _TILE + 0.5) / _TILE - 0.5, (y % _TILE + 0.5) / _TILE - 0.5)
        else:
            color = mix((0.62, 0.37, 0.26), (0.70, 0.46, 0.33), wear)
        color = tuple(c * tint * (0.86 + 0.20 * wear) for c in color)
        return mix(_GROUT, color, smoothstep(1.5, 3.5, _from_grout(x, y)))

    return pixel


def _floor_height(x, y):
    tile = (x % _TEXELS // _TILE, y % _TEXELS // _TILE)
    bevel = smoothstep(1.0, 7.0, _from_grout(x, y))
    # Every tile lies a little askew, which breaks up the mirror image of the sky.
    slope_x, slope_y = hash01(*tile, 11) - 0.5, hash01(*tile, 12) - 0.5
    askew = (slope_x * (x % _TILE - _TILE / 2) + slope_y * (y % _TILE - _TILE / 2)) / _TILE
    return bevel * (1.0 + 0.5 * askew)


def floor_roughness(x, y):
    """Half the colour's resolution: occlusion (unused), roughness, metalness.

    Satin, not polished: a floor that mirrors a low sun paints caustics, which a path tracer of few samples shows as sparks.
    """
    u, v = (x + 0.5) / 256, (y + 0.5) / 256
    polish = 0.50 + 0.30 * fractal_noise(u, v, 5, 5, 4, seed=17)
    rough = 0.92 + (polish - 0.92) * smoothstep(1.5, 4.0, _from_grout(2 * x, 2 * y))
    return (1.0, rough, 0.0)


# --- plaster, wood, water ------------------------------------------------------------------------------------------


def plaster_color(x, y):
    u, v = (x + 0.5) / 256, (y + 0.5) / 256
    cloud = fractal_noise(u, v, 3, 3, 5, seed=41)
    shade = 0.84 + 0.22 * (cloud - 0.5)
    return (shade, shade * 0.985, shade * 0.955)


def _plaster_height(x, y):
    u, v = (x % 256) / 256, (y % 256) / 256
    return fractal_noise(u, v, 7, 7, 4, seed=53)


def wood_color(x, y):
    u, v = (x + 0.5) / 256, (y + 0.5) / 64
    grain = fractal_noise(u, v, 2, 12, 4, seed=61)
    return mix((0.20, 0.125, 0.075), (0.44, 0.29, 0.18), grain)


def _ripples(x, y):
    u, v = 2 * math.pi * x / 128, 2 * math.pi * y / 128
    waves = ((1, 2, 0.3), (3, -1, 1.7), (-2, 3, 4.0), (4, 3, 2.2), (-5, 2, 5.1))
    return sum(math.sin(a * u + b * v + c) / math.hypot(a, b) for a, b, c in waves)


# --- leaves: an atlas, left a sprig of olive leaves, right a spray of bougainvillea ---------------------------------


def _leaf(x, y, base, tip, width):
    """(inside, along, across): signed distance in units of half the width, place along 0..1, -1..1 across."""
    ax, ay = tip[0] - base[0], tip[1] - base[1]
    size = math.hypot(ax, ay)
    along = ((x - base[0]) * ax + (y - base[1]) * ay) / (size * size)
    across = ((x - base[0]) * -ay + (y - base[1]) * ax) / size
    if not 0.0 < along < 1.0:
        return -1.0, 0.0, 0.0
    half = width * math.sin(math.pi * along**0.8) ** 0.9
    return half - abs(across), along, across / max(half, 1e-6)


def _olive_leaves():
    leaves = [((0.5, 0.62), (0.5, 0.99), 0.055)]
    for k in range(6):
        y = 0.06 + 0.105 * k
        reach = 0.36 - 0.025 * k
        for side in (-1, 1):
            leaves.append(((0.5, y), (0.5 + side * reach, y + 0.20 + 0.02 * side), 0.052))
    return leaves


def _bracts():
    flowers = []
    for k in range(7):
        cx, cy = 0.22 + 0.56 * hash01(k, 1, 71), 0.20 + 0.62 * (k + 0.5) / 7
        turn = 2.0 * math.pi * hash01(k, 2, 71)
        for petal in range(3):
            angle = turn + petal * 2.0 * math.pi / 3.0
            flowers.append(((cx, cy), (cx + 0.19 * math.cos(angle), cy + 0.19 * math.sin(angle)), 0.075))
    return flowers


def foliage(size=256):
    olive, bracts = _olive_leaves(), _bracts()

    def pixel(px, py):
        flowering = px >= size
        x, y = (px % size + 0.5) / size, 1.0 - (py + 0.5) / size
        best = (-1.0, 0.0, 0.0, 0)
        for index, leaf in enumerate(bracts if flowering else olive):
            inside, along, across = _leaf(x, y, *leaf)
            if inside > best[0]:
                best = (inside, along, across, index)
        inside, along, across, index = best
        stem = 0.012 - abs(x - 0.5) if y < 0.70 else -1.0
        if not flowering and stem > inside:
            return (0.36, 0.33, 0.20, clamp01(0.5 + stem * size))
        tint = 0.82 + 0.30 * hash01(index, 5, 73)
        if flowering:
            color = mix((0.80, 0.16, 0.42), (0.93, 0.36, 0.56), along)
            color = mix(color, (0.66, 0.09, 0.36), 0.5 * (1.0 - smoothstep(0.0, 0.25, abs(across))))
        else:
            color = mix((0.30, 0.40, 0.20), (0.47, 0.55, 0.33), along)
            color = mix(color, (0.62, 0.68, 0.46), 1.0 - smoothstep(0.0, 0.18, abs(across)))
        return (*(clamp01(c * tint) for c in color), clamp01(0.5 + inside * size))

    return pixel


def write_textures(folder):
    os.makedirs(folder, exist_ok=True)
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    write_png(path("tiles_color.png"), _TEXELS, _TEXELS, floor_color(True))
    write_png(path("clay_color.png"), _TEXELS, _TEXELS, floor_color(False))
    write_png(path("tiles_normal.png"), _TEXELS, _TEXELS, normal_pixel(_floor_height, _TEXELS, 0.9))
    write_png(path("tiles_roughness.png"), 256, 256, floor_roughness)
    write_png(path("plaster_color.png"), 256, 256, plaster_color)
    write_png(path("plaster_normal.png"), 256, 256, normal_pixel(_plaster_height, 256, 1.6))
    write_png(path("wood_color.png"), 256, 64, wood_color)
    write_png(path("ripples_normal.png"), 128, 128, normal_pixel(_ripples, 128, 0.22))
    write_png(path("foliage.png"), 512, 256, foliage())
    write_png(path("chart_color.png"), 768, 768, draw_chart(768))

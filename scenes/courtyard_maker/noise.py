# SPDX-License-Identifier: Apache-2.0
"""Value noise that tiles, from an integer hash: no state, the same everywhere."""
import math


def hash01(x, y, seed=0):
    """Two integers to [0, 1). Multiply-xorshift on 32 bits."""
    h = (x * 0x9E3779B1 + y * 0x85EBCA77 + seed * 0xC2B2AE3D) & 0xFFFFFFFF
    h ^= h >> 15
    h = (h * 0x2C1B3C6D) & 0xFFFFFFFF
    h ^= h >> 12
    h = (h * 0x297A2D39) & 0xFFFFFFFF
    h ^= h >> 15
    return h / 4294967296.0


def value_noise(x, y, period_x, period_y, seed=0):
    """Smooth noise in 0..1 that repeats every `period` lattice cells."""
    ix, iy = math.floor(x), math.floor(y)
    fx, fy = x - ix, y - iy
    fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
    x0, x1 = ix % period_x, (ix + 1) % period_x
    y0, y1 = iy % period_y, (iy + 1) % period_y
    top = hash01(x0, y0, seed) * (1 - fx) + hash01(x1, y0, seed) * fx
    bottom = hash01(x0, y1, seed) * (1 - fx) + hash01(x1, y1, seed) * fx
    return top * (1 - fy) + bottom * fy


def fractal_noise(u, v, cells_x, cells_y, octaves, seed=0):
    """Octaves of value noise over the unit square, in 0..1, tiling."""
    total, weight, amplitude = 0.0, 0.0, 1.0
    for octave in range(octaves):
        total += amplitude * value_noise(u * cells_x, v * cells_y, cells_x, cells_y, seed + octave)
        weight += amplitude
        amplitude *= 0.5
        cells_x, cells_y = cells_x * 2, cells_y * 2
    return total / weight

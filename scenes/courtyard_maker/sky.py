# SPDX-License-Identifier: Apache-2.0
"""A dusk sky of our own: lat-long, linear, with a low soft sun.

The picture's centre is -z, u grows towards +x, row 0 is +y. The sun is a disc of about 2.6 degrees across with a soft
edge, so that shadows are crisp near what casts them and soft further away.
"""
import math

from .images import write_hdr
from .noise import fractal_noise
from .vec import add, clamp01, dot, mix, normalize, scale, smoothstep

SUN_DIRECTION = normalize((-1.0, 0.235, 0.42))  # towards the sun

_ZENITH = (0.10, 0.165, 0.34)
_MIDDLE = (0.27, 0.34, 0.51)
_WARM_HORIZON = (1.40, 0.76, 0.37)
_FAR_HORIZON = (0.66, 0.51, 0.54)
_GROUND = (0.055, 0.045, 0.038)
_SUN = (3900.0, 2150.0, 930.0)
_GLOW = (3.4, 1.75, 0.70)


def sky_radiance(direction):
    height = direction[1]
    towards_sun = dot(direction, SUN_DIRECTION)
    flat = math.sqrt(max(1e-9, 1.0 - height * height))
    sun_flat = math.sqrt(1.0 - SUN_DIRECTION[1] ** 2)
    around = (direction[0] * SUN_DIRECTION[0] + direction[2] * SUN_DIRECTION[2]) / (flat * sun_flat)
    horizon = mix(_FAR_HORIZON, _WARM_HORIZON, (0.5 + 0.5 * around) ** 2.5)
    if height < 0.0:
        return mix(horizon, _GROUND, smoothstep(0.0, 0.06, -height))
    color = mix(horizon, _MIDDLE, smoothstep(0.0, 0.38, height))
    color = mix(color, _ZENITH, smoothstep(0.25, 0.95, height))

    azimuth = math.atan2(direction[0], -direction[2]) / (2.0 * math.pi) + 0.5
    streak = fractal_noise(azimuth, height * 1.2, 9, 16, 4, seed=31)
    cover = smoothstep(0.50, 0.78, streak) * smoothstep(0.03, 0.16, height) * (1.0 - smoothstep(0.45, 0.85, height))
    lit = mix((0.62, 0.40, 0.36), (1.9, 1.0, 0.5), clamp01(0.5 + 0.5 * towards_sun) ** 3)
    color = mix(color, lit, 0.55 * cover)

    angle_deg = math.degrees(math.atan2(math.sqrt(max(0.0, 1.0 - towards_sun**2)), towards_sun))
    color = add(color, scale(_GLOW, math.exp(-angle_deg / 9.0)))
    color = add(color, scale(_SUN, 1.0 - smoothstep(1.0, 1.7, angle_deg)))
    return color


def write_sky(path, width=512, height=256):
    def pixel(x, y):
        azimuth = ((x + 0.5) / width - 0.5) * 2.0 * math.pi
        polar = (y + 0.5) / height * math.pi
        flat = math.sin(polar)
        return sky_radiance((flat * math.sin(azimuth), math.cos(polar), -flat * math.cos(azimuth)))

    write_hdr(path, width, height, pixel)

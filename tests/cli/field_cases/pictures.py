# SPDX-License-Identifier: Apache-2.0
"""Alpha, windows, layers, primaries, transfer and orientation of the pictures that come in."""


def _middle(picture):
    return picture.pixel(picture.width // 2, picture.height // 2)


def png_alpha_is_straight(bench):
    "white, alpha 128, over black: 0.502"
    return bench.near(_middle(bench.picture(bench.scene("webp-alpha/blend_png.gltf"), "--spp", "64")), [0.502] * 3, 0.2)

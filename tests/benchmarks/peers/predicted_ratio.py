# SPDX-License-Identifier: Apache-2.0
"""Where gazetrace's opaque surfaces and Mitsuba's `principled` differ, and by how much: predicted from directional albedos.

gazetrace: height-correlated masking, Schlick's Fresnel, what single scattering loses put back, a diffuse lobe that takes
exactly what the specular one leaves. principled: separable masking, single scattering alone; Fresnel's formula for the
dielectric part; Burley's diffuse lobe as its author has it.
"""

import numpy as np

import metallic_roughness_albedo as albedo

EYE, YFOV_DEG = 8.0, 16.0  # of matched_scenes.one_ball
INNER = 0.85  # of the ball's picture, as a share of its radius: no pixel on the edge


def inner_cosines(size, subpixels=4):
    """(mask of pixels well inside the ball's picture, cosine to the surface at points of each of those pixels)"""
    n = size * subpixels
    at = ((np.arange(n) + 0.5) / n * 2 - 1) * np.tan(np.radians(YFOV_DEG / 2))
    x, y = np.meshgrid(at, at)
    sine2 = (x**2 + y**2) / (1 + x**2 + y**2)  # of the angle to the ball's centre
    inside = sine2 * EYE**2
    cosines = np.sqrt(np.maximum(1 - inside, 0)).reshape(size, subpixels, size, subpixels).swapaxes(1, 2)
    mask = (inside < INNER**2).reshape(size, subpixels, size, subpixels).all((1, 3))
    return mask, cosines[mask].reshape(-1)


def disney_diffuse(cosine, roughness):
    """Directional albedo of Burley's lobe (2012, section 5.3) for a white base."""
    x, w = np.polynomial.legendre.leggauss(96)
    mu, w = 0.5 * (x + 1), 0.5 * w
    phi = (np.arange(64) + 0.5) / 64 * np.pi
    sines = np.sqrt(1 - cosine**2) * np.sqrt(1 - mu**2)
    between = cosine * mu[:, None] + sines[:, None] * np.cos(phi)
    grazing = 0.5 + roughness * (1 + between)  # 2 cos^2 of the half angle = 1 + cosine between
    shape = (1 + (grazing - 1) * (1 - cosine) ** 5) * (1 + (grazing - 1) * (1 - mu[:, None]) ** 5)
    return float(np.sum(w * 2 * mu * shape.mean(1)))


def predicted(metallic, roughness, tint, size):
    """Mean radiances (rgb) over the ball's inner pixels in light of 1: (gazetrace, principled)."""
    _, at = inner_cosines(size)
    cosines = np.linspace(at.min(), 1, 48)
    alpha, c = albedo.alpha_of(roughness), np.array(tint)
    weight = lambda x: np.maximum(1 - x, 0) ** 5
    tables = albedo.albedos(roughness)
    ours, theirs = [], []
    for mu in cosines:
        e, b = albedo.reflected(mu, alpha, lambda x: 1.0), albedo.reflected(mu, alpha, weight)
        f0 = c if metallic else np.full(3, albedo.DIELECTRIC_F0)
        facets = f0 * (e - b) + b + (1 - e) * albedo.repeated(f0, tables.e_average)
        ours.append(facets if metallic else facets + c * (1 - facets))
        if metallic:
            e, b = (albedo.reflected(mu, alpha, f, correlated=False) for f in (lambda x: 1.0, weight))
            theirs.append(c * (e - b) + b)
        else:
            facets = albedo.reflected(mu, alpha, lambda x: albedo.fresnel(x, 1.5), correlated=False)
            theirs.append(facets + c * disney_diffuse(mu, roughness))
    over = lambda values: np.array([np.interp(at, cosines, [v[k] for v in values]).mean() for k in range(3)])
    return over(ours), over(theirs)

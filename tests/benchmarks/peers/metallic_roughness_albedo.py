# SPDX-License-Identifier: Apache-2.0
"""Directional albedos of GGX lobes by quadrature in numpy, at any roughness: nothing here is read from gazetrace's tables.

Visible normals are laid out on a grid of midpoints (Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4),
2018), so that an albedo is the plain mean of masking times Fresnel over the grid.
"""

import dataclasses

import numpy as np

ALPHA_MIN = 5e-4
DIELECTRIC_F0 = 0.04
NODES = 96  # of the tables over sqrt(cosine)


@dataclasses.dataclass
class Albedos:
    """Over cosines (k / (NODES - 1))^2. e: Fresnel 1; b: the same weighted with (1 - v.h)^5; burley: see burley_scale."""

    e: np.ndarray
    b: np.ndarray
    e_average: float
    burley: np.ndarray


def alpha_of(roughness):
    return max(roughness**2, ALPHA_MIN)


def smith_lambda(cosine, alpha):
    tangent2 = (1 - cosine**2) / np.maximum(cosine**2, 1e-300)
    return 0.5 * (np.sqrt(1 + alpha**2 * tangent2) - 1)


def visible_normals(cosine, alpha, count=192):
    """Normals seen under `cosine`, (count, count, 3), and their shares, of mean 1; the view lies in the xz plane.

    The nodes crowd towards the disc's edge, where the long tail of GGX is: evenly spread ones lose part of it.
    """
    edge, v = np.meshgrid((np.arange(count) + 0.5) / count, (np.arange(count) + 0.5) / count)
    u = 1 - edge**2
    shares = 2 * edge
    sine = np.sqrt(max(1 - cosine**2, 0.0))
    view = np.array([alpha * sine, 0, cosine])
    view /= np.linalg.norm(view)
    across = np.array([0.0, 1, 0])
    other = np.cross(view, across)
    radius, phi = np.sqrt(u), 2 * np.pi * v
    t1, t2 = radius * np.cos(phi), radius * np.sin(phi)
    s = 0.5 * (1 + view[2])
    t2 = (1 - s) * np.sqrt(np.maximum(1 - t1**2, 0)) + s * t2
    t3 = np.sqrt(np.maximum(1 - t1**2 - t2**2, 0))
    normal = t1[..., None] * across + t2[..., None] * other + t3[..., None] * view
    normal = np.stack([alpha * normal[..., 0], alpha * normal[..., 1], np.maximum(normal[..., 2], 1e-12)], -1)
    return normal / np.linalg.norm(normal, axis=-1)[..., None], shares


def reflected(cosine, alpha, fresnel, correlated=True):
    """Directional albedo of single scattering; `fresnel` is a function of the angle's cosine to the facet."""
    view = np.array([np.sqrt(max(1 - cosine**2, 0.0)), 0, cosine])
    h, shares = visible_normals(cosine, alpha)
    o_dot_h = h @ view
    i_z = 2 * o_dot_h * h[..., 2] - cosine
    up = i_z > 0
    lambda_o, lambda_i = smith_lambda(cosine, alpha), smith_lambda(np.where(up, i_z, 1.0), alpha)
    masking = (1 + lambda_o) / (1 + lambda_o + lambda_i) if correlated else 1 / (1 + lambda_i)
    return float(np.mean(shares * np.where(up, masking, 0) * fresnel(o_dot_h)))


def fresnel(cosine, eta):
    """Fresnel's reflectance for unpolarised light; eta: index beyond the surface over that on the light's side."""
    sin2 = (1 - cosine**2) / eta**2
    through = np.sqrt(np.maximum(1 - sin2, 0))
    parallel = (eta * cosine - through) / (eta * cosine + through)
    perpendicular = (cosine - eta * through) / (cosine + eta * through)
    return np.where(sin2 >= 1, 1.0, 0.5 * (parallel**2 + perpendicular**2))


def kept_by_glass(cosine, alpha, eta):
    """Share of light that leaves a rough surface between two media after one scattering event, on either side."""
    view = np.array([np.sqrt(max(1 - cosine**2, 0.0)), 0, cosine])
    h, shares = visible_normals(cosine, alpha)
    o_dot_h = h @ view
    f = fresnel(o_dot_h, eta)
    lambda_o = smith_lambda(cosine, alpha)
    masking = lambda z: (1 + lambda_o) / (1 + lambda_o + smith_lambda(np.maximum(z, 1e-6), alpha))
    up = 2 * o_dot_h * h[..., 2] - cosine
    bent = np.sqrt(np.maximum(1 - (1 - o_dot_h**2) / eta**2, 0))
    down = -(h[..., 2] * (o_dot_h / eta - bent) - cosine / eta)
    kept = np.where(up > 0, f * masking(up), 0) + np.where(down > 0, (1 - f) * masking(down), 0)
    return float(np.mean(shares * kept))


@dataclasses.dataclass
class GlassAlbedos:
    """lost[side]: what single scattering loses, over cosines as in Albedos; side 0: light comes from outside."""

    lost: list
    lost_average: list
    passed_average: float  # by a smooth surface, from outside


def glass_albedos(roughness, ior):
    cosines = np.maximum(np.linspace(0, 1, NODES) ** 2, 1e-5)
    lost = [np.array([1 - kept_by_glass(c, alpha_of(roughness), eta) for c in cosines]) for eta in (ior, 1 / ior)]
    passed = cosine_average(1 - fresnel(np.linspace(0, 1, 4096) ** 2, ior))
    return GlassAlbedos(lost, [cosine_average(x) for x in lost], passed)


def cosine_average(table):
    """2 * integral of table(mu) mu dmu, mu = x^2, by Gauss-Legendre over the table's linear interpolation."""
    x, w = np.polynomial.legendre.leggauss(400)
    x, w = 0.5 * (x + 1), 0.5 * w
    return float(np.sum(w * 2 * x * 2 * x**2 * np.interp(x, np.linspace(0, 1, len(table)), table)))


def repeated(f0, e_average):
    """Share of what single scattering loses that comes out again, faded out on smooth surfaces as gazetrace does."""
    lost = 1 - e_average
    f = f0 + (1 - f0) / 21
    return f * f * e_average / (1 - f * lost) * lost**2 / (lost**2 + 1e-6)


def burley_scale(roughness, reflectance):
    """s with s(o) * integral of s(i) shape(o, i) cos_i / pi = 1 - reflectance(o); shape is Burley's, without base colour."""
    x = np.linspace(0, 1, NODES)
    nodes, weights = np.polynomial.legendre.leggauss(256)
    xi = 0.5 * (nodes + 1)
    wi = 0.5 * weights * 2 * xi * 2 * xi**2  # dmu = 2 x dx, times 2 mu
    mu_o, mu_i = x**2, xi**2
    phi = (np.arange(64) + 0.5) / 64 * np.pi
    sines = np.sqrt(1 - mu_o**2)[:, None] * np.sqrt(1 - mu_i**2)[None, :]
    kernel = np.zeros((len(mu_o), len(mu_i)))
    for angle in phi:
        t = roughness * (1 + mu_o[:, None] * mu_i[None, :] + sines * np.cos(angle)) - 0.5
        kernel += (1 + t * (1 - mu_o[:, None]) ** 5) * (1 + t * (1 - mu_i[None, :]) ** 5) / len(phi)
    left = 1 - reflectance
    scale = np.sqrt(np.maximum(left, 1e-9))
    for _ in range(200):
        gathered = kernel @ (wi * np.interp(xi, x, scale))
        scale = np.sqrt(scale * left / gathered)
    return scale


def albedos(roughness):
    alpha = alpha_of(roughness)
    cosines = np.maximum(np.linspace(0, 1, NODES) ** 2, 1e-5)
    e = np.array([reflected(c, alpha, lambda x: 1.0) for c in cosines])
    b = np.array([reflected(c, alpha, lambda x: np.maximum(1 - x, 0) ** 5) for c in cosines])
    e_average = cosine_average(e)
    whole = DIELECTRIC_F0 * (e - b) + b + (1 - e) * repeated(DIELECTRIC_F0, e_average)
    return Albedos(e, b, e_average, burley_scale(roughness, whole))

# SPDX-License-Identifier: Apache-2.0
"""Three-vectors as tuples, and quaternions (x, y, z, w) as glTF has them."""
import math


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def normalize(a):
    return scale(a, 1.0 / length(a))


def clamp01(x):
    return min(1.0, max(0.0, x))


def smoothstep(low, high, x):
    t = clamp01((x - low) / (high - low))
    return t * t * (3.0 - 2.0 * t)


def quaternion_of_axes(x, y, z):
    """The rotation whose columns are the orthonormal axes x, y, z."""
    trace = x[0] + y[1] + z[2]
    if trace > 0:
        s = 2.0 * math.sqrt(trace + 1.0)
        q = ((y[2] - z[1]) / s, (z[0] - x[2]) / s, (x[1] - y[0]) / s, 0.25 * s)
    elif x[0] >= y[1] and x[0] >= z[2]:
        s = 2.0 * math.sqrt(1.0 + x[0] - y[1] - z[2])
        q = (0.25 * s, (y[0] + x[1]) / s, (z[0] + x[2]) / s, (y[2] - z[1]) / s)
    elif y[1] >= z[2]:
        s = 2.0 * math.sqrt(1.0 + y[1] - x[0] - z[2])
        q = ((y[0] + x[1]) / s, 0.25 * s, (z[1] + y[2]) / s, (z[0] - x[2]) / s)
    else:
        s = 2.0 * math.sqrt(1.0 + z[2] - x[0] - y[1])
        q = ((z[0] + x[2]) / s, (z[1] + y[2]) / s, 0.25 * s, (x[1] - y[0]) / s)
    norm = math.sqrt(sum(c * c for c in q))
    return tuple(c / norm for c in q)


def look_rotation(eye, target):
    """A camera's rotation: looks along -z, +y up."""
    z = normalize(sub(eye, target))
    x = normalize(cross((0.0, 1.0, 0.0), z))
    return quaternion_of_axes(x, cross(z, x), z)


def random_rotation(random, up, tilt_rad):
    """A frame whose y axis lies within `tilt_rad` of `up`, turned freely about it."""
    around = random.uniform(0.0, 2.0 * math.pi)
    tilt = tilt_rad * math.sqrt(random.random())
    helper = (1.0, 0.0, 0.0) if abs(up[0]) < 0.9 else (0.0, 0.0, 1.0)
    a = normalize(cross(up, helper))
    b = cross(up, a)
    lean = add(scale(a, math.cos(around)), scale(b, math.sin(around)))
    y = normalize(add(scale(up, math.cos(tilt)), scale(lean, math.sin(tilt))))
    turn = random.uniform(0.0, 2.0 * math.pi)
    helper = (1.0, 0.0, 0.0) if abs(y[0]) < 0.9 else (0.0, 0.0, 1.0)
    a = normalize(cross(y, helper))
    x = normalize(add(scale(a, math.cos(turn)), scale(cross(y, a), math.sin(turn))))
    return quaternion_of_axes(x, y, cross(x, y))

# SPDX-License-Identifier: Apache-2.0
"""Triangle shapes in metres. A Shape collects indexed vertices; every function appends to the one it is given."""
import math

from .vec import add, cross, mix, normalize, scale, sub


class Shape:
    def __init__(self):
        self.positions, self.normals, self.uvs, self.colors, self.indices = [], [], [], [], []

    def vertex(self, position, normal, uv=(0.0, 0.0), color=None):
        self.positions.append(position)
        self.normals.append(normal)
        self.uvs.append(uv)
        if color is not None:
            self.colors.append(color)
        return len(self.positions) - 1

    def grid(self, columns, rows, vertex, flip=False):
        """(columns + 1) x (rows + 1) vertices from vertex(i, j); counter-clockwise when i grows right and j up."""
        first = len(self.positions)
        for j in range(rows + 1):
            for i in range(columns + 1):
                self.vertex(*vertex(i, j))
        for j in range(rows):
            for i in range(columns):
                a = first + j * (columns + 1) + i
                b, c, d = a + 1, a + columns + 2, a + columns + 1
                quad = (a, c, b, a, d, c) if flip else (a, b, c, a, c, d)
                self.indices += quad

    @property
    def triangles(self):
        return len(self.indices) // 3


def rectangle(shape, corner, across, up, cells=(1, 1), color=None):
    """Normal along across x up; texture coordinates in metres; `color(position)` gives vertex colours."""
    normal = normalize(cross(across, up))
    size_u, size_v = math.dist((0, 0, 0), across), math.dist((0, 0, 0), up)

    def vertex(i, j):
        s, t = i / cells[0], j / cells[1]
        position = add(corner, add(scale(across, s), scale(up, t)))
        uv = (s * size_u + corner[0] + corner[2], -t * size_v - corner[1])
        return position, normal, uv, color(position) if color else None

    shape.grid(cells[0], cells[1], vertex)


def box(shape, low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    dx, dy, dz = (x1 - x0, 0, 0), (0, y1 - y0, 0), (0, 0, z1 - z0)
    back = lambda v: scale(v, -1.0)  # noqa: E731
    rectangle(shape, (x0, y0, z1), dx, dy)
    rectangle(shape, (x1, y0, z0), back(dx), dy)
    rectangle(shape, (x1, y0, z1), back(dz), dy)
    rectangle(shape, (x0, y0, z0), dz, dy)
    rectangle(shape, (x0, y1, z1), dx, back(dz))
    rectangle(shape, (x0, y0, z0), dx, dz)


def revolve(shape, profile, segments, center=(0, 0, 0), color=None, uv_scale=(1.0, 1.0), twist=0.0):
    """Turns (radius, height) points about +y. Points that repeat make a sharp edge: normals come from each run."""
    runs, run = [], [profile[0]]
    for point in profile[1:]:
        if point == run[-1]:
            runs.append(run)
            run = [point]
        else:
            run.append(point)
    runs.append(run)
    for run in runs:
        along = [0.0]
        for a, b in zip(run, run[1:]):
            along.append(along[-1] + math.dist(a, b))

        def vertex(i, j, run=run, along=along):
            before, after = run[max(0, j - 1)], run[min(len(run) - 1, j + 1)]
            tangent = (after[0] - before[0], after[1] - before[1])
            size = math.hypot(*tangent)
            out, rise = tangent[1] / size, -tangent[0] / size
            angle = twist - 2.0 * math.pi * i / segments
            c, s = math.cos(angle), math.sin(angle)
            radius, height = run[j]
            position = add(center, (radius * c, height, radius * s))
            tint = color(position, radius, height) if color else None
            return position, (out * c, rise, out * s), (i / segments * uv_scale[0], -along[j] * uv_scale[1]), tint

        shape.grid(segments, len(run) - 1, vertex)


def sphere(shape, center, radius, segments, rings):
    points = [(-90.0 + 180.0 * j / rings) for j in range(rings + 1)]
    profile = [(radius * math.cos(math.radians(a)), radius * math.sin(math.radians(a))) for a in points]
    profile[0], profile[-1] = (0.0, -radius), (0.0, radius)
    revolve(shape, profile, segments, center)


def facets(shape, corners, radius_bottom, radius_top, y0, y1, center=(0, 0, 0), inward=False, twist=0.0):
    """A prism's or cone's flat sides with hard edges."""
    for k in range(corners):
        a, b = (twist - 2.0 * math.pi * (k + s) / corners for s in (0, 1))
        if inward:
            a, b = b, a
        at = lambda angle, r, y: add(center, (r * math.cos(angle), y, r * math.sin(angle)))  # noqa: E731
        p, q = at(a, radius_bottom, y0), at(b, radius_bottom, y0)
        r, s = at(b, radius_top, y1), at(a, radius_top, y1)
        normal = normalize(cross(sub(q, p), sub(s, p)))
        width = math.dist(p, q)
        first = [shape.vertex(v, normal, uv) for v, uv in ((p, (0, -y0)), (q, (width, -y0)), (r, (width, -y1)), (s, (0, -y1)))]
        shape.indices += (first[0], first[1], first[2], first[0], first[2], first[3])


def disc(shape, center, radius, segments, inner=0.0, twist=0.0, down=False):
    normal = (0.0, -1.0 if down else 1.0, 0.0)

    def vertex(i, j):
        angle = twist - 2.0 * math.pi * i / segments
        r = radius if j == 0 else inner
        position = add(center, (r * math.cos(angle), 0.0, r * math.sin(angle)))
        return position, normal, (position[0], position[2])

    shape.grid(segments, 1, vertex, flip=down)


def tube(shape, path, radius, sides, closed=False, caps=True):
    """A round tube along points; `radius` a number or radius(t), t in 0..1. Frames by parallel transport."""
    count = len(path)
    radius_at = radius if callable(radius) else lambda t: radius
    tangents = []
    for k in range(count):
        before = path[(k - 1) % count] if closed else path[max(0, k - 1)]
        after = path[(k + 1) % count] if closed else path[min(count - 1, k + 1)]
        tangents.append(normalize(sub(after, before)))
    helper = (0.0, 0.0, 1.0) if abs(tangents[0][2]) < 0.9 else (1.0, 0.0, 0.0)
    side = normalize(cross(tangents[0], helper))
    sides_at = []
    for tangent in tangents:
        side = normalize(sub(side, scale(tangent, sum(a * b for a, b in zip(side, tangent)))))
        sides_at.append(side)
    # A closed tube's frame comes back turned; the turn is spread along it.
    turn = 0.0
    if closed:
        last = normalize(sub(sides_at[-1], scale(tangents[0], sum(a * b for a, b in zip(sides_at[-1], tangents[0])))))
        up = cross(tangents[0], sides_at[0])
        turn = -math.atan2(sum(a * b for a, b in zip(last, up)), sum(a * b for a, b in zip(last, sides_at[0])))
    rings = count if closed else count - 1

    def vertex(i, j):
        k = j % count
        angle = 2.0 * math.pi * i / sides + turn * j / count
        up = cross(tangents[k], sides_at[k])
        normal = add(scale(sides_at[k], math.cos(angle)), scale(up, math.sin(angle)))
        return add(path[k], scale(normal, radius_at(j / rings))), normal, (i / sides, j / rings * 8.0)

    shape.grid(sides, rings, vertex)
    if caps and not closed:
        for k, sign in ((0, -1.0), (count - 1, 1.0)):
            normal = scale(tangents[k], sign)
            middle = shape.vertex(path[k], normal)
            up = cross(tangents[k], sides_at[k])
            ring = []
            for i in range(sides):
                angle = 2.0 * math.pi * i / sides
                out = add(scale(sides_at[k], math.cos(angle)), scale(up, math.sin(angle)))
                ring.append(shape.vertex(add(path[k], scale(out, radius_at(k / rings))), normal))
            for i in range(sides):
                a, b = ring[i], ring[(i + 1) % sides]
                shape.indices += (middle, a, b) if sign > 0 else (middle, b, a)


def arch_points(center_x, springing_y, radius, segments):
    """From the right springing over the crown to the left one."""
    return [
        (center_x + radius * math.cos(math.pi * k / segments), springing_y + radius * math.sin(math.pi * k / segments))
        for k in range(segments + 1)
    ]


def arched_wall(shape, place, x0, x1, base_y, top_y, springing_y, radius, depth, segments=24, color=None, both=False):
    """A wall of the local x-y plane, facing local +z, with a round-arched opening in the middle of x0..x1.

    `place(x, y, z)` puts local points and, with w=0 in a fourth argument, directions into the world. The opening's
    reveal goes `depth` to local -z; `both` adds the face on the far side.
    """
    center = 0.5 * (x0 + x1)
    arch = arch_points(center, springing_y, radius, segments)

    def strip(points_low, points_high, z, normal, flip):
        points = (points_low, points_high)
        rows = max(1, round(max(math.dist(a, b) for a, b in zip(points_low, points_high)) / 0.6)) if color else 1

        def vertex(i, j):
            x, y = mix(points[0][i], points[1][i], j / rows)
            position = place(x, y, z)
            return position, place(*normal, 0), (x, -y), color(position) if color else None

        shape.grid(len(points_low) - 1, rows, vertex, flip)

    faces = [(0.0, (0, 0, 1), False)] + ([(-depth, (0, 0, -1), True)] if both else [])
    for z, normal, flip in faces:
        left, right = center - radius, center + radius
        over = arch[::-1]
        strip(over, [(x, top_y) for x, _ in over], z, normal, flip)
        for a, b in ((x0, left), (right, x1)):
            if b - a > 1e-6:
                strip([(a, base_y), (b, base_y)], [(a, springing_y), (b, springing_y)], z, normal, flip)
                strip([(a, springing_y), (b, springing_y)], [(a, top_y), (b, top_y)], z, normal, flip)
    outline = [(center + radius, base_y)] + arch + [(center - radius, base_y)] if springing_y > base_y else arch
    walked = 0.0
    for (ax, ay), (bx, by) in zip(outline, outline[1:]):
        step = math.dist((ax, ay), (bx, by))
        if step < 1e-9:
            continue
        on_arch = ay >= springing_y - 1e-9 and by >= springing_y - 1e-9 and not (ay == by == base_y)
        flat = (-(by - ay) / step, (bx - ax) / step)
        corners = []
        for (x, y), z, s in (((ax, ay), 0, 0), ((ax, ay), -depth, 0), ((bx, by), -depth, 1), ((bx, by), 0, 1)):
            out = ((center - x) / radius, (springing_y - y) / radius) if on_arch else flat
            position = place(x, y, z)
            uv = (walked + s * step, z)
            corners.append(shape.vertex(position, place(*out, 0, 0), uv, color(position) if color else None))
        a, b, c, d = corners
        shape.indices += (a, c, b, a, d, c)
        walked += step

"""Meshes, solids, noise and pictures of which the parts of the gallery are made; lengths are metres, y is up."""
import math
import pathlib
import random
import struct
import zlib

PARTS = pathlib.Path(__file__).parent / "parts"


class Mesh:
    """Corners (x, y, z, u, v) and polygons, counter-clockwise as seen from outside."""

    def __init__(self):
        self.corners, self.faces = [], []

    def grid(self, rows, closed=False):
        """Quads between neighbouring rows of corners; closed: the last of a row is next to its first."""
        first, width = len(self.corners), len(rows[0])
        self.corners += [corner for row in rows for corner in row]
        for i in range(len(rows) - 1):
            for j in range(width if closed else width - 1):
                a, b = first + i * width + j, first + i * width + (j + 1) % width
                self.faces.append((a, a + width, b + width, b))

    def polygon(self, corners):
        self.faces.append(tuple(range(len(self.corners), len(self.corners) + len(corners))))
        self.corners += [(*corner, 0, 0)[:5] for corner in corners]

    def join(self, other, place=lambda x, y, z: (x, y, z)):
        """Adds another mesh, moved by `place`, which may not mirror."""
        first = len(self.corners)
        self.corners += [(*place(*corner[:3]), *corner[3:]) for corner in other.corners]
        self.faces += [tuple(first + c for c in face) for face in other.faces]

    def shifted(self, height):
        self.corners = [(x, y + height, z, u, v) for x, y, z, u, v in self.corners]
        return self

    def save(self, name):
        """Binary PLY; corners of a face that coincide, as at the ends of a lathe's outline, are one."""
        faces = [[c for c, before in zip(face, face[-1:] + face[:-1]) if self.corners[c][:3] != self.corners[before][:3]] for face in self.faces]
        faces = [face for face in faces if len(face) > 2]
        head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(self.corners)}\n"
                + "".join(f"property float {axis}\n" for axis in "xyzst")
                + f"element face {len(faces)}\nproperty list uchar uint vertex_indices\nend_header\n")
        body = b"".join(struct.pack("<5f", *corner) for corner in self.corners)
        body += b"".join(struct.pack(f"<B{len(face)}I", len(face), *face) for face in faces)
        (PARTS / f"{name}.ply").write_bytes(head.encode() + body)


def lathe(profile, around=96, turns=1.0):
    """Turns (radius, height) points, listed from the bottom of the outside upwards, around the y axis."""
    mesh = Mesh()
    lengths = [0.0]
    for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
        lengths.append(lengths[-1] + math.hypot(r1 - r0, y1 - y0))
    rows = []
    for (r, y), length in zip(profile, lengths):
        rows.append([(r * math.cos(a), y, -r * math.sin(a), turns * j / around, length / lengths[-1])
                     for j in range(around + 1) for a in [2 * math.pi * j / around]])
    mesh.grid([row[::-1] for row in rows])
    return mesh


def curve(points, steps=10):
    """A Catmull-Rom spline through points."""
    ends = [points[0], *points, points[-1]]
    out = []
    for p0, p1, p2, p3 in zip(ends, ends[1:], ends[2:], ends[3:]):
        for i in range(steps):
            t = i / steps
            out.append(tuple(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t ** 2
                                    + (3 * b - a - 3 * c + d) * t ** 3) for a, b, c, d in zip(p0, p1, p2, p3)))
    return out + [points[-1]]


def torus(major, minor, flat=1.0, around=512, across=128):
    """A ring around the y axis, `flat` times as high as thick."""
    profile = [(major + minor * math.cos(t), flat * minor * math.sin(t))
               for i in range(across + 1) for t in [2 * math.pi * i / across]]
    return lathe(profile, around)


def ball(across=64):
    profile = [(math.sin(t), -math.cos(t)) for i in range(1, across) for t in [math.pi * i / across]]
    return lathe([(0.0, -1.0), *profile, (0.0, 1.0)], 2 * across)


def rounded_box(size, radius, steps=5):
    """Half sizes, with rounded edges."""
    mesh = Mesh()
    inner = [s - radius for s in size]
    ring = [-1 + 2 * i / (2 * steps + 1) for i in range(2 * steps + 2)]
    for axis in range(3):
        for side in (-1, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            rows = []
            for b in ring:
                row = []
                for a in ring:
                    direction = [0.0, 0.0, 0.0]
                    direction[axis], direction[u], direction[v] = side, math.tan(a * math.pi / 4), math.tan(b * math.pi / 4)
                    length = math.sqrt(sum(d * d for d in direction))
                    core = [0.0, 0.0, 0.0]
                    core[axis], core[u], core[v] = side * inner[axis], math.copysign(inner[u], a), math.copysign(inner[v], b)
                    point = [c + radius * d / length for c, d in zip(core, direction)]
                    row.append((*point, (point[u] / size[u] + 1) / 2, (point[v] / size[v] + 1) / 2))
                rows.append(row if side < 0 else row[::-1])
            mesh.grid([row for row in rows])
    return mesh


def polytope(planes):
    """The convex solid behind all planes (normal, distance)."""
    def cross(a, b):
        return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])

    def dot(a, b):
        return sum(x * y for x, y in zip(a, b))

    points = {}
    for i, (n0, d0) in enumerate(planes):
        for j, (n1, d1) in enumerate(planes[:i]):
            line = cross(n0, n1)
            if dot(line, line) < 1e-9:
                continue
            for k, (n2, d2) in enumerate(planes[:j]):
                volume = dot(line, n2)
                if abs(volume) < 1e-6:
                    continue
                a, b = cross(n1, n2), cross(n2, n0)
                point = tuple((d0 * x + d1 * y + d2 * z) / volume for x, y, z in zip(a, b, line))
                if all(dot(n, point) <= d + 1e-7 for n, d in planes):
                    points[tuple(round(c, 5) for c in point)] = point
    mesh = Mesh()
    for normal, distance in planes:
        rim = [p for p in points.values() if dot(normal, p) > distance - 2e-5]
        if len(rim) < 3:
            continue
        middle = tuple(sum(c) / len(rim) for c in zip(*rim))
        x = tuple(a - b for a, b in zip(rim[0], middle))
        y = cross(normal, x)
        offset = [tuple(a - b for a, b in zip(p, middle)) for p in rim]
        order = sorted(range(len(rim)), key=lambda i: math.atan2(dot(offset[i], y), dot(offset[i], x)))
        mesh.polygon([rim[i] for i in order])
    return mesh


def save_png(name, width, height, pixel):
    """pixel(x, y): three numbers in [0,1], of sRGB."""
    rows = b"".join(b"\0" + bytes(min(255, max(0, round(255 * c))) for x in range(width) for c in pixel(x, y))
                    for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    (PARTS / f"{name}.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


class Noise:
    """Smooth noise that repeats after `period` cells."""

    def __init__(self, seed, period):
        numbers = random.Random(seed)
        self.period = period
        self.values = [[numbers.random() for _ in range(period)] for _ in range(period)]

    def at(self, x, y):
        i, j = math.floor(x), math.floor(y)
        u, v = (t * t * (3 - 2 * t) for t in (x - i, y - j))
        row0, row1 = self.values[j % self.period], self.values[(j + 1) % self.period]
        i, k = i % self.period, (i + 1) % self.period
        return (row0[i] * (1 - u) + row0[k] * u) * (1 - v) + (row1[i] * (1 - u) + row1[k] * u) * v

    def cloud(self, x, y, octaves=4):
        return sum(self.at(x * 2 ** o, y * 2 ** o) / 2 ** (o + 1) for o in range(octaves))


def box(mesh, low, high, inwards=False):
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (low, high):
            quad = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[u], corner[v] = end[axis], (low, high)[a][u], (low, high)[b][v]
                quad.append(tuple(corner))
            mesh.polygon(quad if (end is high) != inwards else quad[::-1])


def quad(mesh, corners, turns=1.0):
    """A rectangle with texture coordinates from the first corner on."""
    first = len(mesh.corners)
    mesh.corners += [(*c, turns * u, turns * v) for c, (u, v) in zip(corners, ((0, 0), (1, 0), (1, 1), (0, 1)))]
    mesh.faces.append(tuple(range(first, first + 4)))


def turned(mesh, degrees, x=0.0, z=0.0):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    mesh.corners = [(c * px + s * pz + x, y, -s * px + c * pz + z, u, v) for px, y, pz, u, v in mesh.corners]
    return mesh

"""Rings, stones and a string of pearls on a cloth; lengths are half centimetres, about."""
import math

from shapes import PARTS, Mesh, Noise, ball, curve, lathe, polytope, torus


def brilliant():
    """A round brilliant of girdle radius 1 around y = 0, by the angles of its facets."""
    planes = []
    table, girdle = 0.57, 0.02
    height = girdle + (1 - table) * math.tan(math.radians(34.5))

    def facets(count, turn, tilt, radius, y, up=1):
        for i in range(count):
            a, t = 2 * math.pi * (i + turn) / count, math.radians(tilt)
            normal = (math.sin(t) * math.cos(a), up * math.cos(t), math.sin(t) * math.sin(a))
            planes.append((normal, math.sin(t) * radius + up * math.cos(t) * y))

    planes.append(((0, 1, 0), height))
    facets(8, 0, 34.5, 1, girdle)
    facets(8, 0.5, 22, table * math.cos(math.pi / 8), height)
    facets(16, 0.5, 40.5, 0.99, girdle)
    facets(8, 0, 40.8, 1, -girdle, -1)
    facets(16, 0.5, 42.2, 0.99, -girdle, -1)
    facets(32, 0.5, 90, 0.985, 0)
    return polytope(planes)


def emerald_cut():
    """A stone of four long steps around a table, with cut corners; half as long as wide again, the girdle around y = 0."""
    planes = [((0, 1, 0), 0.24)]
    girdle, first = 0.03, 0.12
    for i in range(8):
        a = math.pi / 4 * i
        reach = (0.75, 0.79, 0.52, 0.79)[i % 4]
        for tilt, inset, up in ((90, 0, 1), (44, 0, 1), (26, first, 1), (52, 0, -1), (40, 0.22, -1)):
            t = math.radians(tilt)
            y = girdle + inset * math.tan(math.radians(44 if up > 0 else 52))
            planes.append(((math.sin(t) * math.cos(a), up * math.cos(t), math.sin(t) * math.sin(a)), math.sin(t) * (reach - inset) + math.cos(t) * y))
    return polytope(planes)


def wire(points, radii, sides=16):
    """A round wire along points in the plane z = 0, with rounded ends."""
    mesh, rows = Mesh(), []
    for i, ((x, y), r) in enumerate(zip(points, radii)):
        (x0, y0), (x1, y1) = points[max(0, i - 1)], points[min(len(points) - 1, i + 1)]
        length = math.hypot(x1 - x0, y1 - y0)
        nx, ny = (y0 - y1) / length, (x1 - x0) / length
        rows.append([(x + r * math.cos(t) * nx, y + r * math.cos(t) * ny, r * math.sin(t), 0, 0)
                     for j in range(sides) for t in [2 * math.pi * j / sides]])
    mesh.grid(rows, closed=True)
    return mesh


def prongs(mesh, count, path, thickness, turn=0.0):
    """Claws around the y axis, along (radius, height)."""
    points = curve(path, 6)
    radii = [thickness * min(1.0, 0.25 + math.sqrt(max(0, len(points) - 1 - i) / 3)) for i in range(len(points))]
    claw = wire(points, radii)
    for k in range(count):
        c, s = math.cos(2 * math.pi * k / count + turn), math.sin(2 * math.pi * k / count + turn)
        mesh.join(claw, lambda x, y, z: (c * x - s * z, y, s * x + c * z))


def shank(mesh):
    """Stands on the x axis' plane: around z, of radius 1.3; the head comes above (0, 1.4, 0)."""
    mesh.join(torus(1.3, 0.10, 1.5, 192, 32), lambda x, y, z: (x, -z, y))


def solitaire():
    ring = Mesh()
    shank(ring)
    for radius, y in ((0.34, 1.56), (0.53, 1.80)):
        ring.join(torus(radius, 0.035, 1, 64, 16), lambda px, py, pz: (px, py + y, pz))
    prongs(ring, 6, [(0.10, 1.33), (0.32, 1.55), (0.60, 1.86), (0.685, 2.02), (0.645, 2.115), (0.55, 2.145)], 0.05)
    ring.save("solitaire")


def halo():
    """A ring whose coloured stone (girdle radius 0.5 at y = 2.0) is amid 16 small brilliants."""
    ring, stones = Mesh(), Mesh()
    shank(ring)
    ring.join(lathe(curve([(0.1, 1.36), (0.16, 1.42), (0.42, 1.62), (0.70, 1.82), (0.80, 1.90), (0.81, 1.96), (0.79, 1.985)], 5)
                    + [(0.55, 1.975), (0.52, 1.90), (0.10, 1.50)], 96))
    prongs(ring, 4, [(0.56, 1.90), (0.555, 2.0), (0.53, 2.08), (0.46, 2.12)], 0.04, math.pi / 4)
    small = brilliant()
    for k in range(16):
        a = 2 * math.pi * k / 16
        x, z = 0.675 * math.cos(a), 0.675 * math.sin(a)
        stones.join(small, lambda px, py, pz: (x + 0.112 * px, 2.09 + 0.112 * py, z + 0.112 * pz))
        for side in (-1, 1):
            b = a + math.pi / 16
            r = 0.675 + side * 0.075
            ring.join(lathe([(math.sin(t), -math.cos(t)) for i in range(9) for t in [0.02 + 3.1 * i / 8]], 12),
                      lambda px, py, pz: (r * math.cos(b) + 0.032 * px, 2.06 + 0.05 * py, r * math.sin(b) + 0.032 * pz))
    ring.save("halo")
    stones.save("halo_stones")


WRINKLES = Noise(71, 32)


def cloth_height(x, z):
    """Folds behind the stage, which is flat."""
    far = min(1.0, max(0.0, (math.hypot(x / 1.5 - 0.3, z - 1.5) - 3.4) / 4))
    fold = math.sin(1.1 * x + 0.9 * z + 2.2 * math.sin(0.35 * x - 0.2 * z)) + 0.5 * math.sin(0.6 * x - 1.9 * z)
    return far * far * (3 - 2 * far) * (0.9 + 0.7 * fold + 0.05 * max(0.0, -2.0 - z) ** 2) + 0.02 * (WRINKLES.cloud(x / 2, z / 2, 3) - 0.45)


def cloth():
    mesh = Mesh()
    mesh.grid([[(x, cloth_height(x, z), z, x, z) for i in range(181) for x in [-13.5 + 0.15 * i]]
               for j in range(131) for z in [-12 + 0.15 * j]])
    mesh.save("cloth")


def pearls():
    path = curve([(-9.0, 1.5), (-5.5, -0.4), (-3.2, -2.2), (-0.5, -2.6), (2.0, -1.6), (4.2, -2.0), (6.0, -4.0), (9.0, -4.2)], 200)
    rows, last = [], None
    for x, z in path:
        r = 0.30
        if last and math.dist(last, (x, z)) < 2.03 * r:
            continue
        last = x, z
        rows.append(f"{r} 0 0 {x:.4f}  0 {r} 0 {cloth_height(x, z) + r:.4f}  0 0 {r} {z:.4f}")
    (PARTS / "pearls.txt").write_text("\n".join(rows) + "\n")


def jewellery():
    brilliant().save("brilliant")
    emerald_cut().save("emerald_cut")
    ball(32).save("pearl")
    solitaire()
    halo()
    cloth()
    pearls()


if __name__ == "__main__":
    jewellery()

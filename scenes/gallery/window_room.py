"""A room of 6.4 x 2.9 x 8.4 m with a wide window in its wall at -x, and the garden that is seen through it."""
import math
import random

from shapes import PARTS, Mesh, ball, box, curve, lathe, quad, save_png, turned

LOW, HIGH = (-0.5, 0.42), (2.2, 2.5)  # of the window; along the wall and up


def room():
    walls = Mesh()
    box(walls, (-4.2, 0, -0.35), (LOW[0], 2.9, 0))
    box(walls, (HIGH[0], 0, -0.35), (4.2, 2.9, 0))
    box(walls, (LOW[0], 0, -0.35), (HIGH[0], LOW[1], 0))
    box(walls, (LOW[0], HIGH[1], -0.35), (HIGH[0], 2.9, 0))
    turned(walls, 90, -3.2)
    box(walls, (3.2, 0, -4.2), (3.5, 2.9, 4.2))
    box(walls, (-3.55, 0, -4.5), (3.5, 2.9, -4.2))
    box(walls, (-3.55, 0, 4.2), (3.5, 2.9, 4.5))
    box(walls, (-3.55, 2.9, -4.5), (3.5, 3.2, 4.5))
    walls.save("room")
    frame = Mesh()
    (x0, y0), (x1, y1) = LOW, HIGH
    for i in range(4):
        x = x0 + (x1 - x0 - 0.05) * i / 3
        box(frame, (x, y0, -0.2), (x + 0.05, y1, -0.13))
    for y in (y0, y0 + 1.45, y1 - 0.05):
        box(frame, (x0, y, -0.19), (x1, y + 0.05, -0.14))
    box(frame, (x0 - 0.12, y0 - 0.05, -0.1), (x1 + 0.12, y0, 0.16))
    box(frame, (-4.2, 0, 0), (4.2, 0.1, 0.02))
    turned(frame, 90, -3.2)
    box(frame, (-3.2, 0, -4.2), (3.2, 0.1, -4.18))
    frame.save("window_frame")


def curtains():
    """Two, in folds, on a rod."""
    cloth = Mesh()
    for x0, x1 in ((LOW[0] - 0.42, LOW[0] + 0.02), (HIGH[0] - 0.02, HIGH[0] + 0.42)):
        rows = []
        for y in (0.03, 0.6, 1.3, 2.0, 2.62):
            row = []
            for i in range(81):
                t = i / 80
                row.append((x0 + (x1 - x0) * t, y, 0.16 + (0.05 + 0.012 * math.sin(3 * y)) * math.sin(2 * math.pi * 5.5 * t + 0.25 * math.sin(2 * y)), t, y))
            rows.append(row)
        cloth.grid(rows[::-1])
    turned(cloth, 90, -3.2).save("curtains")


def crown():
    """Leaves of a tree or a bush around the origin, within a radius of 1, and oranges for it; lumps of leaves hide what is within."""
    chance, leaves = random.Random(83), Mesh()

    def direction():
        y, a = chance.uniform(-1, 1), chance.uniform(0, 2 * math.pi)
        return math.sqrt(1 - y * y) * math.cos(a), y, math.sqrt(1 - y * y) * math.sin(a)

    lumps = [tuple(0.62 * c for c in direction()) for _ in range(16)]
    for i in range(1100):
        lump, out = lumps[i % 16], direction()
        middle = [a + 0.36 * b for a, b in zip(lump, out)]
        u, v = direction(), direction()
        size = chance.uniform(0.04, 0.075)
        quad(leaves, [[m + size * (a * p + b * q) for m, p, q in zip(middle, u, v)] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    leaves.save("crown")
    fruit, small = Mesh(), ball(8)
    for k in range(28):
        x, y, z = (0.97 * c for c in direction())
        fruit.join(small, lambda px, py, pz: (x + 0.065 * px, y + 0.065 * py, z + 0.065 * pz))
    fruit.save("oranges")


def garden():
    """A hedge, trees behind it and the edge of a wood beyond; a tree is a crown on a trunk."""
    chance, crowns, trunks = random.Random(84), [], []

    def place(rows, x, y, z, wide, high):
        a = chance.uniform(0, 6.28)
        c, s = wide * math.cos(a), wide * math.sin(a)
        rows.append(f"{c:.3f} 0 {s:.3f} {x:.3f}  0 {high:.3f} 0 {y:.3f}  {-s:.3f} 0 {c:.3f} {z:.3f}")

    for i in range(16):
        place(crowns, -10.5 + chance.uniform(-0.2, 0.2), 0.2, -13 + 1.25 * i, 0.95, 0.85 + chance.uniform(-0.1, 0.15))
    for x, z, high in ((-16, -6.5, 1.7), (-21, -14, 3.0), (-26, -9.5, 2.2), (-15, -0.5, 1.5)):
        place(crowns, x, 1.5 + high, z, 0.8 * high, high)
        place(trunks, x, 0, z, 0.16, 2 + high / 2)
    for i in range(26):
        place(crowns, -62 + chance.uniform(-6, 6), 0.5 + chance.uniform(0, 1.5), -85 + 4.2 * i, 4.2, 3.5 + chance.uniform(-1, 1.5))
    (PARTS / "garden_crowns.txt").write_text("\n".join(crowns) + "\n")
    (PARTS / "garden_trunks.txt").write_text("\n".join(trunks) + "\n")


def rug(x, y):
    u, v = abs(x - 127.5) / 128, abs(y - 127.5) / 128
    edge = max(u, v)
    if edge > 0.94 or 0.80 < edge < 0.84:
        return 0.55, 0.42, 0.30
    if 0.84 <= edge:
        return 0.42, 0.10, 0.10
    diamond = (3 * u + 3 * v) % 1
    return (0.62, 0.50, 0.38) if diamond < 0.2 else (0.50, 0.14, 0.12) if diamond < 0.65 else (0.16, 0.18, 0.28)


def window_room():
    room()
    curtains()
    crown()
    garden()
    lathe(curve([(0.0, 0.0), (0.13, 0.0), (0.15, 0.03), (0.21, 0.22), (0.17, 0.45), (0.08, 0.62), (0.10, 0.70)])
          + curve([(0.09, 0.70), (0.07, 0.62), (0.0, 0.60)])).save("vase")
    lathe([(0.0, 0.0), (0.15, 0.0), (0.15, 0.02), (0.014, 0.03), (0.012, 1.35), (0.0, 1.36)], 48).save("lamp_stand")
    lathe([(0.23, 1.22), (0.15, 1.58), (0.148, 1.58), (0.228, 1.22)], 64).save("lamp_shade")
    save_png("rug", 256, 256, rug)


if __name__ == "__main__":
    window_room()

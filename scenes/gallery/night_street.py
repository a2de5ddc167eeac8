"""A street of an old town after the rain: houses along -z on both sides of 9 m of cobbles, under 25 strings of 20 lamps."""
import math
import random

from shapes import PARTS, Mesh, Noise, box, lathe, save_png

PLASTERS = 4  # tones of the walls
PANES = 4  # rooms in the picture of lit windows
DEPTH = 0.16  # of the windows in their walls


class Front:
    """The front of a house: s metres along it, y up, `out` towards the street."""

    def __init__(self, side, x, z):
        self.side, self.x, self.z = side, x, z

    def point(self, s, y, out):
        return self.side * (self.x - out), y, self.z - s

    def face(self, mesh, corners, uv=None):
        """A polygon of (s, y, out), counter-clockwise with s to the right; texture coordinates are those of the wall, 4 m wide."""
        uv = uv or [(s / 4, y / 4) for s, y, _ in corners]
        row = [(*self.point(*corner), *at) for corner, at in zip(corners, uv)]
        first = len(mesh.corners)
        mesh.corners += row if self.side < 0 else row[::-1]
        mesh.faces.append(tuple(range(first, first + len(row))))

    def sheet(self, mesh, s0, y0, s1, y1, out, uv=None):
        self.face(mesh, [(s0, y0, out), (s1, y0, out), (s1, y1, out), (s0, y1, out)], uv)

    def box(self, mesh, s0, y0, out0, s1, y1, out1):
        a, b = self.point(s0, y0, out0), self.point(s1, y1, out1)
        box(mesh, tuple(map(min, a, b)), tuple(map(max, a, b)))

    def opening(self, mesh, cell, hole):
        """The wall around a hole in a cell (s0, y0, s1, y1), and the hole's sides."""
        (s0, y0, s1, y1), (a, c, b, d) = cell, hole
        for part in ((s0, y0, s1, c), (s0, d, s1, y1), (s0, c, a, d), (b, c, s1, d)):
            self.sheet(mesh, *part, 0)
        rim = [(a, c), (b, c), (b, d), (a, d)]
        for (s, y), (t, v) in zip(rim, rim[1:] + rim[:1]):
            self.face(mesh, [(s, y, 0), (t, v, 0), (t, v, -DEPTH), (s, y, -DEPTH)][::-1])


class Street:
    """Its meshes, by name of the file."""

    def __init__(self):
        self.meshes, self.pots, self.chance = {}, [], random.Random(21)

    def __getitem__(self, name):
        return self.meshes.setdefault(name, Mesh())

    def pane(self, front, hole, lit, name="street_rooms"):
        """Glass in a hole: of a room with light, one of those in the picture, or dark."""
        if not lit:
            return front.sheet(self["street_panes"], *hole, -DEPTH)
        room = self.chance.randrange(PANES)
        u, v = room / PANES, (room + 1) / PANES
        front.sheet(self[name], *hole, -DEPTH, [(u, 0), (v, 0), (v, 1), (u, 1)])

    def window(self, front, cell, plaster, shutters, lit):
        middle, y = (cell[0] + cell[2]) / 2, cell[1] + 0.75
        a, c, b, d = hole = (middle - 0.48, y, middle + 0.48, y + 1.6)
        front.opening(self[plaster], cell, hole)
        self.pane(front, hole, lit)
        stone, timber = self["street_stone"], self["street_timber"]
        front.box(stone, a - 0.12, c - 0.12, -0.02, b + 0.12, c, 0.14)
        front.box(stone, a - 0.10, d, -0.02, b + 0.10, d + 0.16, 0.05)
        for s0, y0, s1, y1 in ((middle - 0.03, c, middle + 0.03, d), (a, c + 1.02, b, c + 1.07), (a, c, a + 0.05, d), (b - 0.05, c, b, d),
                               (a, c, b, c + 0.05), (a, d - 0.05, b, d)):
            front.box(timber, s0, y0, -DEPTH, s1, y1, -DEPTH + 0.05)
        if shutters:
            for s in (a - 0.5, b + 0.02):
                front.box(self[shutters], s, c, 0.0, s + 0.48, d, 0.045)
                for i in range(12):
                    front.box(self[shutters], s + 0.06, c + 0.08 + 0.125 * i, 0.04, s + 0.42, c + 0.14 + 0.125 * i, 0.06)

    def door(self, front, cell, plaster):
        middle = (cell[0] + cell[2]) / 2
        a, c, b, d = hole = (middle - 0.55, 0.15, middle + 0.55, 2.75)
        front.opening(self[plaster], cell, hole)
        stone, wood = self["street_stone"], self["street_wood"]
        front.box(wood, a, c, -DEPTH, b, 2.25, -DEPTH + 0.06)
        for s in (a + 0.1, middle + 0.05):
            for y0, y1 in ((0.35, 1.05), (1.2, 2.1)):
                front.box(wood, s, y0, -DEPTH + 0.06, s + 0.4, y1, -DEPTH + 0.09)
        self.pane(front, (a, 2.25, b, d), True)
        front.box(stone, a, 0, -DEPTH, b, 0.15, 0.35)
        for s0, y0, s1, y1 in ((a - 0.16, 0, a, d), (b, 0, b + 0.16, d), (a - 0.24, d, b + 0.24, d + 0.22)):
            front.box(stone, s0, y0, -0.02, s1, y1, 0.08)
        self.lantern(front, b + 0.42, 2.3)

    def shop(self, front, cell, plaster):
        a, c, b, d = hole = (cell[0] + 0.25, 0.6, cell[2] - 0.25, 2.5)
        front.opening(self[plaster], cell, hole)
        self.pane(front, hole, True, "street_shops")
        for i in range(4):
            s = a + (b - a) * i / 3
            front.box(self["street_wood"], s - 0.04, c, -DEPTH, s + 0.04, d, -DEPTH + 0.06)
        front.box(self["street_wood"], a - 0.08, 0.45, -0.02, b + 0.08, 0.6, 0.12)
        awning = self["street_awnings"]
        top, low = (2.95, 0.02), (2.45, 1.0)
        for sheet in ([(a, *low), (b, *low), (b, *top), (a, *top)], [(a, low[0] - 0.2, 1.0), (b, low[0] - 0.2, 1.0), (b, *low), (a, *low)]):
            front.face(awning, sheet, [((b - a) / 0.8 * u, v) for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))])

    def lantern(self, front, s, y):
        iron, light = self["street_iron"], self["street_lanterns"]
        front.box(iron, s - 0.02, y, 0, s + 0.02, y + 0.04, 0.34)
        front.box(light, s - 0.07, y - 0.34, 0.20, s + 0.07, y - 0.10, 0.34)
        for low, high, half in ((-0.10, -0.06, 0.11), (-0.06, 0.0, 0.05), (-0.37, -0.34, 0.09)):
            front.box(iron, s - half, y + low, 0.27 - half, s + half, y + high, 0.27 + half)

    def house(self, side, z, width):
        chance = self.chance
        floors, bays = chance.choice((3, 3, 4)), max(2, round(width / 2.2))
        front = Front(side, 4.5 + chance.choice((0, 0, 0.25)), z)
        plaster = f"street_plaster{chance.randrange(PLASTERS)}"
        shutters = chance.choice((None, "street_shutters0", "street_shutters1"))
        shop, door = chance.random() < 0.5, chance.randrange(bays)
        height, high = 3.3, 3.0
        for bay in range(bays):
            s0, s1 = width * bay / bays, width * (bay + 1) / bays
            ground = self.door if bay == door else self.shop if shop else None
            if ground:
                ground(front, (s0, 0, s1, height), plaster)
            else:
                self.window(front, (s0, 0, s1, height), plaster, shutters, chance.random() < 0.5)
            for floor in range(floors - 1):
                cell = (s0, height + high * floor, s1, height + high * (floor + 1))
                self.window(front, cell, plaster, shutters, chance.random() < 0.36)
        top = height + high * (floors - 1)
        stone, body = self["street_stone"], self[plaster]
        front.box(body, 0, 0, -6, width, top, -DEPTH - 0.02)
        for s0, y0, s1, y1, out in ((0, 0, 0.22, top, 0.04), (width - 0.22, 0, width, top, 0.04), (0, height - 0.25, width, height - 0.1, 0.07),
                                    (0, top, width, top + 0.12, 0.16), (0, top + 0.12, width, top + 0.25, 0.30)):
            front.box(stone, s0, y0, -0.3, s1, y1, out)
        roof = self["street_roofs"]
        ridge = top + 2.4
        front.face(roof, [(0, top + 0.2, 0.4), (width, top + 0.2, 0.4), (width, ridge, -3), (0, ridge, -3)])
        for s in (0, width):
            front.face(body, [(s, top, 0.1), (s, top, -6), (s, ridge, -3)][::1 if s else -1])
        s = chance.uniform(0.8, width - 1.2)
        front.box(body, s, top, -2.4, s + 0.7, ridge + 0.9, -1.6)
        if not shop:
            for s in (0.6, width - 0.6):
                x, _, z_pot = front.point(s, 0, 0.45)
                self.pots.append((x, z_pot, chance.uniform(0.28, 0.36)))


def strings(chance):
    """Wires, and where the lamps hang: 25 strings of 20."""
    wires, kinds = Mesh(), [[], [], []]
    for i in range(25):
        z, high, sag, slant = -2.5 - 2.6 * i, 5.4 + 1.2 * chance.random(), 0.7 + 0.5 * chance.random(), chance.uniform(-0.8, 0.8)
        along = [-4.5 + 9 * j / 60 for j in range(61)]
        points = [(x, high - sag * (1 - (x / 4.5) ** 2), z + slant * x / 4.5) for x in along]
        for (x0, y0, z0), (x1, y1, z1) in zip(points, points[1:]):
            box(wires, (x0, min(y0, y1), min(z0, z1) - 0.006), (x1, max(y0, y1) + 0.012, max(z0, z1) + 0.006))
        for j in range(20):
            x, y, z_lamp = points[2 + 3 * j if j < 19 else 58]
            kinds[(i + j) % 3].append(f"0.06 0 0 {x:.4f}  0 0.08 0 {y - 0.09:.4f}  0 0 0.06 {z_lamp:.4f}")
    wires.save("wires")
    for kind, rows in zip(("warm", "white", "red"), kinds):
        (PARTS / f"lamps_{kind}.txt").write_text("\n".join(rows) + "\n")


def ground():
    """Cobbles that sink a little here and there: the level water lies in the hollows."""
    hollows = Noise(27, 64)
    rows = []
    for j in range(201):
        z = 5 - 0.4 * j
        rows.append([(x, 0.12 * (hollows.cloud(x / 1.6 + 32, z / 3.2, 3) - 0.47) + 0.0006 * x * x, z, x / 2, -z / 2)
                     for i in range(49) for x in [-4.8 + 0.2 * i]])
    mesh = Mesh()
    mesh.grid(rows[::-1])
    mesh.save("street_ground")


def stone_height(x, y):
    """Of cobbles, 16 x 16 on 512 x 512 pixels, and a number for each."""
    row = y // 32
    shifted = (x + 16 * (row % 2)) % 512
    u, v = (shifted % 32) / 15.5 - 1, (y % 32) / 15.5 - 1
    return max(0.0, 1 - u ** 4) * max(0.0, 1 - v ** 4), (shifted // 32, row)


def pictures():
    tones, grain = random.Random(22), Noise(23, 128)
    tone = [[0.75 + 0.5 * tones.random() for _ in range(16)] for _ in range(16)]

    def cobbles(x, y):
        height, (i, j) = stone_height(x, y)
        k = 0.62 * tone[j][i] * (0.30 + 0.70 * height) * (0.8 + 0.4 * grain.at(x / 4, y / 4))
        return k, 0.97 * k, 0.93 * k

    def heights(x, y):
        height, (i, j) = stone_height(x, y)
        return (0.8 * height + 0.15 * tone[j][i],) * 3

    save_png("cobbles", 512, 512, cobbles)
    save_png("cobbles_height", 512, 512, heights)
    stains = Noise(24, 64)

    def plaster(x, y):
        k = 0.78 + 0.3 * (stains.cloud(x / 16, y / 32, 4) - 0.4) - 0.10 * (y > 236)
        return (k,) * 3

    save_png("plaster", 256, 256, plaster)

    def room(x, y):
        """Four rooms: open curtains, closed ones, a shelf by a lamp, a plant on the sill."""
        kind, u, v = x // 64, (x % 64) / 64, y / 96
        lamp = 1 / (1 + 9 * ((u - (0.3, 0.5, 0.7, 0.5)[kind]) ** 2 + (v - 0.35) ** 2))
        k = 0.35 + 0.65 * lamp
        side = min(u, 1 - u)
        fold = 0.75 + 0.25 * math.sin(60 * u)
        if kind == 1 or (kind in (0, 3) and side < 0.16 + 0.12 * v * v):
            k *= 0.75 * fold
            return k, 0.80 * k, 0.62 * k
        if kind == 2 and 0.5 < u < 0.92 and v > 0.3:
            k *= 0.35 if (v * 8) % 1 < 0.12 else 0.45 + 0.4 * ((int(u * 40) * 7 + int(v * 8) * 5) % 5) / 5
        if kind == 3 and math.hypot((u - 0.5) * 0.8, v - 0.75) < 0.16 + 0.03 * math.sin(17 * math.atan2(v - 0.75, u - 0.5)):
            return 0.12 * k, 0.17 * k, 0.08 * k
        k *= 0.55 if v > 0.86 else 1
        return k, 0.90 * k, 0.72 * k

    def shop(x, y):
        """Shelves of goods under a light."""
        u, v = x / 64, y / 96
        k = 1.0 - 0.45 * v
        shelf, along = int(v * 4), int(u * 6)
        number = (shelf * 13 + along * 7) % 11
        tall = 0.35 + 0.05 * number
        if v > 0.22 and (v * 4) % 1 > 0.92:
            return 0.35 * k, 0.25 * k, 0.18 * k
        if shelf and (v * 4) % 1 > 1 - tall and 0.12 < (u * 6) % 1 < 0.85:
            return tuple(k * c for c in ((0.62, 0.36, 0.22), (0.36, 0.40, 0.28), (0.74, 0.60, 0.36), (0.45, 0.22, 0.20))[number % 4])
        return k, 0.93 * k, 0.82 * k

    save_png("street_rooms", 64 * PANES, 96, room)
    save_png("street_shops", 64 * PANES, 96, shop)
    save_png("street_awning", 64, 8, lambda x, y: (0.75, 0.72, 0.65) if x < 32 else (0.50, 0.10, 0.09))


def tower(street):
    """At the street's end, with a clock."""
    stone, z = street["street_tower"], -84
    box(stone, (-3, 0, z - 6), (3, 19, z))
    box(stone, (-12, 0, z - 8), (12, 7.5, z - 2))
    for y in (12.0, 17.4):
        box(stone, (-3.25, y, z - 6.25), (3.25, y + 0.35, z + 0.25))
    base = [(-3.4, 19, z + 0.4), (3.4, 19, z + 0.4), (3.4, 19, z - 6.4), (-3.4, 19, z - 6.4)]
    for a, b in zip(base, base[1:] + base[:1]):
        street["street_roofs"].polygon([a, b, (0, 27, z - 3)])
    circle = [(1.3 * math.cos(t), 14.9 + 1.3 * math.sin(t), z + 0.06) for i in range(32) for t in [2 * math.pi * i / 32]]
    street["street_clock"].polygon(circle)
    for angle, length in ((0.35, 1.0), (2.0, 0.7)):
        x, y = math.sin(angle), math.cos(angle)
        street["street_iron"].polygon([(0.07 * y, 14.9 - 0.07 * x, z + 0.1), (length * x, 14.9 + length * y, z + 0.1), (-0.07 * y, 14.9 + 0.07 * x, z + 0.1)])
    gate = [(-1.1, 0), (1.1, 0)] + [(1.1 * math.cos(t), 3 + 1.1 * math.sin(t)) for i in range(13) for t in [math.pi * i / 12]]
    street["street_gate"].polygon([(x, y, z + 0.04) for x, y in gate])


def lamp():
    """A bulb of 32 triangles."""
    bulb = Mesh()
    rows = [[(r * math.cos(t), y, r * math.sin(t), 0, 0) for i in range(6) for t in [math.pi * i / 3]]
            for r, y in ((0.5, 0.9), (1.0, 0.1), (0.5, -0.9))]
    bulb.grid(rows[::-1], closed=True)
    bulb.polygon([corner[:3] for corner in rows[0]][::-1])
    bulb.polygon([corner[:3] for corner in rows[2]])
    bulb.save("lamp")


def night_street():
    street = Street()
    for side in (-1, 1):
        z = 6.0
        while z > -80:
            width = street.chance.uniform(5, 8.5)
            street.house(side, z, width)
            z -= width
        a, b = sorted((side * 3.5, side * 5))
        box(street["street_stone"], (a, -0.2, -80), (b, 0.10, 6))
    pots, bushes = Mesh(), Mesh()
    rough = Noise(29, 32)
    bush = lathe([(math.sin(t), -math.cos(t)) for i in range(13) for t in [0.03 + 3.08 * i / 12]], 24)
    for x, z, r in street.pots:
        box(pots, (x - 0.22, 0.1, z - 0.22), (x + 0.22, 0.5, z + 0.22))
        bushes.join(bush, lambda px, py, pz: [a + r * b * (0.8 + 0.5 * rough.at(9 * px + 3 * py + x, 9 * pz + z))
                                              for a, b in ((x, px), (0.72, 1.15 * py), (z, pz))])
    pots.save("street_pots")
    bushes.save("street_bushes")
    tower(street)
    for name, mesh in street.meshes.items():
        mesh.save(name)
    lamp()
    strings(random.Random(21))
    ground()
    pictures()


if __name__ == "__main__":
    night_street()

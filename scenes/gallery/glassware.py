"""Glasses with what is in them. Where a drink touches its glass there is one surface between the two: the drink's, `_side`."""
import math

from shapes import curve, lathe

WINE_GLASS = (
    [(0.0, 0.0), (0.030, 0.0), (0.033, 0.0015), (0.030, 0.003), (0.012, 0.006), (0.0045, 0.012), (0.0038, 0.040),
     (0.0042, 0.072), (0.008, 0.082), (0.026, 0.098), (0.039, 0.122), (0.040, 0.146), (0.0365, 0.172), (0.0335, 0.188)],
    [(0.0327, 0.1884), (0.0320, 0.188), (0.0350, 0.172), (0.0385, 0.146), (0.0375, 0.122), (0.025, 0.1005), (0.006, 0.087), (0.0, 0.086)])
CARAFE = (
    [(0.0, 0.0), (0.040, 0.0), (0.046, 0.003), (0.053, 0.020), (0.056, 0.045), (0.050, 0.080), (0.030, 0.120), (0.0185, 0.150),
     (0.0175, 0.180), (0.022, 0.204), (0.0265, 0.213)],
    [(0.0258, 0.2135), (0.0250, 0.213), (0.0205, 0.204), (0.0158, 0.180), (0.0168, 0.150), (0.0283, 0.120), (0.048, 0.080), (0.0535, 0.045),
     (0.050, 0.020), (0.040, 0.009), (0.0, 0.008)])


def fill(name, inside, level, around=160):
    """The drink up to `level` in an outline that goes down; what of the outline is dry."""
    dry = [point for point in inside if point[1] > level]
    (r0, y0), (r1, y1) = dry[-1], inside[len(dry)]
    rim = (r0 + (r1 - r0) * (y0 - level) / (y0 - y1), level)
    lathe([*inside[:len(dry) - 1:-1], rim], around).save(f"{name}_side")
    lathe([rim, (0.0, level)], around).save(f"{name}_top")
    return [*dry, rim]


def tumbler(facets=10, around=160):
    """Ten flat sides around a round inside; a drink of 3 cm in it."""
    outside = lathe([(0.0, 0.0), (0.034, 0.0), (0.037, 0.004), (0.043, 0.084), (0.0425, 0.086)], around)
    half = math.pi / facets

    def flat(x, y, z):
        k = math.cos(half) / math.cos((math.atan2(z, x) % (2 * half)) - half) if y < 0.085 else math.cos(half)
        return k * x, y, k * z

    outside.corners = [(*flat(*corner[:3]), *corner[3:]) for corner in outside.corners]
    outside.save("tumbler")
    r = 0.0425 * math.cos(half)
    inside = [(r, 0.086)] + curve([(r - 0.0007, 0.0868), (r - 0.0016, 0.0862), (0.0368, 0.060), (0.0338, 0.018), (0.031, 0.0125), (0.024, 0.0112), (0.0, 0.011)])
    lathe(fill("whisky", inside, 0.041)).save("tumbler_inside")


def glassware():
    for name, (outside, inside), drink, level in (("wine_glass", WINE_GLASS, "wine", 0.132), ("carafe", CARAFE, "water", 0.105)):
        lathe(curve(outside) + fill(drink, curve(inside), level), 160).save(name)
    tumbler()


if __name__ == "__main__":
    glassware()

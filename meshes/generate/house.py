"""A brick cottage with a columned porch, dormers, a lean-to and a picket fence on a lawn. Metres, +Y up, front at +Z."""
import math

from . import textures
from .mesh import Mesh, add, cross, lines, unit
from .parts import body, column, log, opening, picket, window

# main block: half width, half depth, height of the eaves, slope of the roof (rise over run)
XW, ZD, EAVES, SLOPE = 3.7, 2.8, 4.2, 0.9
PLINTH, DECK = 0.56, 0.48

KD = {  # linear
    "paint_white": (0.74, 0.73, 0.70), "paint_teal": (0.065, 0.20, 0.21),
    "glass": (0.035, 0.05, 0.06), "metal": (0.17, 0.17, 0.18), "brass": (0.50, 0.36, 0.13), "stone": (0.42, 0.40, 0.37),
    "timber": (0.17, 0.105, 0.06), "clay": (0.46, 0.21, 0.12), "leaf": (0.085, 0.165, 0.05),
    "leaf_dark": (0.05, 0.11, 0.04), "bark": (0.16, 0.115, 0.08), "cut_wood": (0.56, 0.42, 0.25),
    "lead": (0.25, 0.26, 0.28),
}


def mtl():
    out = ["# Materials of house.obj. Kd is linear; *_albedo.png is sRGB; *_normal.png is tangent space, +Y (green) up."]
    for name in textures.MAPS:
        out += ["", "newmtl " + name, "Kd 1 1 1", "Ks 0 0 0", "map_Kd %s_albedo.png" % name,
                "norm %s_normal.png" % name]
    for name, kd in KD.items():
        out += ["", "newmtl " + name, "Kd %g %g %g" % kd, "Ks 0 0 0"]
    return "\n".join(out) + "\n"


def slope_planes(half, eaves, slope, axis, centre=0.0):
    """The two planes of a gabled top whose ridge is perpendicular to axis."""
    out = []
    for sign in (1.0, -1.0):
        n = (sign * slope, 1.0, 0.0) if axis == "x" else (0.0, 1.0, sign * slope)
        out.append((n, eaves + slope * half + sign * slope * centre))
    return out


def gabled_roof(m, group, half, low, slope, thickness, over, ends, axis, step, ridge="lead", hidden=None, centre=0.0, cuts=()):
    """Two slopes as one solid. low: height of the underside at the wall; ends: (from, to) along the ridge."""
    saved = m.place
    # local frame: t across (ridge at 0), h up, l along the ridge
    if axis == "z":  # ridge along x, across is z
        m.place = lambda p: (p[2], p[1], p[0])
    else:
        m.place = lambda p: (p[0] + centre, p[1], p[2])
    m.part(group)
    outer = half + over
    ls = lines(ends[0], ends[1], step, *cuts)
    ts = lines(0.0, outer, step / math.hypot(1, slope), half)

    def h(t, lift):
        return low + slope * (half - abs(t)) + lift

    def quad(points, material, hide=False):
        flip = axis == "z"  # swapping x and z mirrors
        m.poly(points[::-1] if flip else points, material, hide)

    for l0, l1 in zip(ls, ls[1:]):
        for t0, t1 in zip(ts, ts[1:]):
            for sign in (1, -1):
                top = [(sign * t0, h(t0, thickness), l1), (sign * t0, h(t0, thickness), l0),
                       (sign * t1, h(t1, thickness), l0), (sign * t1, h(t1, thickness), l1)]
                bottom = [(sign * t1, h(t1, 0), l1), (sign * t1, h(t1, 0), l0), (sign * t0, h(t0, 0), l0),
                          (sign * t0, h(t0, 0), l1)]
                middle = tuple(sum(p[k] for p in bottom) / 4 for k in range(3))
                quad(top[::-1] if sign > 0 else top, "roof")
                quad(bottom[::-1] if sign > 0 else bottom, "paint_white", bool(hidden and hidden(middle)))
        for sign in (1, -1):
            edge = [(sign * outer, h(outer, 0), l0), (sign * outer, h(outer, thickness), l0),
                    (sign * outer, h(outer, thickness), l1), (sign * outer, h(outer, 0), l1)]
            quad(edge if sign > 0 else edge[::-1], "paint_white")
    for l, flip in ((ls[-1], False), (ls[0], True)):
        for t0, t1 in zip(ts, ts[1:]):
            for sign in (1, -1):
                cap = [(sign * t0, h(t0, 0), l), (sign * t1, h(t1, 0), l), (sign * t1, h(t1, thickness), l),
                       (sign * t0, h(t0, thickness), l)]
                quad(cap[::-1] if flip != (sign < 0) else cap, "paint_white")
    # ridge roll: an octagon half sunk into the tiles
    top, r = h(0, thickness), 0.085
    ring = [(r * math.cos(math.pi * (k + 0.5) / 4), top - 0.01 + r * math.sin(math.pi * (k + 0.5) / 4))
            for k in range(8)]
    m.part(group)
    for k in range(8):
        a, b = ring[k], ring[(k + 1) % 8]
        quad([a + (ls[0] - 0.015,), b + (ls[0] - 0.015,), b + (ls[-1] + 0.015,), a + (ls[-1] + 0.015,)], ridge)
    quad([p + (ls[-1] + 0.015,) for p in ring], ridge)
    quad([p + (ls[0] - 0.015,) for p in ring[::-1]], ridge)
    m.place = saved
    return h


def bargeboard(m, group, half, low, slope, thickness, over, at, axis, centre=0.0, deep=0.07):
    """A pair of boards along the sloping edges of a gable, standing proud of the roof's end."""
    outer = half + over + 0.03

    def h(t, lift):
        return low + slope * (half - t) + lift

    lo, hi = min(at), max(at)
    for sign in (1, -1):
        inner = -0.012 if sign > 0 else 0.0  # the two boards overlap at the ridge
        section = [(inner, h(inner, -deep)), (outer, h(outer, -deep)), (outer, h(outer, thickness + 0.02)),
                   (inner, h(inner, thickness + 0.02))]
        section = [(sign * t + centre, y) for t, y in section]
        m.prism(group, section, lo + (0.003 if sign > 0 else 0), hi - (0.003 if sign > 0 else 0),
                "x" if axis == "z" else "z", "paint_white")


def rafter(m, group, z0, z1, x, width, y_of, depth, material="paint_white", hide=(1, 2, 3)):
    """A sloping board under the line y_of(z), from z0 (in the wall) to z1 (in the fascia)."""
    section = [(z0, y_of(z0) - depth), (z1, y_of(z1) - depth * 0.75), (z1, y_of(z1) + 0.03), (z0, y_of(z0) + 0.03)]
    m.prism(group, section, x - width / 2, x + width / 2, "x", material, hide=hide)


def main_block(m):
    band = 4.05
    front = [opening(-2.3, 1.2, 1.22, 2.46), opening(2.3, 1.2, 1.22, 2.46),
             opening(0.0, 1.2, 0.50, 2.62, depth=0.20, back="paint_teal")]
    left = [opening(-1.45, 1.1, 1.22, 2.66), opening(1.45, 1.1, 1.22, 2.66), opening(0.0, 1.0, 4.55, 5.70)]
    right = [opening(-1.95, 0.9, 1.22, 2.66), opening(0.0, 1.0, 4.55, 5.70)]
    back = [opening(s, 1.2, 1.22, 2.66) for s in (-2.3, 0.0, 2.3)]

    planes = slope_planes(ZD, EAVES, SLOPE, "z")
    ridge = EAVES + SLOPE * ZD
    walls = body(m, "walls", (-XW, XW), (-ZD, ZD), 0.40, ridge,
                 lambda c: "plank" if c[1] > band and abs(c[0]) > XW - 0.3 and abs(c[2]) < ZD else "brick",
                 planes, {"+z": front, "-x": left, "+x": right, "-z": back}, levels=(PLINTH, band, EAVES))
    for side, o in [("+z", front[0]), ("+z", front[1])]:
        window(m, "windows", walls[side], o, 2, 2, shutters="paint_teal")
    for side, os in (("-x", left[:2]), ("-z", back), ("+x", right[:1])):
        for o in os:
            window(m, "windows", walls[side], o, 2, 3 if side == "-x" else 2,
                   shutters="paint_teal" if side == "-x" else None)
    for side, o in (("-x", left[2]), ("+x", right[1])):
        window(m, "windows", walls[side], o, 2, 2)
        walls[side].box(m, "trim", lines(-ZD - 0.03, ZD + 0.03, 1.0), (band - 0.09, band + 0.09), (-0.032, 0.05),
                        "paint_white")
    # plinth: only its ledge shows
    inner = (XW - 0.25, ZD - 0.25)
    m.part("plinth")
    X, Z = lines(-XW - 0.07, XW + 0.07, 1.2, -inner[0], inner[0]), lines(-ZD - 0.07, ZD + 0.07, 1.2, -inner[1], inner[1])
    Y = [-0.2, 0.14, PLINTH]
    ledge = [-0.2, 0.14, PLINTH]
    m.rect((0, 0, Z[-1]), (1., 0., 0.), (0., 1., 0.), X, ledge, "cobble",
           hidden=lambda c: c[1] < 0.14 and abs(c[0]) < inner[0])
    m.rect((0, 0, Z[0]), (-1., 0., 0.), (0., 1., 0.), [-x for x in reversed(X)], ledge, "cobble")
    m.rect((X[-1], 0, 0), (0., 0., -1.), (0., 1., 0.), [-z for z in reversed(Z)], ledge, "cobble")
    m.rect((X[0], 0, 0), (0., 0., 1.), (0., 1., 0.), Z, ledge, "cobble")
    m.rect((0, Y[-1], 0), (1., 0., 0.), (0., 0., -1.), X, [-z for z in reversed(Z)], "stone",
           hidden=lambda c: abs(c[0]) < inner[0] and abs(c[2]) < inner[1])
    m.rect((0, Y[0], 0), (1., 0., 0.), (0., 0., 1.), X, Z, "stone", hidden=lambda c: True)

    # roof: underside 5 cm below the top of the body, so that they interlock
    low, thick, over = EAVES - 0.05, 0.23, 0.5
    ends = (-XW - 0.42, XW + 0.42)
    gabled_roof(m, "roof", ZD, low, SLOPE, thick, over, ends, "z", 0.68, "lead",
                hidden=lambda c: abs(c[0]) < ZD and abs(c[2]) < XW, cuts=(-XW + 0.02, XW - 0.02))
    for end in ends:
        s = math.copysign(1.0, end)
        bargeboard(m, "trim", ZD, low, SLOPE, thick, over, (end - s * 0.03, end + s * 0.035), "z")
    for sign in (1, -1):  # gutters and rafter tails
        z = sign * (ZD + over)
        y = low - SLOPE * over
        m.box("trim", lines(ends[0] - 0.02, ends[1] + 0.02, 1.8), (y - 0.085, y + 0.15),
              sorted((z - sign * 0.02, z + sign * 0.03)), "paint_white")
        gutter(m, z + sign * 0.085, y + 0.12, ends[0] - 0.05, ends[1] + 0.05)
        for k in range(11):
            rafter(m, "trim", sign * (ZD - 0.06), sign * (ZD + over - 0.005), -XW + 0.1 + k * (2 * XW - 0.2) / 10, 0.07,
                   lambda z: low + SLOPE * (ZD - abs(z)), 0.10)
    for x, z in ((XW + 0.10, ZD + 0.10), (-XW - 0.10, -ZD - 0.10)):  # down pipes
        m.lathe("trim", [(0.04, 0.0), (0.04, 1.9), (0.04, 3.72)], (x, -0.02, z), 7, "metal", hide="-y")
    return walls


def gutter(m, z, y, x0, x1):
    """A half-round channel as one solid, open at the top."""
    r, n = 0.065, 4
    outer = [(z + r * math.cos(math.pi + math.pi * k / n), y + r * math.sin(math.pi + math.pi * k / n)) for k in range(n + 1)]
    inner = [(z + (r - 0.012) * math.cos(math.pi + math.pi * k / n), y + (r - 0.012) * math.sin(math.pi + math.pi * k / n))
             for k in range(n + 1)]
    outline = outer + inner[::-1]
    pieces = [[k, k + 1, 2 * n - k, 2 * n + 1 - k] for k in range(n)]
    m.prism("trim", outline, x0, x1, "x", "metal", pieces=pieces, cuts=lines(x0, x1, 5.0))


def front_door(m, wall):
    s, y0, y1, d = 0.6, PLINTH, 2.62, 0.20
    g = "door"
    for a, b in ((-s - 0.012, -s + 0.07), (s - 0.07, s + 0.012)):
        wall.box(m, g, (a, b), (y0 - 0.045, y1 + 0.012), (d - 0.13, d + 0.012), "paint_white")
    wall.box(m, g, (-s + 0.06, s - 0.06), (y1 - 0.06, y1 + 0.010), (d - 0.125, d + 0.010), "paint_white")
    wall.box(m, g, (-s + 0.06, s - 0.06), (2.24, 2.31), (d - 0.125, d + 0.010), "paint_white")
    wall.box(m, g, (-s + 0.05, s - 0.05), (2.30, y1 - 0.05), (d - 0.03, d + 0.014), "glass")
    for k in (-1, 1):
        wall.box(m, g, (k * 0.18 - 0.014, k * 0.18 + 0.014), (2.30, y1 - 0.05), (d - 0.055, d + 0.008), "paint_white")
    # leaf: stiles, rails and raised panels over a slab
    wall.box(m, g, (-0.54, 0.54), (y0 + 0.005, 2.25), (d - 0.035, d + 0.016), "paint_teal")
    bars = ((-0.54, -0.42, y0 + 0.012, 2.245, 0.062), (0.42, 0.54, y0 + 0.012, 2.245, 0.062),
            (-0.055, 0.055, y0 + 0.2, 2.14, 0.058), (-0.43, 0.43, y0 + 0.014, y0 + 0.22, 0.060),
            (-0.43, 0.43, 1.25, 1.40, 0.060), (-0.43, 0.43, 2.12, 2.243, 0.060))
    for a, b, c, e, out in bars:
        wall.box(m, g, (a, b), (c, e), (d - out, d + 0.006), "paint_teal")
    for a in (-0.43, 0.055):
        for c, e in ((y0 + 0.22, 1.25), (1.40, 2.12)):
            wall.box(m, g, (a + 0.06, a + 0.315), (c + 0.06, e - 0.06), (d - 0.052, d + 0.004), "paint_teal")
    p = wall.at(0.475, 1.32, d - 0.115)
    m.blob(g, p, (0.034, 0.034, 0.030), 2, "brass")
    m.box(g, (0.455, 0.495), (1.23, 1.41), (p[2] - 0.058, p[2] - 0.038), "brass")
    m.box(g, (0.465, 0.485), (1.31, 1.33), (p[2] - 0.05, p[2]), "brass")
    wall.box(m, g, (-s - 0.02, s + 0.02), (PLINTH - 0.03, PLINTH + 0.025), (-0.14, d - 0.015), "stone")
    c = 0.14
    for a, b in ((-s - c, -s - 0.008), (s + 0.008, s + c)):
        wall.box(m, g, (a, b), (PLINTH - 0.02, y1 + 0.02), (-0.035, 0.03), "paint_white")
    # wide head under the beam of the porch
    wall.box(m, g, (-s - c - 0.03, s + c + 0.03), (y1 - 0.012, y1 + 0.17), (-0.05, 0.032), "paint_white")
    wall.box(m, g, (-s - c - 0.08, s + c + 0.08), (y1 + 0.15, y1 + 0.20), (-0.10, 0.034), "paint_white")
    for side in (-1, 1):  # lanterns
        x = side * 1.02
        p = wall.at(x, 2.05)
        m.box(g, (x - 0.045, x + 0.045), (1.97, 2.17), (p[2] - 0.02, p[2] + 0.02), "metal")
        m.box(g, (x - 0.015, x + 0.015), (2.13, 2.155), (p[2], p[2] + 0.12), "metal")
        m.lathe(g, [(0.03, 0.0), (0.05, 0.015), (0.065, 0.17), (0.085, 0.185), (0.0, 0.26)], (x, 1.90, p[2] + 0.12), 6,
                "metal", crease=20)


def porch(m):
    g, front, x_end = "porch", ZD + 2.05, XW + 0.03
    # deck over a stone base
    m.box(g, lines(-x_end + 0.06, x_end - 0.06, 0.6), (-0.2, DECK - 0.02), lines(ZD - 0.1, front - 0.06, 0.6), "cobble",
          hide="-y+y-z")
    m.uv_turn = True
    m.box(g, lines(-x_end, x_end, 0.6, -x_end + 0.1, x_end - 0.1), (DECK - 0.07, DECK),
          lines(ZD - 0.08, front, 0.6, front - 0.1), "plank",
          lambda face, c: face == "-z" or (face == "-y" and abs(c[0]) < x_end - 0.1 and c[2] < front - 0.1))
    m.uv_turn = False
    m.box(g, lines(-x_end + 0.02, x_end - 0.02, 1.8), (DECK - 0.2, DECK - 0.05), (front - 0.08, front - 0.025), "paint_white")
    # steps, each wider than the one above
    for k, (y, z) in enumerate(((0.325, 5.20), (0.165, 5.54))):
        w = 1.10 + 0.012 * k
        m.box(g, lines(-w, w, 0.6), (-0.15, y - 0.045), (front - 0.12 + 0.02 * k, z - 0.03), "cobble", hide="-y-z+y")
        m.box(g, lines(-w - 0.03, w + 0.03, 0.6), (y - 0.05, y), (front - 0.11 + 0.02 * k, z), "stone")
    # roof slab: from (inside) the wall down to the front
    z0, z1, fall, thick, top = ZD - 0.1, ZD + 2.5, 0.27, 0.11, 3.58

    def under(z):
        return top - thick - fall * (z - ZD)

    xr = XW + 0.30
    xs, zs = lines(-xr, xr, 0.85, -XW + 0.1, XW - 0.1), lines(z0, z1, 0.65, ZD)
    m.part(g)
    f = unit((0.0, 1.0, fall))
    down = cross((1., 0., 0.), f)  # points up the slope (-z)
    run = math.hypot(1, fall)
    o = (0.0, under(ZD) + thick, ZD)
    ts = [-(z - ZD) * run for z in reversed(zs)]
    m.rect(o, (1., 0., 0.), (down[0], -down[1], -down[2]) if down[2] > 0 else down, xs, ts, "roof",
           hidden=lambda c: c[2] < ZD and abs(c[0]) < XW - 0.1)
    n2 = (0.0, -f[1], -f[2])
    v2 = cross(n2, (-1., 0., 0.))
    sign = 1 if v2[2] < 0 else -1
    m.rect((0.0, under(ZD), ZD), (-1., 0., 0.), v2, [-x for x in reversed(xs)], ts if sign > 0 else [-t for t in reversed(ts)],
           "paint_white", hidden=lambda c: c[2] < ZD and abs(c[0]) < XW - 0.1)
    for a, b in zip(xs, xs[1:]):
        for z, flip in ((z1, False), (z0, True)):
            q = [(a, under(z), z), (b, under(z), z), (b, under(z) + thick, z), (a, under(z) + thick, z)]
            m.poly(q[::-1] if flip else q, "paint_white", hidden=flip and abs(a + b) / 2 < XW - 0.1)
    for a, b in zip(zs, zs[1:]):
        for x, flip in ((-xr, False), (xr, True)):
            q = [(x, under(a), a), (x, under(b), b), (x, under(b) + thick, b), (x, under(a) + thick, a)]
            m.poly(q[::-1] if flip else q, "paint_white")
    m.box(g, lines(-xr - 0.02, xr + 0.02, 1.8), (under(z1) - 0.115, under(z1) + thick + 0.012), (z1 - 0.012, z1 + 0.03), "paint_white")
    gutter(m, z1 + 0.085, under(z1) + 0.085, -xr - 0.03, xr + 0.03)
    # beams, rafters, columns
    zc, xc, beam = ZD + 1.82, XW - 0.18, 2.66
    m.box(g, lines(-xc - 0.12, xc + 0.12, 1.0), (beam, under(zc) + 0.045), (zc - 0.10, zc + 0.10), "paint_white")
    m.box(g, lines(-xc - 0.15, xc + 0.15, 1.8), (beam + 0.17, beam + 0.21), (zc - 0.125, zc + 0.125), "paint_white")
    for s in (1, -1):  # side beams, and boards closing the triangle above them
        m.box(g, sorted((s * (xc - 0.10), s * (xc + 0.10))), (beam + 0.006, beam + 0.24), (ZD - 0.08, zc - 0.08), "paint_white", "-z+z")
        za, zb = ZD - 0.07, zc - 0.07
        m.prism(g, [(za, beam + 0.2), (zb, beam + 0.2), (zb, under(zb) + 0.05), (za, under(za) + 0.05)],
                *sorted((s * (xc - 0.03), s * (xc + 0.03))), "x", "plank")
    for k in range(1, 12):
        x = -xc + 2 * xc * k / 12
        rafter(m, g, ZD - 0.05, z1 + 0.005, x, 0.07, under, 0.13)
    xs = (-xc, -1.32, 1.32, xc)
    for x in xs:
        column(m, g, x, zc, DECK, beam + 0.004)
    for s in (1, -1):  # half columns at the wall
        m.box(g, sorted((s * (xc - 0.11), s * (xc + 0.11))), (DECK - 0.02, beam + 0.02), (ZD - 0.03, ZD + 0.085), "paint_white")
        m.box(g, sorted((s * (xc - 0.155), s * (xc + 0.16))), (DECK - 0.025, DECK + 0.16), (ZD - 0.025, ZD + 0.125), "paint_white")
    # railings
    for a, b in ((xs[0], xs[1]), (xs[2], xs[3])):
        railing(m, a, b, "x", zc)
    for x in (-xc, xc):
        railing(m, ZD + 0.05, zc, "z", x)
    for x in (xs[1], xs[2]):  # hand rails down the steps
        s = math.copysign(1, x)
        post = sorted((x - 0.05 - s * 0.22, x + 0.05 - s * 0.22))
        m.box(g, post, (0.1, 1.02), (5.40, 5.50), "paint_white")
        m.lathe(g, [(0.05, 0.0), (0.06, 0.03), (0.045, 0.05), (0.06, 0.09), (0.04, 0.14), (0.0, 0.155)],
                (x - s * 0.22, 1.015, 5.45), 7, "paint_white")
        m.prism(g, [(zc, 1.30), (5.44, 0.84), (5.44, 0.90), (zc, 1.37)], x - s * 0.22 - 0.025, x - s * 0.22 + 0.025, "x", "paint_white")
        m.box(g, (x - s * 0.22 - 0.045, x - s * 0.22 + 0.045), (DECK - 0.03, 1.42), (zc - 0.045, zc + 0.045), "paint_white")
        for k, (z, y) in enumerate(((4.90, 0.31), (5.08, 0.31), (5.26, 0.15))):
            t = (z - zc) / (5.44 - zc)
            m.box(g, (x - s * 0.22 - 0.018, x - s * 0.22 + 0.018), (y, 1.32 - 0.46 * t), (z - 0.018, z + 0.018), "paint_white")


def railing(m, a, b, axis, at):
    """Balusters between two rails from a to b along an axis."""
    g = "railing"

    def bar(lo, hi, y0, y1, half, hide):
        if axis == "x":
            m.box(g, (lo, hi), (y0, y1), (at - half, at + half), "paint_white", hide)
        else:
            m.box(g, (at - half, at + half), (y0, y1), (lo, hi), "paint_white", hide)

    e = 0.008 if axis == "x" else 0.0
    for y0, y1, half in ((0.10 + e, 0.155 + e, 0.026), (0.80 - e, 0.855 - e, 0.040)):
        bar(a, b, DECK + y0, DECK + y1, half, "-x+x" if axis == "x" else "-z+z")
    n = round((b - a) / 0.165)
    for k in range(1, n):
        s = a + (b - a) * k / n
        bar(s - 0.018, s + 0.018, DECK + 0.14, DECK + 0.815, 0.018, "-y+y")


def dormer(m, x):
    """A gabled dormer in the front slope."""
    half, eaves, slope, z_front = 0.72, 5.72, 0.8, ZD - 0.55
    g = "dormer"
    o = opening(x, 0.86, 4.98, 5.655, depth=0.13)
    planes = slope_planes(half, eaves, slope, "x", x)
    walls = body(m, g, (x - half, x + half), (0.3, z_front), 4.55, eaves + slope * half, "plank", planes, {"+z": [o]},
                 levels=(eaves,), step=0.8)
    window(m, g, walls["+z"], o, 3, 2, head=0.09)
    low, thick, over = eaves - 0.03, 0.13, 0.20
    gabled_roof(m, g, half, low, slope, thick, over, (0.2, z_front + 0.24), "x", 0.75, "lead", centre=x,
                hidden=lambda c: abs(c[0]) < half and c[2] < z_front - 0.02, cuts=(z_front - 0.02,))
    bargeboard(m, g, half, low, slope, thick, over, (z_front + 0.215, z_front + 0.27), "x", x, 0.05)
    for s in (1, -1):
        m.box(g, sorted((x + s * (half - 0.08), x + s * (half + 0.02))), (4.5, eaves + 0.02), (z_front - 0.06, z_front + 0.025), "paint_white")
    # lead apron where the wall meets the tiles
    y = EAVES - 0.05 + SLOPE * (ZD - z_front) + 0.23
    m.prism(g, [(z_front - 0.05, y - 0.08), (z_front + 0.16, y + 0.012 - 0.16 * SLOPE - 0.06), (z_front + 0.16, y + 0.02 - 0.16 * SLOPE),
                (z_front + 0.03, y + 0.10), (z_front - 0.05, y + 0.10)],
            x - half - 0.10, x + half + 0.10, "x", "lead")


def chimney(m):
    g, x, z = "chimney", (1.45, 2.20), (-1.52, -0.98)
    base = EAVES + SLOPE * (ZD - 1.52) - 0.3
    m.box(g, x, lines(base, 7.50, 0.6), z, "brick", hide="-y+y")
    for k, (y0, y1) in enumerate(((7.42, 7.50), (7.49, 7.60), (7.59, 7.66))):
        e = (0.04, 0.085, 0.045)[k]
        m.box(g, (x[0] - e, x[1] + e), (y0, y1), (z[0] - e, z[1] + e), ("brick", "brick", "stone")[k])
    for cx in (1.63, 2.02):
        m.lathe(g, [(0.135, 0.0), (0.10, 0.34), (0.13, 0.37), (0.125, 0.42), (0.085, 0.42), (0.085, 0.25),
                    (0.0, 0.25)], (cx, 7.645, -1.25), 9, "clay", hide="-y")
    # lead flashing
    y = EAVES - 0.05 + SLOPE * ZD + 0.23
    m.prism(g, [(z[0] - 0.10, y - SLOPE * 1.62 - 0.08), (z[1] + 0.10, y - SLOPE * 0.88 - 0.08),
                (z[1] + 0.10, y - SLOPE * 0.88 + 0.025), (z[0] - 0.10, y - SLOPE * 1.62 + 0.025)],
            x[0] - 0.10, x[1] + 0.10, "x", "lead")


def lean_to(m):
    """A plastered, timber-framed shed against the +x wall."""
    g, x, z, high, slope = "lean-to", (XW - 0.1, XW + 1.75), (-2.3, 1.05), 3.12, 0.45
    eaves = high - slope * 1.75
    plane = ((slope, 1.0, 0.0), high + slope * XW)
    door = opening(XW + 0.85, 0.90, 0.06, 2.02, depth=0.12, back="plank", reveal="timber")
    side = opening(0.55, 1.0, 1.05, 1.85, depth=0.11, reveal="timber")
    walls = body(m, g, x, z, -0.15, high + slope * 0.1, "plaster", [plane], {"+z": [door], "+x": [side]},
                 levels=(0.14, eaves))
    t, out = "timber", (-0.025, 0.03)
    for wall, o in ((walls["+z"], door), (walls["+x"], side)):
        s0, s1, y0, y1 = o["s0"], o["s1"], o["y0"], o["y1"]
        wall.box(m, g, (s0 - 0.10, s0 - 0.008), (-0.12 if o is door else y0 - 0.09, y1 + 0.09), out, t)
        wall.box(m, g, (s1 + 0.008, s1 + 0.10), (-0.12 if o is door else y0 - 0.09, y1 + 0.09), out, t)
        wall.box(m, g, (s0 - 0.14, s1 + 0.14), (y1 + 0.008, y1 + 0.11), (-0.031, 0.034), t)
    wall, o = walls["+x"], side
    wall.box(m, g, (o["s0"] - 0.14, o["s1"] + 0.14), (o["y0"] - 0.11, o["y0"] + 0.012), (-0.05, 0.10), t)
    m_s = (o["s0"] + o["s1"]) / 2
    wall.box(m, g, (m_s - 0.02, m_s + 0.02), (o["y0"], o["y1"]), (0.06, 0.12), t)
    wall.box(m, g, (o["s0"] - 0.005, o["s1"] + 0.005), (1.43, 1.47), (0.066, 0.122), t)
    # corner posts, sill and top plates, braces
    for wall, a, b in ((walls["+z"], XW + 1.62, XW + 1.775), (walls["+x"], -1.075, -0.92), (walls["+x"], 2.17, 2.325),
                       (walls["-z"], -XW - 1.772, -XW - 1.62), (walls["-z"], -XW - 0.90, -XW - 0.75)):
        tall = wall is walls["-z"] and a > -XW - 1
        wall.box(m, g, (a, b), (-0.1, (high - slope * 0.82 if tall else eaves) + 0.03), (-0.028 - 0.001 * (b > 2), 0.03), t)
    wall = walls["+x"]
    wall.box(m, g, (-1.0, 2.25), (-0.12, 0.14), (-0.022, 0.03), t)
    wall.box(m, g, (-1.0, 2.25), (eaves - 0.16, eaves - 0.02), (-0.0235, 0.03), t)
    wall = walls["-z"]
    wall.box(m, g, (-XW - 1.7, -XW + 0.05), (-0.12, 0.14), (-0.022, 0.03), t)
    wall.box(m, g, (-XW - 1.7, -XW + 0.05), (1.15, 1.29), (-0.0225, 0.03), t)
    wall = walls["+z"]
    wall.box(m, g, (XW + 1.32, XW + 1.7), (-0.12, 0.14), (-0.022, 0.03), t)
    # door furniture: ledges, strap hinges, ring
    wall, s = walls["+z"], XW + 0.85
    for y in (0.32, 1.62):
        wall.box(m, g, (s - 0.40, s + 0.40), (y, y + 0.12), (0.085, 0.125), t)
        wall.box(m, g, (s - 0.40, s + 0.10), (y + 0.045, y + 0.075), (0.078, 0.09), "metal")
    wall.box(m, g, (s + 0.33, s + 0.37), (0.98, 1.12), (0.05, 0.125), "metal")
    m.box(g, (s - 0.52, s + 0.52), (-0.1, 0.075), (z[1] - 0.10, z[1] + 0.30), "stone")
    # roof
    over, thick = 0.28, 0.13
    xs = lines(XW - 0.05, XW + 1.75 + over, 0.7, XW)
    zs = lines(z[0] - 0.25, z[1] + 0.25, 0.9, z[0], z[1])

    def under(px):
        return high - 0.04 - slope * (px - XW)

    m.part(g)
    for a, b in zip(xs, xs[1:]):
        for c, d in zip(zs, zs[1:]):
            buried = b <= XW
            inside = b <= XW + 1.75 and c >= z[0] and d <= z[1]
            m.poly([(a, under(a) + thick, d), (b, under(b) + thick, d), (b, under(b) + thick, c), (a, under(a) + thick, c)],
                   "roof", buried)
            m.poly([(a, under(a), c), (b, under(b), c), (b, under(b), d), (a, under(a), d)], t, buried or inside)
        for c, flip in ((zs[-1], False), (zs[0], True)):
            q = [(a, under(a), c), (b, under(b), c), (b, under(b) + thick, c), (a, under(a) + thick, c)]
            m.poly(q[::-1] if flip else q, t, b <= XW)
    for c, d in zip(zs, zs[1:]):
        for px, flip in ((xs[-1], False), (xs[0], True)):
            q = [(px, under(px), d), (px, under(px), c), (px, under(px) + thick, c), (px, under(px) + thick, d)]
            m.poly(q[::-1] if flip else q, t, flip)
    for k in range(6):  # rafter ends
        c = z[0] + 0.12 + k * (z[1] - z[0] - 0.24) / 5
        xa, xb = XW + 1.70, XW + 1.75 + over - 0.01
        m.prism(g, [(xa, under(xa) - 0.10), (xb, under(xb) - 0.08), (xb, under(xb) + 0.03), (xa, under(xa) + 0.03)],
                c - 0.035, c + 0.035, "z", t)
    m.prism(g, [(XW - 0.03, high - 0.02), (XW + 0.15, under(XW + 0.15) + thick - 0.05), (XW + 0.15, under(XW + 0.15) + thick + 0.02),
                (XW + 0.02, high + 0.22), (XW - 0.03, high + 0.22)], z[0] - 0.24, z[1] + 0.24, "z", "lead")


def fence(m):
    """Pickets on two rails around the front garden, with a gate in the middle and posts with caps."""
    g, x1, z1, z0 = "fence", 8.1, 8.3, 3.6
    gate = 0.75

    def run(start, direction, length, spacing=0.285):
        normal = cross(direction, (0., 1., 0.))  # outward to the street

        def place(s, out, y=0.0):
            return lambda p: add(add(add(start, direction, s + p[0]), (0., 1., 0.), y + p[1]), normal, out + p[2])

        n = round(length / spacing)
        # p maps (along, up, outward): a rotation only if direction × up = normal
        for k in range(n):
            s = length * (k + 0.5) / n
            picket(m, g, place(s, 0.045, 0.06), 0.12, 0.93, 0.024, "paint_white")
        m.place = place(0.0, 0.0)
        for y in (0.24, 0.72):
            m.box(g, (0.012, length - 0.012), (y, y + 0.085), (-0.006, 0.038), "paint_white", "-x+x")
        m.place = lambda p: p

    def post(x, z, height=1.10, half=0.06):
        m.box(g, (x - half, x + half), (-0.15, height), (z - half, z + half), "paint_white", "-y+y")
        e = half + 0.022
        m.lathe(g, [(e * math.sqrt(2), 0.0), (e * math.sqrt(2), 0.03), (0.0, 0.10)], (x, height - 0.012, z), 4,
                "paint_white", crease=1, turn=math.pi / 4)

    for a, b in ((-x1, -gate), (gate, x1)):
        n = 4
        for k in range(n):
            run((a + (b - a) * k / n, 0.0, z1), (1., 0., 0.), (b - a) / n)
    length = (z1 - z0) / 3
    for k in range(3):
        run((-x1, 0.0, z0 + k * length), (0., 0., 1.), length)
        run((x1, 0.0, z1 - k * length), (0., 0., -1.), length)
    for k in range(5):
        for a, b in ((-x1, -gate), (gate, x1)):
            tall = abs(a + (b - a) * k / 4) < 1
            post(a + (b - a) * k / 4, z1, 1.28 if tall else 1.10, 0.085 if tall else 0.06)
    for k in range(3):
        for x in (-x1, x1):
            post(x, z0 + k * length)
    # gate leaf, ajar
    a = math.radians(38)
    d, n = (math.cos(a), 0.0, -math.sin(a)), (math.sin(a), 0.0, math.cos(a))

    def leaf(p):
        return add(add(add((-gate + 0.10, 0.0, z1), d, p[0]), (0., 1., 0.), p[1]), n, p[2])

    m.place = leaf
    for s in (0.0, 1.19):
        m.box(g, (s, s + 0.07), (0.10, 1.02), (-0.02, 0.03), "paint_white")
    for y in (0.22, 0.74):
        m.box(g, (0.03, 1.23), (y, y + 0.085), (-0.006, 0.026), "paint_white")
    m.prism(g, [(0.06, 0.29), (0.16, 0.27), (1.20, 0.75), (1.10, 0.77)], -0.012, 0.018, "z", "paint_white")
    m.place = lambda p: p
    for k in range(7):
        s = 0.15 + k * 0.96 / 6
        picket(m, g, lambda p, s=s: leaf((s + p[0], 0.12 + p[1], 0.034 + p[2])), 0.082,
               0.86 + 0.10 * math.sin(math.pi * (k + 0.5) / 7), 0.024, "paint_white")


def garden(m):
    # lawn with a path from the gate to the steps and a strip around the house; quads under the house are left out
    m.part("ground", closed=False)
    path = 0.8
    xs = lines(-9.0, 9.0, 0.85, -path, path, -4.4, 6.1)
    zs = lines(-9.0, 9.0, 0.85, 8.9, 5.4, -3.5)

    def material(c):
        if abs(c[0]) < path and 4.0 < c[2] < 8.9:
            return "cobble"
        return "cobble" if -4.4 < c[0] < 6.1 and -3.5 < c[2] < 5.4 else "grass"

    def under(c):
        x, z, e = c[0], c[2], 0.32
        return ((abs(x) < XW - e and -ZD + e < z < ZD + 1.9 - e) or
                (XW - e <= x < XW + 1.75 - e and -2.3 + e < z < 1.05 - e))

    m.rect((0., 0., 0.), (1., 0., 0.), (0., 0., -1.), xs, [-z for z in reversed(zs)], material, hidden=under)
    g = "garden"
    kerb = lambda x, z: m.box(g, x, (-0.08, 0.055), z, "stone", "-y")
    for s in (1, -1):
        kerb(sorted((s * (path - 0.03), s * (path + 0.07))), lines(5.36, 8.88, 5.0))
    kerb(lines(-4.45, -path - 0.05, 5.0), (5.352, 5.452))
    kerb(lines(path + 0.05, 6.15, 5.0), (5.352, 5.452))
    kerb(lines(-4.45, 6.15, 5.0), (-3.55, -3.45))
    kerb((-4.453, -4.353), lines(-3.5, 5.4, 5.0))
    kerb((6.06, 6.166), lines(-3.5, 5.4, 5.0))
    # pots with clipped bushes by the steps
    for s in (1, -1):
        x, z = s * 1.62, 5.12
        m.lathe(g, [(0.20, 0.0), (0.28, 0.36), (0.315, 0.37), (0.315, 0.44), (0.275, 0.445), (0.26, 0.38), (0.0, 0.38)],
                (x, -0.01, z), 11, "clay", hide="-y")
        m.lathe(g, [(0.028, 0.0), (0.024, 0.4)], (x, 0.35, z), 6, "bark", hide="+y-y")
        m.blob(g, (x, 0.98, z), (0.34, 0.34, 0.34), 4, "leaf", 0.03, 3 + s)
    # a bed of shrubs along the left wall of the porch, and by the lean-to
    for k, (x, z, r, h) in enumerate(((-4.08, 3.45, 0.40, 0.46), (-4.06, 4.32, 0.42, 0.40), (2.95, 5.12, 0.32, 0.32))):
        m.blob(g, (x, h * 0.62, z), (r, h, r), 3, "leaf_dark" if k % 2 else "leaf", 0.07, 10 + k)
    # bench on the porch
    x0, x1, z, y = 1.75, 3.15, ZD + 0.42, DECK
    for x in (x0 + 0.06, x1 - 0.06):
        m.box("bench", (x - 0.03, x + 0.03), (y - 0.01, y + 0.43), (z + 0.15, z + 0.21), "timber")
        m.box("bench", (x - 0.03, x + 0.03), (y - 0.01, y + 0.90), (z - 0.24, z - 0.18), "timber")
        m.box("bench", (x - 0.025, x + 0.025), (y + 0.36, y + 0.415), (z - 0.20, z + 0.17), "timber")
        m.box("bench", (x - 0.035, x + 0.035), (y + 0.60, y + 0.635), (z - 0.20, z + 0.24), "timber")
        m.box("bench", (x - 0.024, x + 0.024), (y + 0.42, y + 0.61), (z + 0.16, z + 0.20), "timber")
    for k in range(4):
        m.box("bench", (x0, x1), (y + 0.405, y + 0.435), (z - 0.17 + k * 0.102, z - 0.085 + k * 0.102), "timber")
    for k in range(3):
        m.box("bench", (x0 + 0.016, x1 - 0.016), (y + 0.56 + k * 0.12, y + 0.64 + k * 0.12), (z - 0.185, z - 0.155), "timber")
    # fire wood against the left wall
    r, k = 0.088, 0
    for row in range(4):
        n = 6 - row % 2
        for i in range(n):
            z = (i - (n - 1) / 2) * (2 * r - 0.004)
            y = r - 0.006 + row * (r * math.sqrt(3) - 0.003)
            jut = 0.03 * math.sin(2.3 * k + 0.5)
            log(m, "wood", (-XW - 0.09, y, z), (-1., 0., 0.), 0.42 + jut, r * (0.97 + 0.03 * math.cos(1.7 * k)), 0.9 * k)
            k += 1
    for s in (1, -1):
        z = s * (2.5 * (2 * r - 0.004) + r + 0.03)
        m.box("wood", (-XW - 0.36, -XW - 0.30), (-0.1, 0.80), (z - 0.03, z + 0.03), "timber")
    # a barrel under the down pipe
    m.lathe("barrel", [(0.25, 0.0), (0.28, 0.2), (0.295, 0.42), (0.28, 0.64), (0.25, 0.84), (0.225, 0.84), (0.24, 0.74), (0.0, 0.74)],
            (XW + 0.42, -0.01, ZD - 0.62), 12, "timber", hide="-y")
    for y, r0 in ((0.14, 0.277), (0.64, 0.286)):
        m.lathe("barrel", [(r0 - 0.03, y), (r0 + 0.006, y + 0.003), (r0 + 0.006, y + 0.04), (r0 - 0.03, y + 0.043)],
                (XW + 0.42, 0.0, ZD - 0.62), 12, "metal", hide="+y-y")
    # tree
    x, z = -6.4, -1.6
    m.lathe("tree", [(0.34, -0.15), (0.24, 0.12), (0.19, 0.5), (0.165, 1.1), (0.15, 1.8), (0.11, 2.7), (0.05, 3.4)], (x, 0.0, z), 10,
            "bark", crease=60, hide="+y-y")
    for k, (dx, dy, dz, r) in enumerate(((0.0, 3.35, 0.0, 1.25), (0.75, 2.85, 0.45, 0.85), (-0.72, 3.0, -0.2, 0.95))):
        m.blob("tree", (x + dx, dy, z + dz), (r, r * 0.85, r), (4, 3, 3)[k], "leaf" if k % 2 == 0 else "leaf_dark", 0.075, 30 + k)


def make():
    m = Mesh(textures.TILE)
    walls = main_block(m)
    front_door(m, walls["+z"])
    porch(m)
    for x in (-1.85, 1.85):
        dormer(m, x)
    chimney(m)
    lean_to(m)
    garden(m)
    fence(m)
    return m

"""Building parts: walled bodies with recessed openings, windows, columns, pickets, logs."""
import math

from .mesh import add, area_vector, cross, dot, lines, sub, unit

UP = (0.0, 1.0, 0.0)
GLASS_DEPTH = 0.17


class Wall:
    """A vertical wall's frame: s to the right and y up, both seen from outside; depth goes inward."""

    def __init__(self, origin, normal):
        self.origin, self.n = origin, normal
        self.u = cross(UP, normal)

    def at(self, s, y, depth=0.0):
        p = add(add(self.origin, self.u, s), self.n, -depth)
        return (p[0], y, p[2])

    def box(self, m, group, s, y, depth, material, hide="-z"):
        """A box given by (low, high) in s, y and depth (negative depths stand out of the wall).

        hide names faces by x = s, y and z = outward; the back is in the wall unless said otherwise.
        """
        saved, m.place = m.place, lambda p: self.at(p[0], p[1], -p[2])
        m.box(group, s, y, (-depth[1], -depth[0]), material, hide)
        m.place = saved


def opening(s, width, y0, y1, depth=GLASS_DEPTH, back="glass", reveal=None):
    return dict(s0=round(s - width / 2, 6), s1=round(s + width / 2, 6), y0=y0, y1=y1, depth=depth, back=back, reveal=reveal)


def body(m, group, x, z, y0, y1, material, clips=(), openings=None, step=0.58, levels=()):
    """A solid block under the planes clips, with a pocket for every opening of its walls ('+z', '-x', …).

    Its bottom and the faces on the clip planes lie inside other solids and are hidden.
    """
    openings = openings or {}
    m.part(group)
    first = len(m.faces)
    everything = [o for side in openings.values() for o in side]
    ys = lines(y0, y1, step, *[y for o in everything for y in (o["y0"], o["y1"])], *levels)
    walls = {"+z": Wall((0, 0, z[1]), (0., 0., 1.)), "-z": Wall((0, 0, z[0]), (0., 0., -1.)),
             "+x": Wall((x[1], 0, 0), (1., 0., 0.)), "-x": Wall((x[0], 0, 0), (-1., 0., 0.))}
    spans = {"+z": x, "-z": (-x[1], -x[0]), "+x": (-z[1], -z[0]), "-x": z}
    for side, wall in walls.items():
        holes = openings.get(side, [])
        ss = lines(*spans[side], step, *[s for o in holes for s in (o["s0"], o["s1"])])

        def inside(s, y, holes=holes):
            return any(o["s0"] < s < o["s1"] and o["y0"] < y < o["y1"] for o in holes)

        m.rect(wall.at(0, 0), wall.u, UP, ss, ys, material, inside, clips)
        for o in holes:
            os = [s for s in ss if o["s0"] <= s <= o["s1"]]
            oy = [y for y in ys if o["y0"] <= y <= o["y1"]]
            reveal = o["reveal"] or material
            m.rect(wall.at(0, 0, o["depth"]), wall.u, UP, os, oy, o["back"])
            back = [-o["depth"], 0.0]
            m.rect(wall.at(o["s0"], 0), (-wall.n[0], 0., -wall.n[2]), UP, [0.0, o["depth"]], oy, reveal)
            m.rect(wall.at(o["s1"], 0), wall.n, UP, back, oy, reveal)
            m.rect(wall.at(0, o["y0"]), wall.u, (-wall.n[0], 0., -wall.n[2]), os, [0.0, o["depth"]], reveal)
            m.rect(wall.at(0, o["y1"]), wall.u, wall.n, os, back, reveal)
    corners = {p for f in m.faces[first:] for p, _, _ in f[3]}
    for n, d in [((0., -1., 0.), -y0)] + [(unit(n), d / math.sqrt(dot(n, n))) for n, d in clips]:
        seen = {}
        for p in corners:
            if abs(dot(n, p) - d) < 1e-6:
                seen.setdefault(tuple(round(c, 4) for c in p), p)
        loop = list(seen.values())
        if len(loop) < 3:
            continue
        middle = tuple(sum(p[k] for p in loop) / len(loop) for k in range(3))
        a = unit(sub(loop[0], middle))
        b = cross(n, a)
        loop.sort(key=lambda p: math.atan2(dot(sub(p, middle), b), dot(sub(p, middle), a)))
        for i, p in enumerate(loop):
            triangle = [middle, p, loop[(i + 1) % len(loop)]]
            if dot(area_vector(triangle), n) > 1e-9:
                m.poly(triangle, "stone", hidden=True)
    return walls


def window(m, group, wall, o, columns=2, rows=2, trim="paint_white", shutters=None, head=0.14):
    """Frame, muntins, sill, casing and shutters of an opening made by body."""
    s0, s1, y0, y1, d = o["s0"], o["s1"], o["y0"], o["y1"], o["depth"]
    f, bury = 0.06, 0.012
    front, back = d - 0.085, d + bury
    wall.box(m, group, (s0 - bury, s0 + f), (y0 - bury, y1 + bury), (front, back), trim, "-z-x+y-y")
    wall.box(m, group, (s1 - f, s1 + bury), (y0 - bury, y1 + bury), (front, back), trim, "-z+x+y-y")
    for low, high, hide in ((y0 - bury, y0 + f + 0.01, "-y"), (y1 - f, y1 + bury, "+y")):
        wall.box(m, group, (s0 + f - 0.01, s1 - f + 0.01), (low, high), (front + 0.004, back - 0.004), trim, "-z-x+x" + hide)
    for i in range(1, columns):
        s = s0 + (s1 - s0) * i / columns
        wall.box(m, group, (s - 0.016, s + 0.016), (y0 + f, y1 - f + 0.01), (d - 0.045, back - 0.006), trim, "-z+y-y")
    for j in range(1, rows):
        y = y0 + (y1 - y0) * j / rows
        half, out = (0.03, 0.065) if 2 * j == rows else (0.016, 0.041)
        wall.box(m, group, (s0 + f - 0.012, s1 - f + 0.012), (y - half, y + half), (d - out, back - 0.008), trim, "-z+x-x")
    c = 0.09  # casing around the opening
    wall.box(m, group, (s0 - c, s0 - 0.008), (y0 - 0.02, y1 + 0.02), (-0.028, 0.03), trim, "-z+y-y")
    wall.box(m, group, (s1 + 0.008, s1 + c), (y0 - 0.02, y1 + 0.02), (-0.028, 0.03), trim, "-z+y-y")
    wall.box(m, group, (s0 - c - 0.03, s1 + c + 0.03), (y1 + 0.008, y1 + head), (-0.045, 0.032), trim, "-z+y")
    wall.box(m, group, (s0 - c - 0.06, s1 + c + 0.06), (y1 + head - 0.02, y1 + head + 0.035), (-0.085, 0.034), trim)
    wall.box(m, group, (s0 - c - 0.05, s1 + c + 0.05), (y0 - 0.075, y0 + 0.015), (-0.10, d - 0.07), trim)
    if shutters:
        w = (s1 - s0) * 0.42
        for a in (s0 - c - 0.02 - w, s1 + c + 0.02):
            shutter(m, group, wall, a, a + w, y0 + 0.027, y1 + 0.02, shutters)


def shutter(m, group, wall, s0, s1, y0, y1, material):
    """Stiles and rails around slanted louvres."""
    e = 0.055
    wall.box(m, group, (s0, s0 + e), (y0, y1), (-0.05, 0.012), material)
    wall.box(m, group, (s1 - e, s1), (y0, y1), (-0.05, 0.012), material)
    middle = (y0 + y1) / 2
    for low, high in ((y0 + 0.006, y0 + 0.08), (middle - 0.03, middle + 0.03), (y1 - 0.07, y1 - 0.006)):
        wall.box(m, group, (s0 + e - 0.008, s1 - e + 0.008), (low, high), (-0.045, 0.010), material, "-z-x+x")
    for low, high in ((y0 + 0.08, middle - 0.03), (middle + 0.03, y1 - 0.07)):
        n = max(3, round((high - low) / 0.125))
        for k in range(n):
            y = low + (high - low) * (k + 0.5) / n
            section = [(0.038, y - 0.045), (0.028, y - 0.058), (-0.012, y + 0.042), (-0.004, y + 0.055)]
            saved, m.place = m.place, lambda p: wall.at(p[0], p[1], -p[2])
            m.prism(group, section, s0 + e - 0.006, s1 - e + 0.006, "x", material, hide=(2,), hide_ends=True)
            m.place = saved


def column(m, group, x, z, y0, y1, r=0.125, material="paint_white", segments=16):
    """Plinth and abacus, torus base, tapered shaft with entasis, necking and echinus."""
    b = 1.45 * r
    m.box(group, (x - b, x + b), (y0 - 0.02, y0 + 0.09), (z - b, z + b), material, "-y")
    m.box(group, (x - b, x + b), (y1 - 0.07, y1 + 0.02), (z - b, z + b), material)
    h0, h1 = 0.08, y1 - y0 - 0.06
    profile = [(1.30, h0), (1.40, h0 + 0.04), (1.30, h0 + 0.08), (1.06, h0 + 0.10), (1.0, h0 + 0.16)]
    for k in range(1, 3):
        t = k / 2
        profile.append((1.0 - 0.16 * t ** 1.7, h0 + 0.16 + (h1 - h0 - 0.36) * t))
    profile += [(0.95, h1 - 0.185), (0.95, h1 - 0.155), (0.85, h1 - 0.14), (0.88, h1 - 0.075), (1.22, h1)]
    m.lathe(group, [(r * a, h) for a, h in profile], (x, y0, z), segments, material, hide="+y-y")


def picket(m, group, place, width, height, thickness, material):
    """A pointed board standing on the origin, facing +z, put in place."""
    w, saved = width / 2, m.place
    m.place = place
    m.prism(group, [(-w, 0.0), (w, 0.0), (w, height - w * 1.3), (0.0, height), (-w, height - w * 1.3)],
            -thickness / 2, thickness / 2, "z", material)
    m.place = saved


def log(m, group, end, direction, length, radius, turn, bark="bark", wood="cut_wood", segments=6):
    """A cylinder from end along a horizontal unit direction; its ends are cut wood."""
    side = cross(UP, direction)
    m.part(group)

    def at(k, t):
        a = turn + 2 * math.pi * k / segments
        return add(add(add(end, direction, t), side, radius * math.cos(a)), UP, radius * math.sin(a))

    def normal(k):
        a = turn + 2 * math.pi * k / segments
        return add((side[0] * math.cos(a), 0.0, side[2] * math.cos(a)), UP, math.sin(a))

    for k in range(segments):
        j = (k + 1) % segments
        m.poly([at(j, length), at(k, length), at(k, 0), at(j, 0)], bark,
               normals=[normal(j), normal(k), normal(k), normal(j)])
    m.poly([at(k, length) for k in range(segments)], wood)
    m.poly([at(k, 0) for k in range(segments)][::-1], wood)

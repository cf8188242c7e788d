"""The Cornell box and the test shapes: sphere, plane, wedge, sphere on a plane."""
import math

from .mesh import Mesh, area_vector, icosphere, lines, sphere_uv

# The Cornell box: https://www.graphics.cornell.edu/online/box/data.html, its measurements scaled by 0.01, turned by 180
# degrees about +Y so that the open front faces +Z, and centred on x = z = 0. Kd are linear.
CORNELL_KD = {"white": (0.73, 0.73, 0.71), "red": (0.61, 0.055, 0.045), "green": (0.115, 0.44, 0.09)}
WIDTH, HEIGHT, DEPTH, THICK = 5.528, 5.488, 5.592, 0.15
HOLE = 1.1  # half side of the light's opening in the ceiling


def cornell():
    m = Mesh({})
    w, d, t, over, step = WIDTH / 2, DEPTH / 2, THICK, 0.02, 0.6
    front = d  # every slab ends at its own depth in front, so that no two ends share a plane
    xs, ys, zs = lines(-w, w, step), lines(0.0, HEIGHT, step), lines(-d, front, step)

    def grown(cuts, low, high):
        return [cuts[0] - low] + cuts[1:-1] + [cuts[-1] + high]

    def slab(group, x, y, z, material):
        m.box(group, x, y, z, material, grow=0.0)

    # the walls end inside floor and ceiling, the back wall inside all of them
    slab("floor", [-w - t] + xs + [w + t], (-t, 0.0), [-d - t] + zs[:-1] + [front + 0.03], "white")
    slab("left", (-w - t + over, -w), grown(ys, t - over, t - over), grown(zs, t - over, 0.012), "red")
    slab("right", (w, w + t - over), grown(ys, t - over, t - over), grown(zs, t - over, 0.015), "green")
    slab("back", grown(xs, t - 2 * over, t - 2 * over), grown(ys, t - 2 * over, t - 2 * over), (-d - t + 2 * over, -d), "white")
    # ceiling with a square opening
    m.part("ceiling")
    x = lines(-w - t, w + t, step, -w, w, -HOLE, HOLE)
    z = lines(-d - t, front + 0.025, step, -d, -HOLE, HOLE)
    inside = lambda s, r: abs(s) < HOLE and abs(r) < HOLE
    y0, y1 = HEIGHT, HEIGHT + t
    rx, rz = [-c for c in reversed(x)], [-c for c in reversed(z)]
    X, Y, Z, nX, nZ = (1., 0., 0.), (0., 1., 0.), (0., 0., 1.), (-1., 0., 0.), (0., 0., -1.)
    m.rect((0, y1, 0), X, nZ, x, rz, "white", inside)
    m.rect((0, y0, 0), X, Z, x, z, "white", inside)
    for o, u, us in (((0, 0, z[-1]), X, x), ((0, 0, z[0]), nX, rx), ((x[-1], 0, 0), nZ, rz), ((x[0], 0, 0), Z, z)):
        m.rect(o, u, Y, us, [y0, y1], "white")
    hx, hz = [c for c in x if abs(c) <= HOLE], [c for c in z if abs(c) <= HOLE]
    for o, u, us in (((0, 0, -HOLE), X, hx), ((0, 0, HOLE), nX, [-c for c in reversed(hx)]),
                     ((-HOLE, 0, 0), nZ, [-c for c in reversed(hz)]), ((HOLE, 0, 0), Z, hz)):
        m.rect(o, u, Y, us, [y0, y1], "white")
    # blocks, sunk 2 cm into the floor
    for group, height, corners in (("short block", 1.65, ((130, 65), (82, 225), (240, 272), (290, 114))),
                                   ("tall block", 3.30, ((423, 247), (265, 296), (314, 456), (472, 406)))):
        m.part(group)
        p = [(w - x / 100, d - z / 100) for x, z in corners]
        ys = [-0.02] + lines(0.0, height, 0.42)
        if area_vector([(a, 0.0, b) for a, b in p])[1] < 0:
            p.reverse()  # counter-clockwise from above
        n = 4
        for i in range(4):
            a, b = p[i], p[(i + 1) % 4]
            at = lambda s, y: (a[0] + (b[0] - a[0]) * s / n, y, a[1] + (b[1] - a[1]) * s / n)
            for s in range(n):
                for y0, y1 in zip(ys, ys[1:]):
                    m.poly([at(s, y0), at(s + 1, y0), at(s + 1, y1), at(s, y1)], "white")
        def at2(i, j):
            s, t = i / n, j / n
            return tuple((1 - s) * (1 - t) * p[0][k] + s * (1 - t) * p[1][k] + s * t * p[2][k] + (1 - s) * t * p[3][k]
                         for k in (0, 1))
        for i in range(n):
            for j in range(n):
                q = [at2(i, j), at2(i + 1, j), at2(i + 1, j + 1), at2(i, j + 1)]
                m.poly([(a, height, b) for a, b in q], "white")
                m.poly([(a, -0.02, b) for a, b in reversed(q)], "white")
    return m


def cornell_mtl():
    out = ["# Materials of cornell.obj. Kd is linear."]
    for name, kd in CORNELL_KD.items():
        out += ["", "newmtl " + name, "Kd %g %g %g" % kd, "Ks 0 0 0"]
    return "\n".join(out) + "\n"


def sphere(m, centre=(0.0, 0.0, 0.0), group="sphere"):
    """Unit icosphere of 5120 triangles with exact normals."""
    points, triangles = icosphere(16)
    uv = sphere_uv(points)
    m.part(group)
    for t in triangles:
        m.poly([tuple(c + p for c, p in zip(centre, points[i])) for i in t], "", normals=[points[i] for i in t], uvs=uv(t))


def graded(first, last, ratio):
    """0, first, then gaps growing by ratio, ending at last."""
    out, gap = [0.0, first], first
    while True:
        gap *= ratio
        if out[-1] + 1.5 * gap >= last:
            return out + [last]
        out.append(round(out[-1] + gap, 4))


def both_ways(cuts):
    return [-c for c in reversed(cuts[1:])] + cuts


def plane():
    m = Mesh({})
    m.part("plane", closed=False)
    cuts = [-5 + 0.5 * i for i in range(21)]
    m.rect((0., 0., 0.), (1., 0., 0.), (0., 0., -1.), cuts, cuts, "")
    return m


def wedge():
    """Floor y = 0, x > 0 and wall x = 0, y > 0, 2000 m square each, meeting in the z axis."""
    m = Mesh({})
    m.part("floor", closed=False)
    out, along = graded(0.25, 2000.0, 1.5), both_ways(graded(0.5, 1000.0, 1.8))
    m.rect((0., 0., 0.), (1., 0., 0.), (0., 0., -1.), out, along, "")
    m.part("wall", closed=False)
    m.rect((0., 0., 0.), (0., 0., -1.), (0., 1., 0.), along, out, "")
    return m


def sphere_on_plane():
    """Unit sphere around (0, 1, 0) on a 100 m plane. Both get finer towards the contact at the origin."""
    m = Mesh({})
    m.part("sphere")
    around = 36
    polar = [math.radians(a) for a in (0, 2, 4, 7, 10, 14, 18, 23, 29, 36, 44, 52, 61, 70, 80, 90, 100, 110, 120, 130, 140,
                                       150, 160, 170, 180)]  # from the contact

    def at(i, k):
        a = 2 * math.pi * (k % around) / around
        s, c = (0.0, math.copysign(1, math.cos(polar[i]))) if i in (0, len(polar) - 1) else (math.sin(polar[i]), math.cos(polar[i]))
        return (s * math.sin(a), -c, s * math.cos(a))

    for i in range(len(polar) - 1):
        for k in range(around):
            corners = [(i, k), (i, k + 1), (i + 1, k + 1), (i + 1, k)]
            if i == 0:
                corners = [(0, k + 0.5)] + corners[2:]
            elif i == len(polar) - 2:
                corners = corners[:2] + [(i + 1, k + 0.5)]
            n = [at(i, k) for i, k in corners]
            m.poly([(x, y + 1, z) for x, y, z in n], "", normals=n, uvs=[(k / around, polar[i] / math.pi) for i, k in corners])
    m.part("plane", closed=False)
    cuts = both_ways(graded(0.1, 50.0, 1.6))
    m.rect((0., 0., 0.), (1., 0., 0.), (0., 0., -1.), cuts, cuts, "")
    return m


def unit_sphere():
    m = Mesh({})
    sphere(m)
    return m


MESHES = {
    "cornell/cornell.obj": (cornell, "Cornell box, by meshes/generate.py (MIT). Metres, +Y up, open to +Z.", "cornell.mtl", 4),
    "shapes/sphere.obj": (unit_sphere, "Unit sphere, by meshes/generate.py (MIT).", None, 5),
    "shapes/plane.obj": (plane, "Plane y = 0 of 10 x 10 m, by meshes/generate.py (MIT).", None, 4),
    "shapes/wedge.obj": (wedge, "Right-angled wedge, by meshes/generate.py (MIT).", None, 4),
    "shapes/sphere_on_plane.obj": (sphere_on_plane, "Unit sphere on a plane, by meshes/generate.py (MIT).", None, 5),
}


def files():
    yield "cornell/cornell.mtl", cornell_mtl()
    for path, (make, title, library, digits) in MESHES.items():
        yield path, make().obj(title, library, digits)

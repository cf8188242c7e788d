"""A builder of closed solids with world-scale UVs, and its OBJ writer.

Every solid is a part: its faces wind counter-clockwise seen from outside. A face marked hidden belongs to the part (the
checks need it to be closed) but is not written: it lies inside another solid, where nobody can see it, and would only
take atlas space.
"""
import math

EPS = 1e-7


def add(a, b, s=1.0):
    return (a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s)


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return (a[0] / length, a[1] / length, a[2] / length)


def area_vector(pts):
    n = (0.0, 0.0, 0.0)
    for i in range(1, len(pts) - 1):
        n = add(n, cross(sub(pts[i], pts[0]), sub(pts[i + 1], pts[0])), 0.5)
    return n


def clip(pts, plane):
    """The part of a convex polygon where normal·p <= d."""
    normal, d = plane
    out = []
    for i, p in enumerate(pts):
        q = pts[(i + 1) % len(pts)]
        hp, hq = dot(normal, p) - d, dot(normal, q) - d
        if hp <= EPS:
            out.append(p)
        if (hp < -EPS and hq > EPS) or (hp > EPS and hq < -EPS):
            out.append(add(p, sub(q, p), hp / (hp - hq)))
    return out if len(out) >= 3 and math.sqrt(dot(area_vector(out), area_vector(out))) > 1e-6 else []


def lines(a, b, step, *more):
    """Sorted cuts from a to b with every value of more among them and no gap wider than about step."""
    cuts = sorted({round(c, 6) for c in (a, b) + more if a - EPS <= c <= b + EPS})
    out = [cuts[0]]
    for c in cuts[1:]:
        n = max(1, math.ceil((c - out[-1]) / step - 0.15))
        start = out[-1]
        out += [round(start + (c - start) * i / n, 6) for i in range(1, n + 1)]
    return out


def texture_axes(n):
    """Unit u (right) and v (up, or up the slope) of the texture on a face with outward normal n, seen from outside."""
    if abs(n[1]) > 0.98:
        return (1.0, 0.0, 0.0), (0.0, 0.0, -1.0 if n[1] > 0 else 1.0)
    u = unit((n[2], 0.0, -n[0]))
    return u, cross(n, u)


class Mesh:
    def __init__(self, tiles):
        self.tiles = tiles  # metres per texture repetition, by material; 1 where absent
        self.faces = []  # (part, material, hidden, [(position, normal, uv)] * 3)
        self.parts = []  # (group, closed)
        self.place = lambda p: p
        self.uv_turn = False
        self.uv_shift = (0.0, 0.0)

    def part(self, group, closed=True):
        self.parts.append((group, closed))

    def uv(self, p, n, material):
        u, v = texture_axes(n)
        s, t = dot(p, u), dot(p, v)
        if self.uv_turn:  # a quarter turn, so that boards run upward
            s, t = t, -s
        tile = self.tiles.get(material, 1.0)
        return (s + self.uv_shift[0]) / tile, (t + self.uv_shift[1]) / tile

    def poly(self, pts, material, hidden=False, normals=None, uvs=None):
        """A convex planar polygon (normals and uvs are by corner where given)."""
        pts = [self.place(p) for p in pts]
        n = unit(area_vector(pts))
        normals = normals or [n] * len(pts)
        uvs = uvs or [self.uv(p, n, material) for p in pts]
        corners = list(zip(pts, normals, uvs))
        if len(pts) == 4:  # the shorter diagonal
            if dot(sub(pts[0], pts[2]), sub(pts[0], pts[2])) > dot(sub(pts[1], pts[3]), sub(pts[1], pts[3])) + EPS:
                corners = corners[1:] + corners[:1]
        if len(pts) > 4:  # start where no fan triangle is thin
            def worst(k):
                q = pts[k:] + pts[:k]
                return min(math.sqrt(dot(a, a)) for a in
                           (area_vector([q[0], q[i], q[i + 1]]) for i in range(1, len(q) - 1)))
            k = max(range(len(pts)), key=worst)
            corners = corners[k:] + corners[:k]
        for i in range(1, len(corners) - 1):
            self.faces.append((len(self.parts) - 1, material, hidden, [corners[0], corners[i], corners[i + 1]]))

    def rect(self, origin, u, v, us, vs, material, hole=None, clips=(), hidden=None):
        """The cells of us × vs on the plane origin + s·u + t·v (outward normal u × v).

        material and hidden may be functions of the cell's centre, hole one of its (s, t).
        """
        for i in range(len(us) - 1):
            for j in range(len(vs) - 1):
                if hole and hole((us[i] + us[i + 1]) / 2, (vs[j] + vs[j + 1]) / 2):
                    continue
                pts = [add(add(origin, u, s), v, t) for s, t in
                       ((us[i], vs[j]), (us[i + 1], vs[j]), (us[i + 1], vs[j + 1]), (us[i], vs[j + 1]))]
                for c in clips:
                    pts = clip(pts, c) if pts else pts
                if not pts:
                    continue
                centre = tuple(sum(p[k] for p in pts) / len(pts) for k in range(3))
                self.poly(pts, material(centre) if callable(material) else material,
                          bool(hidden and hidden(centre)))

    def box(self, group, x, y, z, material, hide="", grow=None):
        """x, y, z: (low, high) or lists of cuts. hide: faces as '+y-x', or a function of face and cell centre.

        Each box is up to 4 mm larger than asked, by its place in the order, so that faces of neighbours that would
        share a plane do not (unless grow is given).
        """
        self.part(group)
        grow = 0.0006 * (len(self.parts) % 7) if grow is None else grow
        x, y, z = ([c[0] - grow] + list(c[1:-1]) + [c[-1] + grow] for c in (x, y, z))
        X, Y, Z = (1., 0., 0.), (0., 1., 0.), (0., 0., 1.)
        nX, nZ = (-1., 0., 0.), (0., 0., -1.)
        rx, rz = [-c for c in reversed(x)], [-c for c in reversed(z)]
        for name, o, u, v, us, vs in (("+z", (0, 0, z[-1]), X, Y, x, y), ("-z", (0, 0, z[0]), nX, Y, rx, y),
                                      ("+x", (x[-1], 0, 0), nZ, Y, rz, y), ("-x", (x[0], 0, 0), Z, Y, z, y),
                                      ("+y", (0, y[-1], 0), X, nZ, x, rz), ("-y", (0, y[0], 0), X, Z, x, z)):
            self.rect(o, u, v, us, vs, material,
                      hidden=(lambda c, name=name: hide(name, c)) if callable(hide) else (lambda c, name=name: name in hide))

    def prism(self, group, outline, low, high, axis, material, ends=None, pieces=None, sides=None, cuts=None, hide=(),
              hide_ends=False):
        """Extrudes an outline along an axis: 'x' takes (z, y) points, 'z' takes (x, y), 'y' takes (x, z).

        pieces: the end caps as convex index lists (default: the outline is convex). sides, hide: by outline edge.
        """
        self.part(group)
        at = {"x": lambda p, t: (t, p[1], p[0]), "z": lambda p, t: (p[0], p[1], t),
              "y": lambda p, t: (p[0], t, p[1])}[axis]
        area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(outline, outline[1:] + outline[:1]))
        # (z, y) seen along x is mirrored, and so is (x, z) along y
        forward = (area > 0) == (axis == "z")
        ts = cuts or [low, high]
        for i in range(len(outline)):
            a, b = outline[i], outline[(i + 1) % len(outline)]
            if not forward:
                a, b = b, a
            for t0, t1 in zip(ts, ts[1:]):
                self.poly([at(a, t0), at(b, t0), at(b, t1), at(a, t1)], (sides or {}).get(i, material), i in hide)
        for piece in pieces or [range(len(outline))]:
            p = [outline[i] for i in piece]
            p = p if forward else p[::-1]
            self.poly([at(q, ts[-1]) for q in p], ends or material, hide_ends)
            self.poly([at(q, ts[0]) for q in reversed(p)], ends or material, hide_ends)

    def lathe(self, group, profile, centre, segments, material, crease=35.0, turn=0.0, hide=""):
        """A solid of revolution about +Y: profile is [(radius, height)] upward, closed by flat ends (hide: '+y-y')."""
        self.part(group)
        tile = self.tiles.get(material, 1.0)
        widest = max(r for r, _ in profile)
        around = max(1, round(2 * math.pi * widest / tile))  # whole repetitions
        spans = []
        for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
            length = math.hypot(r1 - r0, y1 - y0)
            spans.append(((y1 - y0) / length, -(r1 - r0) / length, length))  # outward (radial, up)

        def joined(i, j):
            if not (0 <= i < len(spans) and 0 <= j < len(spans)):
                return None
            c = spans[i][0] * spans[j][0] + spans[i][1] * spans[j][1]
            return spans[j] if c > math.cos(math.radians(crease)) else None

        angles = [turn + 2 * math.pi * k / segments for k in range(segments + 1)]
        angles[-1] = angles[0] + 2 * math.pi
        ring = [(math.sin(a), math.cos(a)) for a in angles[:-1]]
        ring.append(ring[0])

        def at(r, y, k):
            return (centre[0] + r * ring[k][0], centre[1] + y, centre[2] + r * ring[k][1])

        travelled = 0.0
        for i, ((r0, y0), (r1, y1)) in enumerate(zip(profile, profile[1:])):
            ends = []
            for other in (joined(i, i - 1), joined(i, i + 1)):
                nr, ny = spans[i][0] + (other[0] if other else 0), spans[i][1] + (other[1] if other else 0)
                s = math.hypot(nr, ny)
                ends.append((nr / s, ny / s))
            v0, v1 = travelled / tile, (travelled + spans[i][2]) / tile
            travelled += spans[i][2]
            for k in range(segments):
                u0, u1 = around * k / segments, around * (k + 1) / segments
                corners = [(r0, y0, k, ends[0], u0, v0), (r0, y0, k + 1, ends[0], u1, v0),
                           (r1, y1, k + 1, ends[1], u1, v1), (r1, y1, k, ends[1], u0, v1)]
                if r0 < EPS:
                    corners = [corners[0][:4] + ((u0 + u1) / 2, v0)] + corners[2:]
                elif r1 < EPS:
                    corners = corners[:2] + [corners[2][:4] + ((u0 + u1) / 2, v1)]
                self.poly([at(r, y, j) for r, y, j, *_ in corners], material,
                          normals=[(n[0] * ring[j][0], n[1], n[0] * ring[j][1]) for _, _, j, n, _, _ in corners],
                          uvs=[(u, v) for *_, u, v in corners])
        for (r, y), order, name in ((profile[0], range(segments - 1, -1, -1), "-y"), (profile[-1], range(segments), "+y")):
            if r > EPS:
                self.poly([at(r, y, k) for k in order], material, name in hide)

    def blob(self, group, centre, radii, frequency, material, bumps=0.0, seed=0):
        """A displaced icosphere with smooth normals."""
        points, triangles = icosphere(frequency)

        def bump(p):
            s = 0.0
            for k in range(1, 5):
                a = seed * 1.7 + k * 2.1
                s += math.sin(3.1 * k * p[0] + a) * math.sin(2.7 * k * p[1] + 1.3 * a) * math.cos(2.9 * k * p[2] - a) / k
            return 1.0 + bumps * s

        pos = [add(centre, (p[0] * radii[0] * bump(p), p[1] * radii[1] * bump(p), p[2] * radii[2] * bump(p)))
               for p in points]
        normals = [(0.0, 0.0, 0.0)] * len(pos)
        for t in triangles:
            n = area_vector([pos[i] for i in t])
            for i in t:
                normals[i] = add(normals[i], n)
        normals = [unit(n) for n in normals]
        uv = sphere_uv(points)
        self.part(group)
        for t in triangles:
            self.poly([pos[i] for i in t], material, normals=[normals[i] for i in t], uvs=uv(t))

    def visible(self):
        return [f for f in self.faces if not f[2]]

    def obj(self, title, library, digits=4, uv_digits=4):
        """OBJ text: one o per group, one usemtl per material in it, shared v, vt and vn."""
        def text(values, digits):
            out = []
            for x in values:
                s = "%.*f" % (digits, x)
                s = s.rstrip("0").rstrip(".")
                out.append("0" if s == "-0" else s)
            return " ".join(out)

        tables = {"v": {}, "vt": {}, "vn": {}}

        def index(kind, values, digits):
            return tables[kind].setdefault(text(values, digits), len(tables[kind]) + 1)

        order, body = {}, []
        for part, material, _, corners in self.visible():
            order.setdefault(self.parts[part][0], {}).setdefault(material, []).append(corners)
        for group, materials in order.items():
            body.append("o " + group)
            for material, faces in materials.items():
                if material:
                    body.append("usemtl " + material)
                for corners in faces:
                    body.append("f " + " ".join("%d/%d/%d" % (index("v", p, digits), index("vt", t, uv_digits),
                                                             index("vn", n, 4)) for p, n, t in corners))
        head = ["# " + title] + (["mtllib " + library] if library else [])
        return "\n".join(head + ["%s %s" % (kind, s) for kind, table in tables.items() for s in table] + body) + "\n"


def icosphere(frequency):
    """Unit icosphere: points, counter-clockwise triangles (20·frequency²)."""
    g = (1 + math.sqrt(5)) / 2
    corners = [unit(p) for p in ((-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
                                 (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1))]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    points, known, triangles = [], {}, []

    def point(weights):  # shared by the faces around it: keyed by corner and weight
        key = tuple(sorted((c, w) for c, w in weights if w))
        if key not in known:
            known[key] = len(points)
            p = (0.0, 0.0, 0.0)
            for c, w in key:
                p = add(p, corners[c], w)
            points.append(unit(p))
        return known[key]

    n = frequency
    for a, b, c in faces:
        at = lambda i, j: point(((a, n - i - j), (b, i), (c, j)))
        for i in range(n):
            for j in range(n - i):
                triangles.append((at(i, j), at(i + 1, j), at(i, j + 1)))
                if i + j < n - 1:
                    triangles.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
    return points, triangles


def sphere_uv(points):
    """Longitude–latitude UVs of triangles on the unit sphere, unwrapped across the seam and at the poles."""
    def uv(t):
        us = [None if math.hypot(points[i][0], points[i][2]) < 1e-6 else
              math.atan2(points[i][0], points[i][2]) / (2 * math.pi) + 0.5 for i in t]
        known = [u for u in us if u is not None]
        if max(known) - min(known) > 0.5:
            us = [u if u is None or u > 0.5 else u + 1 for u in us]
            known = [u for u in us if u is not None]
        us = [sum(known) / len(known) if u is None else u for u in us]
        return [(u, math.asin(max(-1, min(1, points[i][1]))) / math.pi + 0.5) for u, i in zip(us, t)]
    return uv

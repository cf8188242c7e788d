"""What must hold of a built mesh."""
import collections
import math

import numpy as np


def problems(mesh):
    """Degenerate or non-finite triangles, mirrored or collapsed UVs, open or inside-out closed parts."""
    out = []
    by_part = collections.defaultdict(list)
    for part, material, hidden, corners in mesh.faces:
        p = np.round([c[0] for c in corners], 4)
        n, t = np.array([c[1] for c in corners]), np.array([c[2] for c in corners])
        by_part[part].append(p)
        where = "%s (%s) near %s" % (mesh.parts[part][0], material, p.mean(0).round(2))
        if not all(np.isfinite(x).all() for x in (p, n, t)):
            out.append("not finite: " + where)
            continue
        e1, e2 = p[1] - p[0], p[2] - p[0]
        area = np.cross(e1, e2)
        size = np.linalg.norm(area) / 2
        longest = max(np.linalg.norm(e1), np.linalg.norm(e2), np.linalg.norm(p[2] - p[1]))
        if size < 1e-7 or size / longest ** 2 < 1e-4:
            out.append("thin (%.1e m2): %s" % (size, where))
            continue
        if (n @ area).min() <= 0 or abs(np.linalg.norm(n, axis=1) - 1).max() > 1e-3:
            out.append("normal against winding: " + where)
        if not hidden:
            d1, d2 = t[1] - t[0], t[2] - t[0]
            det = d1[0] * d2[1] - d1[1] * d2[0]
            if det <= 1e-9:
                out.append("uv area %.1e: %s" % (det, where))
    for part, triangles in by_part.items():
        group, closed = mesh.parts[part]
        if not closed:
            continue
        t = np.array(triangles)
        edges = collections.Counter()
        for tri in t:
            q = [tuple(x) for x in tri]
            for i in range(3):
                edges[(q[i], q[(i + 1) % 3])] += 1
        open_edges = [e for e, k in edges.items() if k != 1 or edges.get((e[1], e[0])) != 1]
        volume = np.einsum("ij,ij->i", np.cross(t[:, 0], t[:, 1]), t[:, 2]).sum() / 6
        middle = t.reshape(-1, 3).mean(0).round(2)
        if open_edges:
            out.append("%d open edges: part %d of %s near %s, e.g. %s" % (len(open_edges), part, group, middle, open_edges[0]))
        if volume <= 0:
            out.append("volume %.2e: part %d of %s near %s" % (volume, part, group, middle))
    return out


def exposed(mesh):
    """Hidden faces of which some point lies in no other closed part (nor below the ground)."""
    triangles = collections.defaultdict(list)
    for part, _, _, corners in mesh.faces:
        triangles[part].append([c[0] for c in corners])
    solids = [(k, np.array(t)) for k, t in triangles.items() if mesh.parts[k][1]]
    low = np.array([t.min((0, 1)) for _, t in solids])
    high = np.array([t.max((0, 1)) for _, t in solids])
    out = collections.Counter()
    for part, material, hidden, corners in mesh.faces:
        if not hidden or not mesh.parts[part][1]:
            continue
        p = np.array([c[0] for c in corners])
        for w in ((1, 1, 1), (0.9, 0.05, 0.05), (0.05, 0.9, 0.05), (0.05, 0.05, 0.9)):
            q = np.array(w) @ p / sum(w)
            if q[1] < 0:
                continue
            for i in np.nonzero((low <= q).all(1) & (high >= q).all(1))[0]:
                if solids[i][0] == part:
                    continue
                a, b, c = (solids[i][1][:, k] - q for k in range(3))
                la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
                dot = np.einsum
                solid = 2 * np.arctan2(dot("ij,ij->i", np.cross(a, b), c), la * lb * lc + dot("ij,ij->i", a, b) * lc +
                                       dot("ij,ij->i", b, c) * la + dot("ij,ij->i", c, a) * lb)
                if solid.sum() > 2 * math.pi:
                    break
            else:
                out[(part, mesh.parts[part][0], material, tuple(q.round(2)))] += 1
    return out


def _clip(poly, a, b):
    d = b - a
    out = []
    h = [d[0] * (q[1] - a[1]) - d[1] * (q[0] - a[0]) for q in poly]
    for i, q in enumerate(poly):
        j = (i + 1) % len(poly)
        if h[i] >= 0:
            out.append(q)
        if (h[i] > 0 > h[j]) or (h[i] < 0 < h[j]):
            out.append(q + (poly[j] - q) * (h[i] / (h[i] - h[j])))
    return out


def coplanar_overlaps(mesh, distance=5e-4, least=2e-6):
    """Pairs of written triangles that lie in one plane (either facing) and overlap."""
    faces = mesh.visible()
    p = np.array([[c[0] for c in f[3]] for f in faces])
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    sign = np.sign(n[np.arange(len(n)), np.abs(n).argmax(1)])
    n *= sign[:, None]
    buckets = collections.defaultdict(list)
    key_n = np.round(n * 50).astype(int)
    d = np.einsum("ij,ij->i", n, p[:, 0])
    for i in range(len(p)):
        buckets[tuple(key_n[i])].append(i)
    found = []
    for bucket in buckets.values():
        index = np.array(bucket)
        index = index[np.argsort(d[index])]
        low, high = p[index].min(1) - distance, p[index].max(1) + distance
        for a in range(len(index)):
            i = index[a]
            b = a + 1
            stop = np.searchsorted(d[index], d[i] + distance * 40, side="right")
            if b >= stop:
                continue
            near = np.nonzero((low[b:stop] <= high[a]).all(1) & (high[b:stop] >= low[a]).all(1))[0] + b
            for b in near:
                j = index[b]
                if n[i] @ n[j] < 0.9998 or abs((p[j] - p[i, 0]) @ n[i]).max() > distance:
                    continue
                axis = np.delete(np.arange(3), np.abs(n[i]).argmax())
                s, t = p[i][:, axis], p[j][:, axis]
                if np.cross(s[1] - s[0], s[2] - s[0]) < 0:
                    s = s[::-1]
                poly = list(t)
                for k in range(3):
                    poly = _clip(poly, s[k], s[(k + 1) % 3]) if len(poly) > 2 else []
                if len(poly) > 2:
                    q = np.array(poly)
                    area = abs(np.dot(q[:, 0], np.roll(q[:, 1], 1)) - np.dot(q[:, 1], np.roll(q[:, 0], 1))) / 2
                    if area > least:
                        found.append((area, mesh.parts[faces[i][0]][0], faces[i][0], mesh.parts[faces[j][0]][0], faces[j][0],
                                      q.mean(0).round(3), p[i].mean(0).round(3), n[i].round(2)))
    return found

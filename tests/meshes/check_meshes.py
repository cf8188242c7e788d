#!/usr/bin/python3
"""Golden checks of the meshes that ship with the project.

    check_meshes.py regenerate   meshes/generate.py reproduces every committed file (pixels within one level)
    check_meshes.py geometry     solids closed and outward, nothing degenerate, mirrored, coplanar or wrongly hidden
    check_meshes.py obj          the same of the OBJ files as written, and every material and texture they name exists
    check_meshes.py textures     maps tile without a seam, normals are unit and point out, albedo is plausible

Exit 0: as expected; 1: not; 77: numpy is missing, nothing was checked.
"""
import filecmp
import os
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
MESHES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "meshes")
sys.path.insert(0, MESHES)
try:
    import numpy as np
except ImportError:
    print("check_meshes: skipped: this python has no numpy (Debian: python3-numpy)")
    sys.exit(77)
from generate import check, house, png, simple, textures  # noqa: E402

GENERATED = ("house", "cornell", "shapes")
TRIANGLES = {"house/house.obj": (12000, 17000), "cornell/cornell.obj": (2000, 6000), "shapes/sphere.obj": (5120, 5120),
             "shapes/plane.obj": (800, 800), "shapes/wedge.obj": (1000, 4000), "shapes/sphere_on_plane.obj": (2000, 4000)}


def listing(root):
    return sorted(os.path.relpath(os.path.join(d, f), root) for top in GENERATED
                  for d, _, files in os.walk(os.path.join(root, top)) for f in files)


def image(path):
    with open(path, "rb") as f:
        return png.decode(f.read())


def regenerate():
    bad = []
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([sys.executable, "-B", os.path.join(MESHES, "generate.py"), "--out", out], check=True)
        if listing(out) != listing(MESHES):
            bad.append("files differ: %s" % sorted(set(listing(out)) ^ set(listing(MESHES))))
        for name in set(listing(out)) & set(listing(MESHES)):
            a, b = os.path.join(out, name), os.path.join(MESHES, name)
            if name.endswith(".png"):
                x, y = image(a).astype(int), image(b).astype(int)
                # numpy's functions may differ in the last bit between processors: a few texels may fall on the other side
                # of a rounding, by one level of at most 3
                if x.shape != y.shape or abs(x - y).max() > 3 or (x != y).mean() > 1e-3:
                    bad.append(name + ": pixels differ")
            elif not filecmp.cmp(a, b, shallow=False):
                bad.append(name + ": text differs")
    return bad


def geometry():
    bad = []
    for name, make in [("house", house.make)] + [(k, v[0]) for k, v in simple.MESHES.items()]:
        m = make()
        found = check.problems(m)
        if name == "house":
            found += ["hidden face exposed: %s" % (k,) for k in check.exposed(m)]
        if not name.endswith("sphere.obj"):
            found += ["coplanar overlap: %s" % (x,) for x in check.coplanar_overlaps(m)]
        bad += ["%s: %s" % (name, x) for x in found]
    return bad


def read_mtl(path):
    names, files = set(), []
    with open(path) as f:
        for line in f:
            word = line.split()
            if word[:1] == ["newmtl"]:
                names.add(word[1])
            elif word[:1] in (["map_Kd"], ["norm"]):
                files.append(word[1])
    return names, [f for f in files if not os.path.isfile(os.path.join(os.path.dirname(path), f))]


def obj():
    bad = []
    for name, (least, most) in TRIANGLES.items():
        path = os.path.join(MESHES, name)
        tables, faces, materials, used = {"v": [], "vt": [], "vn": []}, [], set(), set()
        with open(path) as f:
            for line in f:
                word = line.split()
                if word[0] in tables:
                    tables[word[0]].append([float(x) for x in word[1:]])
                elif word[0] == "f":
                    faces.append([[int(i) - 1 for i in corner.split("/")] for corner in word[1:]])
                elif word[0] == "usemtl":
                    used.add(word[1])
                elif word[0] == "mtllib":
                    materials, missing = read_mtl(os.path.join(os.path.dirname(path), word[1]))
                    bad += ["%s: missing texture %s" % (name, m) for m in missing]
        if used - materials:
            bad.append("%s: materials without definition: %s" % (name, sorted(used - materials)))
        if not least <= len(faces) <= most:
            bad.append("%s: %d triangles" % (name, len(faces)))
        i = np.array(faces)
        p, t, n = (np.array(tables[k])[i[..., c]] for c, k in enumerate(("v", "vt", "vn")))
        area = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        d1, d2 = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
        for what, wrong in (("degenerate", np.linalg.norm(area, axis=1) < 2e-7),
                            ("mirrored or collapsed uv", d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0] <= 0),
                            ("normal against winding", (np.einsum("ijk,ik->ij", n, area) <= 0).any(1)),
                            ("normal not unit", (abs(np.linalg.norm(n, axis=2) - 1) > 1e-3).any(1))):
            if wrong.any():
                bad.append("%s: %d triangles: %s, first near %s" % (name, wrong.sum(), what, p[wrong.argmax()].mean(0)))
    return bad


def maps():
    bad = []
    for name in textures.MAPS:
        albedo = image(os.path.join(MESHES, "house", name + "_albedo.png")) / 255.0
        code = image(os.path.join(MESHES, "house", name + "_normal.png"))
        normal = code / 127.5 - 1
        linear = np.where(albedo <= 0.04045, albedo / 12.92, ((albedo + 0.055) / 1.055) ** 2.4)
        if linear.max() > 0.8 or not 0.05 < linear.mean() < 0.7:
            bad.append("%s: albedo mean %.2f, max %.2f" % (name, linear.mean(), linear.max()))
        if abs(np.linalg.norm(normal, axis=2) - 1).max() > 0.03 or normal[..., 2].min() < 0.5:
            bad.append(name + ": normals are not unit, or steeper than 60 degrees")
        if abs(normal[..., :2].mean((0, 1))).max() > 0.02:
            bad.append("%s: mean normal %s is not straight up" % (name, normal.mean((0, 1))))
        for what, x in (("albedo", albedo), ("normal", normal)):
            for axis in (0, 1):  # the step over the border is like the steps inside
                steps = abs(np.diff(x, axis=axis)).mean((1 - axis, 2))
                border = abs(x.take(0, axis) - x.take(-1, axis)).mean()
                if border > 1.2 * steps.max() + 1e-3:
                    bad.append("%s %s: seam across axis %d: %.3f, inside at most %.3f" % (name, what, axis, border, steps.max()))
    return bad


def main():
    cases = {"regenerate": regenerate, "geometry": geometry, "obj": obj, "textures": maps}
    if len(sys.argv) != 2 or sys.argv[1] not in cases:
        print(__doc__)
        return 2
    bad = cases[sys.argv[1]]()
    for line in bad[:40]:
        print("check_meshes: " + line)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

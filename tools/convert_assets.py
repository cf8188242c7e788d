#!/usr/bin/python3
"""Turns the fetched npm packages into the files of assets/. Python standard library only; runs no package code.

    convert_assets.py environments  PMNDRS.tgz  OUT     hdri/*.exr and normals/*.webp
    convert_assets.py rooms         SEM.tgz     OUT     rooms/*.ply

Every step is exact (copies, permutations, one float subtraction), so the outputs can be pinned by sha256.
"""
import array
import base64
import json
import os
import struct
import sys
import tarfile

NORMALS = ("0000", "0005", "0010", "0015")
ROOMS = {  # output name: capture in the package
    "music": "music_room",
    "living": "living_room",
    "office_large": "office_large",
    "meeting": "meeting_room",
}
CLOSED = ("music",)  # also written uncut: the largest input, for tests of size rather than of light
CUT = 0.38  # share of the height removed from the top, so that light enters the scanned (closed) rooms


def write(out, name, data):
    path = os.path.join(out, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(data)


def member(tar, name):
    f = tar.extractfile(name)
    if f is None:
        raise KeyError(name)
    return f.read()


def data_uri(js):
    """The payload of a module of the form: export default 'data:...;base64,PAYLOAD'"""
    text = js.decode("ascii")
    start = text.index("base64,") + len("base64,")
    end = min(i for i in (text.find(q, start) for q in "'\"`") if i >= 0)
    return base64.b64decode(text[start:end], validate=True)


def environments(tgz, out):
    with tarfile.open(tgz) as tar:
        names = [m.name for m in tar.getmembers() if m.isfile()]
        for n in sorted(names):
            if n.startswith("package/hdri/") and n.endswith(".exr.js"):
                data = data_uri(member(tar, n))
                if data[:4] != b"\x76\x2f\x31\x01":
                    raise ValueError(n + ": not an OpenEXR file")
                write(out, "hdri/" + os.path.basename(n)[:-3], data)
        for n in NORMALS:
            data = data_uri(member(tar, "package/normals/%s.webp.js" % n))
            if data[:4] != b"RIFF" or data[8:12] != b"WEBP":
                raise ValueError(n + ": not a WebP file")
            write(out, "normals/%s.webp" % n, data)


def f32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def room(capture):
    """Scan in its own frame (Z up, float32 xyz, uint32 indices) -> positions and triangles, Y up, floor near y = 0."""
    entities = [e for e in json.loads(capture)["spatialEntities"] if "triangleMesh_META" in e]
    if len(entities) != 1:
        raise ValueError("expected one mesh, found %d" % len(entities))
    mesh, floor = entities[0]["triangleMesh_META"], entities[0]["locatable_META"]["position"]["y"]
    v, t = array.array("f"), array.array("I")
    v.frombytes(base64.b64decode(mesh["vertices"]))
    t.frombytes(base64.b64decode(mesh["indices"]))
    if sys.byteorder == "big":
        v.byteswap()
        t.byteswap()
    # (x, y, z) -> (x, z, -y): a rotation by -90 degrees about x, determinant +1. The scanner's height of the
    # origin above the floor puts the floor at y = 0.
    points = [(v[i], f32(v[i + 2] + floor), 0.0 - v[i + 1]) for i in range(0, len(v), 3)]
    triangles = [(t[i], t[i + 1], t[i + 2]) for i in range(0, len(t), 3)]
    return points, triangles


def cut_top(points, triangles):
    ys = [p[1] for p in points]
    limit = max(ys) - CUT * (max(ys) - min(ys))
    kept = [t for t in triangles if all(points[i][1] <= limit for i in t)]
    index = {}
    for t in kept:
        for i in t:
            index.setdefault(i, len(index))
    return [points[i] for i in index], [tuple(index[i] for i in t) for t in kept]


def ply(points, triangles, comment):
    head = ("ply\nformat binary_little_endian 1.0\ncomment %s\nelement vertex %d\n"
            "property float x\nproperty float y\nproperty float z\nelement face %d\n"
            "property list uchar int vertex_indices\nend_header\n") % (comment, len(points), len(triangles))
    body = b"".join(struct.pack("<3f", *p) for p in points)
    body += b"".join(struct.pack("<B3i", 3, *t) for t in triangles)
    return head.encode("ascii") + body


def rooms(tgz, out):
    with tarfile.open(tgz) as tar:
        for name, source in ROOMS.items():
            points, triangles = room(member(tar, "package/captures/%s.json" % source))
            if name in CLOSED:
                write(out, "rooms/%s_closed.ply" % name,
                      ply(points, triangles, "from @iwer/sem 2.4.0 (MIT), Y up, metres, closed as scanned"))
            points, triangles = cut_top(points, triangles)
            write(out, "rooms/%s.ply" % name,
                  ply(points, triangles, "from @iwer/sem 2.4.0 (MIT), Y up, metres, top 38 % cut off"))


if __name__ == "__main__":
    steps = {"environments": environments, "rooms": rooms}
    if len(sys.argv) != 4 or sys.argv[1] not in steps:
        sys.exit(__doc__.strip())
    try:
        steps[sys.argv[1]](sys.argv[2], sys.argv[3])
    except (OSError, KeyError, ValueError, tarfile.TarError) as e:
        sys.exit("convert_assets: %s: %s" % (os.path.basename(sys.argv[2]), e))

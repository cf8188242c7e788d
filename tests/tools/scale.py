#!/usr/bin/python3
"""A mesh of five million triangles: the bunny, each face cut into 81, smooth as it is and rough as a scan, baked
uniformly and adaptively, per texel and per vertex; and two million separate triangles. Prints time and memory; exit 1
where a run fails or takes more memory than its bound, 77 without assets or numpy.

An interrupt is sent at several moments of a bake: it must end with 130 and leave nothing behind."""
import argparse
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIP = 77
MOST_MEMORY = 6e9         # bytes, of any run
CUTS = 9                  # of an edge: 81 faces for each
SOUP = 2_000_000          # triangles
INTERRUPTED = 130
INTERRUPT_SECONDS = (0.3, 1.5, 4, 8, 16, 30, 60)
LEAVES = 120              # seconds until an interrupted run counts as hanging

try:
    import numpy as np
except ImportError:
    print("scale: skipped: this python has no numpy (Debian: python3-numpy)")
    sys.exit(SKIP)


def read_obj(path):
    points, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    return np.array(points), np.array(faces)


def cut(points, faces, cuts):
    """Each edge into `cuts`, each face into cuts² of its shape; neighbours share the new vertices."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    low, high = sides.min(1), sides.max(1)
    edges, edge = np.unique(low.astype(np.int64) * len(points) + high, return_inverse=True)
    a, b = points[edges // len(points)], points[edges % len(points)]
    steps = np.arange(1, cuts) / cuts
    on_edges = a[:, None] + steps[None, :, None] * (b - a)[:, None]
    cells = [(i, j) for i in range(1, cuts) for j in range(1, cuts - i)]
    corner = points[faces]
    inner = np.stack([((cuts - i - j) * corner[:, 0] + i * corner[:, 1] + j * corner[:, 2]) / cuts
                      for i, j in cells], 1)
    first_edge, first_inner = len(points), len(points) + on_edges.shape[0] * (cuts - 1)
    turned = (sides[:, 0] != low).reshape(3, -1)
    edge = edge.reshape(3, -1)

    def along(side, step):
        step = np.where(turned[side], cuts - step, step)
        return first_edge + edge[side] * (cuts - 1) + step - 1

    def vertex(i, j):  # i cuts towards corner 1, j towards corner 2
        if (i, j) in cells:
            return first_inner + np.arange(len(faces)) * len(cells) + cells.index((i, j))
        if i + j == 0 or i == cuts or j == cuts:
            return faces[:, 0 if i + j == 0 else 1 if i == cuts else 2]
        return along(0, i) if j == 0 else along(2, cuts - j) if i == 0 else along(1, j)

    finer = []
    for i in range(cuts):
        for j in range(cuts - i):
            finer.append(np.stack([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)], 1))
            if i + j < cuts - 1:
                finer.append(np.stack([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)], 1))
    # Faces of one old face follow each other, as a subdivision writes them.
    finer = np.stack(finer, 1).reshape(-1, 3)
    return np.concatenate([points, on_edges.reshape(-1, 3), inner.reshape(-1, 3)]), finer


def roughened(points, faces, share):
    """Vertices moved at random by up to `share` of the mean edge."""
    edge = np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1).mean()
    return points + np.random.default_rng(1).uniform(-share * edge, share * edge, points.shape)


def soup(count):
    """Separate small triangles anywhere in a cube."""
    random = np.random.default_rng(2)
    corner = random.uniform(-1, 1, (count, 1, 3)) + random.uniform(-0.01, 0.01, (count, 3, 3))
    return corner.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def write_ply(path, points, faces):
    face = np.empty(len(faces), [("n", "u1"), ("v", "<u4", 3)])
    face["n"], face["v"] = 3, faces
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                   b"property float z\nelement face %d\nproperty list uchar uint vertex_indices\nend_header\n"
                   % (len(points), len(faces)))
        file.write(points.astype("<f4").tobytes())
        file.write(face.tobytes())


class Runs:
    def __init__(self, prt, folder):
        self.prt, self.folder, self.failures = prt, folder, []
        print(f"{'mesh':<8}{'domain':<8}{'sampling':<14}{'triangles':>10}{'points':>9}{'Mrays':>7}{'Mrays/s':>9}"
              f"{'bake s':>8}{'other s':>8}{'GB':>6}{'mean AO':>9}{'error':>8}")

    def check(self, condition, text):
        if not condition:
            self.failures.append(text)
            print("    FAILED: " + text)

    def bake(self, mesh, rays, *options):
        bundle, report = self.folder / "out.prt", self.folder / "report.json"
        words = ["precompute", mesh, "-o", bundle, "--order", 4, *options, *rays, "--quiet", "--json", report]
        run = subprocess.run([self.prt, *map(str, words)], capture_output=True, text=True)
        name = f"{mesh.stem} {' '.join(map(str, [*options, *rays]))}"
        self.check(run.returncode == 0, f"{name}: exit {run.returncode}: {run.stderr.strip()[-300:]}")
        if run.returncode:
            return
        r = json.loads(report.read_text())
        print(f"{mesh.stem:<8}{r['domain']:<8}{' '.join(map(str, rays)):<14}{r['triangles']:>10}{r['points']:>9}"
              f"{r['rays'] / 1e6:>7.0f}{r['rays_per_s'] / 1e6:>9.1f}{r['trace_seconds']:>8.1f}"
              f"{r['seconds'] - r['trace_seconds']:>8.1f}{r['peak_rss_bytes'] / 1e9:>6.2f}{r['mean_ao']:>9.4f}"
              f"{r['sampling_error']:>8.4f}", flush=True)
        self.check(r["peak_rss_bytes"] < MOST_MEMORY, f"{name}: {r['peak_rss_bytes'] / 1e9:.2f} GB")
        self.check(0 < r["mean_ao"] <= 1, f"{name}: mean AO {r['mean_ao']}")
        self.check(sum(r["validity"].values()) - r["validity"]["empty"] >= r["points"], f"{name}: points are lost")
        return r

    def refuse(self, mesh, *options):
        """More charts than the atlas holds is the user's to change: exit 3, and how."""
        run = subprocess.run([self.prt, "precompute", str(mesh), "-o", str(self.folder / "refused.prt"),
                              *map(str, options), "--quiet"], capture_output=True, text=True)
        self.check(run.returncode == 3 and "use --texels" in run.stderr and run.stderr.count("\n") == 1,
                   f"{mesh.stem} {options}: exit {run.returncode}: {run.stderr.strip()[-300:]}")

    def interrupt(self, mesh, rays):
        bundle = self.folder / "interrupted.prt"
        before = sorted(p.name for p in self.folder.iterdir())
        waits = []
        for seconds in INTERRUPT_SECONDS:
            run = subprocess.Popen([self.prt, "precompute", str(mesh), "-o", str(bundle), "--texels", "4096",
                                    *map(str, rays), "--quiet"], stderr=subprocess.PIPE, text=True)
            time.sleep(seconds)
            if run.poll() is not None:
                self.check(False, f"ended by itself before {seconds} s with {run.returncode}: {run.stderr.read()}")
                break
            run.send_signal(signal.SIGINT)
            start = time.monotonic()
            try:
                run.wait(LEAVES)
            except subprocess.TimeoutExpired:
                run.kill()
                run.wait()
            waits.append(f"{seconds} s: {time.monotonic() - start:.2f}")
            self.check(run.returncode == INTERRUPTED, f"interrupted after {seconds} s: exit {run.returncode}")
            left = sorted(p.name for p in self.folder.iterdir())
            self.check(left == before, f"interrupted after {seconds} s: left {set(left) - set(before)}")
        print(f"seconds from an interrupt to the end: {', '.join(waits)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--prt", required=True)
    parser.add_argument("--assets", default=str(ROOT / "assets"))
    arguments = parser.parse_args()
    bunny = pathlib.Path(arguments.assets) / "models/bunny.obj"
    if not bunny.exists():
        print(f"SKIPPED: no {bunny}; run tools/fetch-assets")
        return SKIP
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        smooth, rough, many = folder / "smooth.ply", folder / "rough.ply", folder / "soup.ply"
        points, faces = cut(*read_obj(bunny), CUTS)
        write_ply(smooth, points, faces)
        write_ply(rough, roughened(points, faces, 0.2), faces)
        write_ply(many, *soup(SOUP))
        del points, faces
        runs = Runs(arguments.prt, folder)
        uniform = ["--rays", 256]
        adaptive = ["--error", 0.01]
        texels = ["--texels", 512]
        a = runs.bake(smooth, uniform, *texels)
        runs.bake(smooth, adaptive, *texels)
        runs.bake(rough, uniform, *texels)
        b = runs.bake(smooth, ["--rays", 64], "--per-vertex")
        runs.bake(rough, adaptive, "--per-vertex")
        runs.bake(many, ["--rays", 16], "--per-vertex")
        runs.refuse(many, "--texels", 64)
        if a and b:
            runs.check(abs(a["mean_ao"] - b["mean_ao"]) < 0.02, "texels and vertices differ in mean AO")
        runs.interrupt(smooth, ["--error", 0.001])
    print(f"{len(runs.failures)} bounds exceeded")
    return 1 if runs.failures else 0


if __name__ == "__main__":
    sys.exit(main())

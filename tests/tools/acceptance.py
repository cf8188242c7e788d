#!/usr/bin/python3
"""Whole scenes against ray-traced truth: the house (per texel), a scanned room (per vertex) and a closed scanned mesh
(per texel), order 6, under 18 HDR environments. Prints a table; exit 1 where a bound is exceeded, 77 without assets."""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIP = 77
FLOOR_MARGIN = 0.02       # unc may exceed the truncation floor by this
PCA_MEAN_MARGIN = 0.02    # the mean of pca16 may exceed that of unc by this
PCA_MARGIN = 0.04         # and in one environment by this
# Mean of unc by plain projection (--projection plain --rays 1024): pca16 stays within 10 % of it.
PLAIN_UNC = {"house": 0.0816, "room": 0.1352, "bunny": 0.0409}
HOUSE_LIMIT = 0.08        # of unc on the house under these
HOUSE_ENVIRONMENTS = ("city", "venice", "forest")
FULL_PCA = 1e-3           # all components against unc


class Prt:
    def __init__(self, binary, folder):
        self.binary, self.folder = binary, folder

    def __call__(self, *words):
        report = self.folder / "report.json"
        subprocess.run([self.binary, *map(str, words), "--quiet", "--json", str(report)], check=True,
                       stdout=subprocess.DEVNULL)
        return json.loads(report.read_text())


def error(row, technique):
    return next(r["relative_rmse"] for r in row["rows"] if r["technique"] == technique)


def compare(prt, bundle, environments, camera, size="320x200"):
    words = [w for e in environments for w in ("--env", e)]
    return prt("relight", bundle, *words, "--each", "--compare-reference", "--reference-rays", 2048, "--size", size,
               *camera)["environments"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--prt", required=True)
    parser.add_argument("--assets", default=str(ROOT / "assets"))
    arguments = parser.parse_args()
    assets = pathlib.Path(arguments.assets)
    environments = sorted((assets / "hdri").glob("*.exr"))
    normal_map = assets / "normals/0005.webp"
    scenes = {
        "house": (ROOT / "meshes/house/house.obj", ["--texels", 1024],
                  ["--eye=-7.5,3.4,13.5", "--target=0.2,2.3,0.5", "--fov", 38]),
        "room": (assets / "rooms/music.ply", ["--per-vertex", "--normal-map", normal_map, "--uv-scale", 0.5],
                 ["--eye=0,8.5,5", "--target=0,0.3,0.4", "--fov", 45]),
        "bunny": (assets / "models/bunny.obj", ["--texels", 512, "--normal-map", normal_map, "--uv-scale", 0.4],
                  ["--azimuth", 20, "--elevation", 15, "--distance", 0.8]),
    }
    missing = [str(mesh) for mesh, _, _ in scenes.values() if not mesh.exists()]
    if len(environments) != 18 or missing:
        print(f"SKIPPED: {len(environments)} of 18 environments, missing meshes: {missing}; run tools/fetch-assets")
        return SKIP

    failures = []

    def check(condition, text):
        if not condition:
            failures.append(text)
            print("    FAILED: " + text)

    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        prt = Prt(arguments.prt, folder)
        print(f"{'scene':<8}{'environment':<14}{'floor':>8}{'unc':>8}{'pca16':>8}")
        for name, (mesh, options, camera) in scenes.items():
            bundle = folder / f"{name}.prt"
            means = {}
            for order in (3, 4, 6):
                prt("precompute", mesh, "-o", bundle, "--order", order, *options)
                if order == 6:
                    prt("compress", bundle, "--components", 16)
                rows = compare(prt, bundle, environments, camera)
                means[order] = sum(error(r, "unc") for r in rows) / len(rows)
            for row in rows:
                sun = "*" if row["has_sun"] else ""
                unc, pca, floor = error(row, "unc"), error(row, "pca"), row["floor_rmse"]
                print(f"{name:<8}{row['environment'] + sun:<14}{floor:>8.4f}{unc:>8.4f}{pca:>8.4f}", flush=True)
                check(unc <= floor + FLOOR_MARGIN, f"{name} {row['environment']}: unc {unc:.4f}, floor {floor:.4f}")
                check(pca <= unc + PCA_MARGIN, f"{name} {row['environment']}: pca16 {pca:.4f}, unc {unc:.4f}")
                if name == "house" and row["environment"] in HOUSE_ENVIRONMENTS:
                    check(unc <= HOUSE_LIMIT, f"house {row['environment']}: unc {unc:.4f} above {HOUSE_LIMIT}")
            mean_pca = sum(error(r, "pca") for r in rows) / len(rows)
            check(mean_pca <= means[6] + PCA_MEAN_MARGIN, f"{name}: mean of pca16 {mean_pca:.4f}, unc {means[6]:.4f}")
            check(mean_pca <= 1.1 * PLAIN_UNC[name],
                  f"{name}: mean of pca16 {mean_pca:.4f}, unc by plain projection {PLAIN_UNC[name]}")
            print(f"{name}: mean error of pca16 {mean_pca:.4f}")
            print(f"{name}: mean error at order 3, 4, 6: {means[3]:.4f} {means[4]:.4f} {means[6]:.4f}")
            check(means[3] > means[4] > means[6], f"{name}: errors do not fall with the order")
            prt("compress", bundle, "--components", 36)
            full = compare(prt, bundle, environments[:2], camera, "160x100")
            for row in full:
                gap = abs(error(row, "unc") - error(row, "pca"))
                check(gap <= FULL_PCA, f"{name} {row['environment']}: 36 components differ from unc by {gap:.5f}")
    print("* has a sun: over 20 % of its flux from under 0.5 % of the sphere")
    print(f"{len(failures)} bounds exceeded")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

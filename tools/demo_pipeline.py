#!/usr/bin/python3
"""The demo: bakes, compresses, tabulates and relights scenes with the prt command, compares with ray-traced truth,
prints a table and composes out/contact-sheet.png. Normally started by tools/demo, which builds prt first."""
import argparse
import json
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import contact_sheet  # noqa: E402


class Demo:
    def __init__(self, arguments):
        self.prt = arguments.prt
        self.out = pathlib.Path(arguments.out)
        self.assets = pathlib.Path(arguments.assets)
        self.small = arguments.small
        self.out.mkdir(parents=True, exist_ok=True)

    def run(self, *words):
        """Runs prt with --json; returns what it reported."""
        report = self.out / "report.json"
        command = [self.prt, *map(str, words), "--json", str(report)]
        print("   prt " + " ".join(map(str, words)), flush=True)
        finished = subprocess.run(command, stdout=subprocess.DEVNULL)
        if finished.returncode != 0:
            sys.exit(f"demo: prt {words[0]} failed with exit code {finished.returncode}")
        result = json.loads(report.read_text())
        report.unlink()
        return result

    def scenes(self):
        """(name, mesh, options of precompute, camera options of relight)"""
        texels, rays = (128, 256) if self.small else (512, 1024)
        yield ("house", ROOT / "meshes/house/house.obj", ["--texels", 2 * texels, "--order", 6, "--rays", rays],
               HOUSE_CAMERA)
        room = self.assets / "rooms/music.ply"
        normals = self.assets / "normals/0005.webp"
        if room.exists() and normals.exists():
            yield ("room", room, ["--per-vertex", "--order", 6, "--rays", rays, "--normal-map", normals,
                                  "--uv-scale", 0.5], ROOM_CAMERA)
        else:
            yield ("cornell", ROOT / "meshes/cornell/cornell.obj", ["--texels", texels // 2, "--order", 6, "--rays", rays],
                   CORNELL_CAMERA)
        bunny = self.assets / "models/bunny.obj"
        if bunny.exists() and normals.exists():
            yield ("bunny", bunny, ["--texels", texels, "--order", 6, "--rays", rays, "--normal-map", normals,
                                    "--uv-scale", 0.4], BUNNY_CAMERA)
        else:
            yield ("sphere", ROOT / "meshes/shapes/sphere_on_plane.obj",
                   ["--per-vertex", "--order", 4, "--rays", rays], SPHERE_CAMERA)

    def environments(self):
        files = [self.assets / "hdri" / (name + ".exr") for name in ("city", "forest", "venice")]
        if all(f.exists() for f in files):
            return [str(f) for f in files]
        return ["sky:clear", "sky:overcast", "sky:sunset"]

    def run_scene(self, name, mesh, precompute, camera, environments):
        print(f"\n== {name}: {mesh.name}", flush=True)
        bundle = self.out / f"{name}.prt"
        size = "240x150" if self.small else "640x400"
        baked = self.run("precompute", mesh, "-o", bundle, *precompute)
        compressed = self.run("compress", bundle, "--components", 16)
        self.run("tabulate", bundle, *environments, "--kind", "triple-product", "--layout", "cube", "--size", 32)
        light = [word for e in environments for word in ("--env", e)]
        pictures = {kind: str(self.out / f"{name}-{{env}}-{kind}.png") for kind in ("pca", "reference", "difference")}
        lit = self.run("relight", bundle, *light, "--each", "--compare-reference", "--reference-rays", 2048,
                       "--technique", "pca", "--size", size, "--exposure", "auto", "-o", pictures["pca"],
                       "--reference-output", pictures["reference"], "--difference-output", pictures["difference"],
                       "--time-frames", 5, *camera)
        blend = self.out / f"{name}-blend-rotated.png"
        weights = [f"{e}:{w}" for e, w in zip(environments[:2], (0.6, 0.4))]
        self.run("relight", bundle, *[word for e in weights for word in ("--env", e)], "--rotate", 120, "--technique",
                 "pca", "--size", size, "--exposure", "auto", "-o", blend, *camera)
        if name == "house":
            self.strip(bundle, light, camera, lit)
        info = self.run("info", bundle)
        rows = [contact_sheet.Row(
            f"{name} under {row['environment']}",
            [(pictures[kind].replace("{env}", row["environment"]), label) for kind, label in (
                ("pca", f"pca16: error {errors(row, 'pca'):.3f}"), ("reference", "ray-traced truth"),
                ("difference", "4 x difference"))]) for row in lit["environments"]]
        summary = {
            "scene": name, "points": baked["points"], "kind": baked["domain"], "rays_per_s": baked["rays_per_s"],
            "bake_s": baked["seconds"], "bundle_mb": info["bytes"] / 1e6, "pca_error": compressed["irradiance_relative_rmse"],
            "frame_ms": lit["frame_ms"], "environments": lit["environments"],
        }
        return summary, rows, blend


    def strip(self, bundle, light, camera, lit):
        """house.jpg: three environments side by side, rendered at twice the size and averaged down."""
        pattern = str(self.out / "house-{env}-large.png")
        self.run("relight", bundle, *light, "--each", "--technique", "pca", "--size", "1280x800", "--exposure", "auto",
                 "-o", pattern, *camera)
        files = [pattern.replace("{env}", row["environment"]) for row in lit["environments"]]
        contact_sheet.strip(files, self.out / "house.jpg", 640)


def errors(row, technique):
    return next(r["relative_rmse"] for r in row["rows"] if r["technique"] == technique)


PLURAL = {"texel": "texels", "vertex": "vertices"}


def print_table(summaries):
    header = (f"{'scene':<9}{'points':>17}{'Mrays/s':>9}{'bake s':>8}{'bundle MB':>11}{'PCA error':>11}"
              f"{'environment':>13}{'unc':>8}{'pca16':>8}{'floor':>8}{'frame ms':>10}")
    print("\n" + header + "\n" + "-" * len(header))
    for s in summaries:
        for i, row in enumerate(s["environments"]):
            left = (f"{s['scene']:<9}{s['points']:>8} {PLURAL[s['kind']]:<8}{s['rays_per_s'] / 1e6:>9.1f}{s['bake_s']:>8.1f}"
                    f"{s['bundle_mb']:>11.1f}{s['pca_error']:>11.4f}" if i == 0 else " " * 65)
            right = f"{s['frame_ms']:>10.1f}" if i == 0 else ""
            sun = "*" if row["has_sun"] else ""
            print(f"{left}{row['environment'] + sun:>13}{errors(row, 'unc'):>8.4f}{errors(row, 'pca'):>8.4f}"
                  f"{row['floor_rmse']:>8.4f}{right}")
    print("\nPCA error: of 16 components against all coefficients, in the norm of irradiance.\n"
          "unc, pca16: relative RMSE of irradiance against ray-traced truth; floor: the least any bake of that order "
          "can reach.\n* has a sun: over 20 % of its flux comes from under 0.5 % of the sphere.")


def view(eye, target, fov):
    return [f"--eye={eye}", f"--target={target}", "--fov", fov]


HOUSE_CAMERA = view("-7.5,3.4,13.5", "0.2,2.3,0.5", 38)
ROOM_CAMERA = view("0,8.5,5", "0,0.3,0.4", 45)
CORNELL_CAMERA = view("0,2.74,10.6", "0,2.74,0", 39)
BUNNY_CAMERA = ["--azimuth", 20, "--elevation", 15, "--distance", 0.8]
SPHERE_CAMERA = view("3,2.5,4.5", "0,0.8,0", 40)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--prt", default="build/demo/tools/prt", help="the prt command (default: %(default)s)")
    parser.add_argument("--out", default="out", help="folder for results (default: %(default)s)")
    parser.add_argument("--assets", default="assets", help="folder of tools/fetch-assets (default: %(default)s)")
    parser.add_argument("--small", action="store_true", help="quarter resolution, for a quick check")
    demo = Demo(parser.parse_args())
    start = time.monotonic()
    environments = demo.environments()
    if environments[0].startswith("sky:"):
        print("demo: no assets found; using procedural skies and the meshes that ship with the project", flush=True)
    summaries, rows, blends = [], [], []
    for name, mesh, precompute, camera in demo.scenes():
        summary, scene_rows, blend = demo.run_scene(name, mesh, precompute, camera, environments)
        summaries.append(summary)
        rows += scene_rows
        blends.append((str(blend), f"{name}, light turned by 120 degrees"))
    rows.append(contact_sheet.Row("blended and rotated", blends))
    sheet = demo.out / "contact-sheet.png"
    contact_sheet.compose(rows, sheet)
    (demo.out / "summary.json").write_text(json.dumps(summaries, indent=2) + "\n")
    print_table(summaries)
    print(f"\n{time.monotonic() - start:.0f} s for all scenes\nlook at: {sheet}\n   also: {demo.out}/*.png, {demo.out}/house.jpg, "
          f"{demo.out}/summary.json, prt info {demo.out}/house.prt")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Writes every mesh and texture that ships with the project: meshes/generate.py [--out DIR]. Needs numpy only."""
import argparse
import os

from generate import house, simple, textures

HERE = os.path.dirname(os.path.abspath(__file__))


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", newline="\n") as f:
        f.write(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", default=HERE, help="directory to write to (default: the one of this script)")
    out = parser.parse_args().out
    write(os.path.join(out, "house", "house.obj"), house.make().obj("A cottage, by meshes/generate.py (MIT). Metres, +Y up.",
                                                                    "house.mtl"))
    write(os.path.join(out, "house", "house.mtl"), house.mtl())
    textures.write(os.path.join(out, "house"))
    for name, text in simple.files():
        write(os.path.join(out, name), text)


if __name__ == "__main__":
    main()

"""Seamlessly tiling albedo and tangent-space normal maps, both from one procedural height field per material.

Row 0 of an image is its top, v = 1. Normals follow glTF and OpenGL: red = +u, green = +v, blue = out.
"""
import os

import numpy as np

from . import png

# metres that one repetition of the image covers
TILE = {"brick": 1.0, "roof": 1.2, "plank": 1.0, "plaster": 2.0, "cobble": 1.5, "grass": 2.0}


def grid(n):
    """Texel centres as u, v in 0…1, v upward."""
    c = (np.arange(n) + 0.5) / n
    return np.meshgrid(c, c[::-1])


def noise(n, seed, low, high, falloff=1.0, stretch=(1.0, 1.0)):
    """Periodic noise of mean 0 and deviation 1 with frequencies low…high (cycles per tile); stretch lengthens u, v."""
    rng = np.random.RandomState(seed)
    f = np.fft.fftfreq(n) * n
    fu, fv = np.meshgrid(f * stretch[0], f * stretch[1])
    r = np.hypot(fu, fv)
    amplitude = np.where((r >= low) & (r <= high), np.maximum(r, 1e-9) ** -falloff, 0.0)
    x = np.fft.ifft2(np.fft.fft2(rng.standard_normal((n, n))) * amplitude).real
    return (x - x.mean()) / x.std()


def smoothstep(a, b, x):
    t = np.clip((x - a) / (b - a), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def per_cell(index, seed, spread=1.0):
    """One normal random number per integer index."""
    values = np.random.RandomState(seed).standard_normal(4096)
    return np.clip(values[index.astype(int) % 4096], -2.0, 2.0) * spread


def mix(a, b, t):
    return a + (b - a) * t[..., None]


def rgb(*c):
    return np.array(c, float)


def brick(n):
    """4 × 12 bricks in running bond. Height in metres."""
    u, v = grid(n)
    u = u + 0.0016 * noise(n, 11, 3, 20)
    v = v + 0.0013 * noise(n, 12, 3, 20)
    row = np.floor(v * 12)
    x = u * 4 + 0.5 * (row % 2)
    col = np.floor(x)
    cell = (row % 12) * 4 + col % 4
    fx, fy = x - col, v * 12 - row
    # distance in metres to the brick's rim; joints are 10 mm wide
    dx, dy = np.minimum(fx, 1 - fx) * 0.25 - 0.005, np.minimum(fy, 1 - fy) / 12 - 0.005
    inner = 0.008
    d = inner - np.hypot(np.maximum(inner - dx, 0), np.maximum(inner - dy, 0))
    body = smoothstep(-0.004, 0.010, d)
    grain, pits = noise(n, 13, 6, 60, 0.8), smoothstep(1.3, 2.2, noise(n, 14, 16, 60, 0.4))
    tilt = per_cell(cell, 15, 0.0009) * (fx - 0.5) * 2 + per_cell(cell, 16, 0.0006) * (fy - 0.5) * 2
    height = body * (0.0055 + per_cell(cell, 17, 0.0006) + tilt + 0.00025 * grain - 0.0012 * pits)
    height += (1 - body) * 0.0004 * noise(n, 18, 10, 60, 0.5)
    colour = rgb(0.44, 0.235, 0.165) * (1 + 0.16 * per_cell(cell, 19))[..., None]
    colour = mix(colour, rgb(0.50, 0.35, 0.24), np.clip(0.35 * per_cell(cell, 20), 0, 0.7))
    colour = mix(colour, rgb(0.20, 0.13, 0.11), np.clip(per_cell(cell, 21) - 1.1, 0, 0.6))
    colour *= (1 + 0.06 * grain - 0.25 * pits)[..., None]
    mortar = rgb(0.52, 0.48, 0.42) * (1 + 0.05 * noise(n, 22, 8, 50, 0.5))[..., None]
    return height, mix(mortar, colour, smoothstep(-0.003, 0.003, d))


def roof(n):
    """Slates with rounded lower edges, 6 across and 6 courses up the slope, each over the one below."""
    u, v = grid(n)
    u = u + 0.0012 * noise(n, 31, 2, 12)
    height, colour, top = np.full((n, n), -1.0), np.zeros((n, n, 3)), np.zeros((n, n))
    grain = noise(n, 32, 4, 70, 0.9, (1.0, 0.45))
    for k in range(-2, 7):  # courses from below: a later one lies under an earlier one, so draw downward
        x = u * 6 + 0.5 * (k % 2)
        col = np.floor(x)
        cell = (k % 6) * 6 + col % 6
        fx = x - col - 0.5
        lower = (k + 0.10 * (1 - np.sqrt(1 - np.minimum(np.abs(fx) * 1.9, 1.0) ** 2)) * 2.4
                 + per_cell(cell, 33, 0.02))
        along = v * 6 - lower  # courses above the tile's lower edge
        side = smoothstep(0.0, 0.022, 0.5 - np.abs(fx) - 0.006)
        rim = smoothstep(0.0, 0.045, along)
        h = 0.012 - 0.0055 * along + per_cell(cell, 34, 0.0006) + per_cell(cell, 35, 0.0012) * fx
        h = h - 0.0045 * (1 - rim) - 0.004 * (1 - side) + 0.00028 * grain
        shade = rgb(0.200, 0.214, 0.234) * (1 + 0.14 * per_cell(cell, 36))[..., None]
        shade = mix(shade, rgb(0.25, 0.205, 0.165), np.clip(0.4 * per_cell(cell, 37), 0, 0.6))
        shade = shade * (1 + 0.07 * grain)[..., None]
        shade = mix(shade * 0.55, shade, side * rim)
        on = (along >= 0) & (along < 2.2) & (h > height)
        height, colour, top = np.where(on, h, height), np.where(on[..., None], shade, colour), np.where(on, k, top)
    moss = smoothstep(0.7, 1.9, noise(n, 38, 2, 24, 0.9))
    return height, mix(colour, rgb(0.20, 0.22, 0.12), 0.45 * moss)


def plank(n):
    """8 boards along u, each with one butt joint."""
    u, v = grid(n)
    row = np.floor(v * 8)
    fy = v * 8 - row
    start = (row * 0.375 + 0.08) % 1.0
    along = (u - start) % 1.0
    dy, dx = np.minimum(fy, 1 - fy) / 8 - 0.003, np.minimum(along, 1 - along) - 0.0025
    body = smoothstep(-0.003, 0.0065, np.minimum(dy, dx))
    warp = noise(n, 41, 1, 12, 1.2, (2.5, 1.0)) * 0.02
    grain = noise(n, 42, 6, 110, 0.6, (14.0, 1.0))
    rings = np.sin(2 * np.pi * (fy * 2.5 + 12 * warp + per_cell(row, 43)))
    streak = smoothstep(0.2, 2.0, grain + 0.6 * rings)
    cup = (fy - 0.5) ** 2 * 0.003
    height = body * (0.0045 + per_cell(row, 44, 0.0005) + per_cell(row, 45, 0.0007) * (fy - 0.5) - cup)
    height += body * (0.00020 * grain - 0.0005 * streak)
    tone = per_cell(row, 46)
    colour = rgb(0.40, 0.265, 0.155) * (1 + 0.13 * tone + 0.05 * grain)[..., None]
    colour = mix(colour, rgb(0.20, 0.12, 0.065), 0.85 * streak)
    colour = mix(colour, rgb(0.36, 0.31, 0.26), np.clip(0.22 * per_cell(row, 47), 0, 0.4))
    return height, mix(rgb(0.07, 0.05, 0.035) * np.ones((n, n, 1)), colour, smoothstep(-0.003, 0.002, np.minimum(dy, dx)))


def plaster(n):
    """Trowelled lime plaster."""
    broad, mid, fine = noise(n, 51, 2, 9, 1.0), noise(n, 52, 6, 30, 1.1, (1.0, 1.6)), noise(n, 53, 20, 60, 0.8)
    pits = smoothstep(1.9, 2.6, noise(n, 54, 12, 50, 0.4))
    height = 0.004 * broad + 0.0035 * np.abs(mid) + 0.0007 * fine - 0.004 * pits
    colour = rgb(0.63, 0.575, 0.475) * (1 + 0.035 * broad + 0.025 * mid + 0.02 * fine - 0.12 * pits)[..., None]
    return height, colour


def cobble(n):
    """Rounded setts on a jittered 8 × 8 grid."""
    u, v = grid(n)
    u = (u + 0.004 * noise(n, 61, 3, 20)) % 1.0
    v = (v + 0.004 * noise(n, 62, 3, 20)) % 1.0
    cells, rng = 8, np.random.RandomState(63)
    jitter = rng.uniform(-0.27, 0.27, (cells, cells, 2))
    first, second, index = np.full((n, n), 9.0), np.full((n, n), 9.0), np.zeros((n, n))
    for j in range(cells):
        for i in range(cells):
            du = np.abs(u * cells - (i + 0.5 + 0.5 * (j % 2) + jitter[j, i, 0])) % cells
            dv = np.abs(v * cells - (j + 0.5 + jitter[j, i, 1])) % cells
            d = np.hypot(np.minimum(du, cells - du), np.minimum(dv, cells - dv))
            index = np.where(d < first, j * cells + i, index)
            second = np.minimum(second, np.maximum(first, d))
            first = np.minimum(first, d)
    gap = second - first
    body = smoothstep(0.05, 0.42, gap)
    rough = noise(n, 64, 8, 70, 0.9)
    dome = np.sqrt(np.clip(1 - first ** 2 * 1.2, 0, 1))
    height = body * (0.016 + 0.018 * dome + per_cell(index, 65, 0.002) + 0.0010 * rough)
    height += (1 - body) * 0.0015 * noise(n, 66, 20, 80, 0.4)
    stone = rgb(0.36, 0.34, 0.315) * (1 + 0.20 * per_cell(index, 67))[..., None]
    stone = mix(stone, rgb(0.40, 0.32, 0.25), np.clip(0.4 * per_cell(index, 68), 0, 0.7))
    stone = stone * (1 + 0.09 * rough)[..., None]
    soil = rgb(0.15, 0.13, 0.095) * (1 + 0.2 * noise(n, 69, 20, 80, 0.4))[..., None]
    return height, mix(soil, stone, smoothstep(0.05, 0.20, gap))


def grass(n):
    """Mown lawn: clumps and short blades."""
    clump, mid = noise(n, 71, 3, 12, 0.5), noise(n, 72, 8, 34, 0.8)
    blade = noise(n, 73, 18, 100, 0.35, (1.6, 0.8)) + noise(n, 74, 18, 100, 0.35, (0.8, 1.6))
    height = 0.006 * clump + 0.006 * mid + 0.0035 * blade
    colour = rgb(0.155, 0.215, 0.066) * (1 + 0.07 * clump + 0.10 * mid + 0.14 * blade)[..., None]
    return height, mix(colour, rgb(0.26, 0.25, 0.10), 0.5 * smoothstep(0.6, 2.4, mid + 0.5 * clump))


# name: (height field, texels of the albedo, of the normal map, slope scale): the scale sets rims to 15–30 degrees
MAPS = {
    "brick": (brick, 256, 256, 0.85), "roof": (roof, 256, 256, 1.0), "plank": (plank, 256, 256, 0.95),
    "plaster": (plaster, 256, 256, 0.65), "cobble": (cobble, 256, 256, 0.50), "grass": (grass, 128, 128, 1.1),
}


def normals(height, tile, scale):
    """Central differences of a periodic height field -> unit normals [n, n, 3]."""
    step = 2.0 * tile / height.shape[0]
    dhdu = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / step * scale
    dhdv = (np.roll(height, 1, 0) - np.roll(height, -1, 0)) / step * scale  # row 0 is the top
    # soften slopes above 45 degrees
    steep = np.hypot(dhdu, dhdv)
    soft = np.where(steep > 1e-9, np.tanh(steep) / np.maximum(steep, 1e-9), 1.0)
    n = np.stack([-dhdu * soft, -dhdv * soft, np.ones_like(dhdu)], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def srgb(linear):
    x = np.clip(linear, 0.0, 0.79)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def quantise(x, levels):
    """0…1 -> uint8 with the given number of levels, which a PNG stores in fewer bits."""
    return np.round(np.round(x * (levels - 1)) * (255.0 / (levels - 1))).astype(np.uint8)


def encode_normal(n):
    """Quantises x and y to steps of 2 around 128, which a PNG stores in fewer bits."""
    xy = 128 + 2 * np.round(n[..., :2] * 127.5 / 2)
    z = np.round(127.5 + 127.5 * n[..., 2:])
    return np.clip(np.concatenate([xy, z], -1), 0, 255).astype(np.uint8)


def make(name):
    field, albedo_size, normal_size, scale = MAPS[name]
    height, albedo = field(albedo_size)
    step = albedo_size // normal_size
    height = height.reshape(normal_size, step, normal_size, step).mean((1, 3))
    return quantise(srgb(albedo), 86), encode_normal(normals(height, TILE[name], scale))


def write(directory):
    for name in MAPS:
        albedo, normal = make(name)
        for suffix, pixels in (("albedo", albedo), ("normal", normal)):
            with open(os.path.join(directory, "%s_%s.png" % (name, suffix)), "wb") as f:
                f.write(png.encode(pixels))

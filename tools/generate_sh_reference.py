#!/usr/bin/env python3
"""Writes tests/math/sh_reference.h: values that pin down the project's conventions.

usage: generate_sh_reference.py [OUTPUT]        ('-', the default, is standard output)

Nothing here shares a formula with the library: spherical harmonics are polynomials in x, y, z with rational
coefficients, from Rodrigues' formula; integrals are sums of moments of the sphere and the hemisphere, rational up to
pi; square roots are taken last, with 50 digits.
"""
import sys
from decimal import Decimal, getcontext
from fractions import Fraction
from math import factorial

getcontext().prec = 50
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


def decimal(value):
    return Decimal(value.numerator) / Decimal(value.denominator) if isinstance(value, Fraction) else Decimal(value)


def root(value):
    return decimal(value).sqrt()


# Polynomials are dictionaries {(a, b, c): coefficient of x^a y^b z^c}; coefficients rational or Decimal.

def add(p, q, scale=1):
    result = dict(p)
    for key, value in q.items():
        result[key] = result.get(key, 0) + scale * value
    return {key: value for key, value in result.items() if value != 0}


def multiply(p, q):
    result = {}
    for (a, b, c), u in p.items():
        for (d, e, f), v in q.items():
            key = (a + d, b + e, c + f)
            result[key] = result.get(key, 0) + u * v
    return result


def power(p, exponent):
    result = {(0, 0, 0): 1}
    for _ in range(exponent):
        result = multiply(result, p)
    return result


def substitute(p, images):
    """p with x, y, z replaced by three polynomials."""
    result = {}
    for key, value in p.items():
        term = {(0, 0, 0): value}
        for image, exponent in zip(images, key):
            term = multiply(term, power(image, exponent))
        result = add(result, term)
    return result


def evaluate(p, point):
    return sum(value * point[0] ** a * point[1] ** b * point[2] ** c for (a, b, c), value in p.items())


def double_factorial(n):
    return 1 if n < 2 else n * double_factorial(n - 2)


def sphere_moment(a, b, c):
    """Integral of x^a y^b z^c over the sphere, over pi."""
    if a % 2 or b % 2 or c % 2:
        return Fraction(0)
    odd = double_factorial(a - 1) * double_factorial(b - 1) * double_factorial(c - 1)
    return Fraction(4 * odd, double_factorial(a + b + c + 1))


def hemisphere_moment(a, b, c):
    """The same over z >= 0."""
    if a % 2 or b % 2:
        return Fraction(0)
    azimuth = Fraction(2 * double_factorial(a - 1) * double_factorial(b - 1), double_factorial(a + b))
    k = (a + b) // 2
    height = Fraction(factorial(k), 2)
    for j in range(k + 1):
        height /= Fraction(c + 1, 2) + j
    return azimuth * height


def integral(p, moment):
    """Over pi."""
    total = Fraction(0) if all(isinstance(v, (int, Fraction)) for v in p.values()) else Decimal(0)
    for key, value in p.items():
        m = moment(*key)
        total += value * (m if isinstance(total, Fraction) else decimal(m))
    return total


def legendre_derivative(l, m):
    """Coefficients of z^0, z^1, ... in the m-th derivative of P_l, by Rodrigues' formula."""
    p = [Fraction(0)] * (l + 1)
    for k in range(l // 2 + 1):
        p[l - 2 * k] = Fraction((-1) ** k * factorial(2 * l - 2 * k),
                                2 ** l * factorial(k) * factorial(l - k) * factorial(l - 2 * k))
    for _ in range(m):
        p = [exponent * c for exponent, c in enumerate(p)][1:]
    return p


def azimuth_polynomial(m):
    """Re (x + iy)^m for m >= 0, Im (x + iy)^|m| for m < 0."""
    n = abs(m)
    result = {}
    for k in range(n + 1):  # i^k y^k x^(n - k)
        if k % 2 == (1 if m < 0 else 0):
            binomial = factorial(n) // (factorial(k) * factorial(n - k))
            result[(n - k, k, 0)] = Fraction(binomial * (-1) ** (k // 2))
    return result


def harmonic(l, m):
    """Polynomial Q and sign and square S of the norm times pi: Y_lm = sign sqrt(S / pi) Q."""
    n = abs(m)
    height = {(0, 0, k): c for k, c in enumerate(legendre_derivative(l, n)) if c}
    square = Fraction((2 * l + 1) * factorial(l - n) * (2 if m else 1), 4 * factorial(l + n))
    return multiply(height, azimuth_polynomial(m)), (-1) ** n, square


def harmonics(order):
    return [harmonic(l, m) for l in range(order) for m in range(-l, l + 1)]


def expansion(coefficients):
    """Polynomial with Decimal coefficients of sum_i c_i Y_i, times sqrt(pi)."""
    total = {}
    for c, (q, sign, square) in zip(coefficients, HARMONICS):
        scale = decimal(c) * sign * root(square)
        total = add(total, {key: decimal(v) for key, v in q.items()}, scale)
    return total


def project(polynomial_times_root_pi, order):
    """c_i = integral of p Y_i, where the argument is p sqrt(pi): the two square roots of pi cancel its pi."""
    result = []
    for q, sign, square in harmonics(order):
        product = multiply(polynomial_times_root_pi, {key: decimal(v) for key, v in q.items()})
        result.append(sign * root(square) * integral(product, sphere_moment))
    return result


def h_basis():
    """(polynomial, S) with H = sqrt(S / pi) polynomial [HabelWimmer2010, Eqs. 8-13], Eq. 10 corrected."""
    one, x, y, z = {(0, 0, 0): Fraction(1)}, {(1, 0, 0): Fraction(1)}, {(0, 1, 0): Fraction(1)}, {(0, 0, 1): Fraction(1)}
    negative = lambda p: {key: -v for key, v in p.items()}
    return [(one, Fraction(1, 2)), (negative(y), Fraction(3, 2)), (add(add(z, z), one, -1), Fraction(3, 2)),
            (negative(x), Fraction(3, 2)), (multiply(x, y), Fraction(15, 2)),
            (add(multiply(x, x), multiply(y, y), -1), Fraction(15, 8))]


def matrix_t(order):
    rows = []
    for p, s in h_basis():
        rows.append([sign * root(s * square) * decimal(integral(multiply(p, q), hemisphere_moment))
                     for q, sign, square in harmonics(order)])
    return rows


def roots_of_quadratic_moments(count):
    """Integrals of t^k sqrt(1 + t^2) over 0..1."""
    two = Decimal(2).sqrt()
    moments = [(two + (1 + two).ln()) / 2, (2 * two - 1) / 3]
    for k in range(2, count):
        moments.append((2 * two - (k - 1) * moments[k - 2]) / (k + 2))
    return moments


def matrix_c(hsh_order, sh_order):
    """Integrals of H_lm Y_l'm' over the hemisphere [Gautron2004, Eq. 18]: H_lm = sqrt(2) K P_l^m(2z - 1) ..."""
    moments = roots_of_quadratic_moments(4 * (hsh_order + sh_order))
    functions = [(l, m) for l in range(hsh_order) for m in range(-l, l + 1)]
    others = [(l, m) for l in range(sh_order) for m in range(-l, l + 1)]
    z, rising = {(0, 0, 1): Fraction(1)}, {(0, 0, 0): Fraction(-1), (0, 0, 1): Fraction(2)}
    rows = []
    for l, m in functions:
        n = abs(m)
        row = []
        for k, m2 in others:
            if m2 != m:
                row.append(Decimal(0))
                continue
            # 2^n z^(n/2) (1 - z)^n (1 + z)^(n/2) P_l^(n)(2z - 1) P_k^(n)(z); for odd n the odd root is kept apart
            p = {(0, 0, 0): Fraction(2 ** n)}
            for c, image in ((n, {(0, 0, 0): Fraction(1), (0, 0, 1): Fraction(-1)}), (n // 2, z),
                             (n // 2, {(0, 0, 0): Fraction(1), (0, 0, 1): Fraction(1)})):
                p = multiply(p, power(image, c))
            for source, image in ((legendre_derivative(l, n), rising), (legendre_derivative(k, n), z)):
                shifted = {}
                for exponent, c in enumerate(source):
                    shifted = add(shifted, power(image, exponent), c)
                p = multiply(p, shifted)
            if n % 2 == 0:
                value = decimal(sum(v / (c + 1) for (_, _, c), v in p.items()))
            else:  # z = t^2: sqrt(z (1 + z)) dz = 2 t^2 sqrt(1 + t^2) dt
                value = sum(2 * decimal(v) * moments[2 * c + 2] for (_, _, c), v in p.items())
            norm = Fraction((2 * l + 1) * factorial(l - n), 2 * factorial(l + n))
            norm *= Fraction((2 * k + 1) * factorial(k - n), 4 * factorial(k + n))
            # azimuth: 2 pi for m = 0, and pi times the two square roots of 2 otherwise; over the pi of the norms
            row.append(value * root(norm) * 2)
        rows.append(row)
    return rows


def clamped_cosine(l):
    """A_l over pi [RamamoorthiHanrahan2001, Eq. 19]."""
    if l == 1:
        return Fraction(2, 3)
    if l % 2:
        return Fraction(0)
    half = l // 2
    return Fraction(2 * (-1) ** (half + 1) * factorial(l), (l + 2) * (l - 1) * 2 ** l * factorial(half) ** 2)


DIRECTIONS = [(0, 0, 1, 1), (0, 0, -1, 1), (1, 0, 0, 1), (0, 1, 0, 1), (-1, 0, 0, 1), (0, -1, 0, 1), (2, 3, 6, 7),
              (-1, 4, 8, 9), (-6, -2, -9, 11), (3, -4, -12, 13)]
QUATERNION = (1, 2, -3, 4)  # w, x, y, z
SH_ORDER, EXPANSION_ORDER, T_ORDER, C_ORDER = 10, 6, 5, 4
COUNT = EXPANSION_ORDER ** 2
F = [Fraction((7 * i) % 11 - 5, 8) for i in range(COUNT)]
G = [Fraction((5 * i) % 13 - 6, 8) for i in range(COUNT)]
HARMONICS = harmonics(SH_ORDER)


def rotation_matrix(quaternion):
    w, x, y, z = quaternion
    n = w * w + x * x + y * y + z * z
    rows = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
    return [[Fraction(v, n) for v in row] for row in rows]


def rotated(coefficients, rotation):
    """(Rf)(w) = f(R^T w)."""
    axes = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    images = [{axis: decimal(rotation[row][i]) for row, axis in enumerate(axes)} for i in range(3)]
    return project(substitute(expansion(coefficients), images), EXPANSION_ORDER)


def product(f, g):
    p = multiply(expansion(f), expansion(g))
    return [c / PI.sqrt() for c in project(p, EXPANSION_ORDER)]


def number(value):
    return repr(float(value) + 0.0)  # no -0.0


def array(name, comment, values, shape=""):
    lines = [f"/// {comment}", f"inline constexpr double {name}{shape or f'[{len(values)}]'} = {{"]
    line = "   "
    for value in values:
        text = f" {number(value)},"
        if len(line) + len(text) > 110:
            lines.append(line)
            line = "   "
        line += text
    return "\n".join(lines + [line, "};\n"])


HEAD = """// Written by tools/generate_sh_reference.py; do not edit.
//
// Values to test one's own code against. Conventions: real spherical harmonics, orthonormal over the sphere, with the
// Condon-Shortley phase, polar axis +Z: Y_1,-1 = -sqrt(3/4pi) y, Y_1,0 = sqrt(3/4pi) z, Y_1,1 = -sqrt(3/4pi) x; index
// l(l + 1) + m. A rotation R turns f into f(R^T w). Derived in exact arithmetic, rounded to double once.
#pragma once

// clang-format off
namespace prt::test {
"""


def main():
    if len(sys.argv) > 2 or (len(sys.argv) == 2 and sys.argv[1] in ("-h", "--help")):
        print(__doc__.strip())
        return 0 if len(sys.argv) == 2 else 2
    rotation = rotation_matrix(QUATERNION)
    directions = [Fraction(d[i], d[3]) for d in DIRECTIONS for i in range(3)]
    values = []
    for x, y, z, length in DIRECTIONS:
        point = (Fraction(x, length), Fraction(y, length), Fraction(z, length))
        values += [sign * root(square) / PI.sqrt() * decimal(evaluate(q, point)) for q, sign, square in HARMONICS]
    t, c = matrix_t(T_ORDER), matrix_c(C_ORDER, C_ORDER)
    parts = [
        HEAD,
        f"inline constexpr int kReferenceDirections = {len(DIRECTIONS)}, kReferenceShOrder = {SH_ORDER};",
        f"inline constexpr int kReferenceExpansionOrder = {EXPANSION_ORDER}, kReferenceTOrder = {T_ORDER};",
        f"inline constexpr int kReferenceCOrder = {C_ORDER};\n",
        array("kReferenceDirection", "[directions][3] x, y, z", directions),
        array("kReferenceSh", "[directions][100] Y_i in each direction", values),
        array("kReferenceF", "[36] an expansion f", F),
        array("kReferenceG", "[36] an expansion g", G),
        array("kReferenceRotation", "[3][3] the rotation of the quaternion w, x, y, z = 1, 2, -3, 4 (not normalised)",
              [v for row in rotation for v in row]),
        array("kReferenceRotated", "[36] f rotated by it", rotated(F, rotation)),
        array("kReferenceProduct", "[36] the product f g, to six bands", product(F, G)),
        array("kReferenceT", "[6][25] T_h, from five bands to the six functions of the H-basis",
              [v for row in t for v in row]),
        array("kReferenceC", "[16][16] C, from spherical to hemispherical harmonics, four bands each",
              [v for row in c for v in row]),
        array("kReferenceClampedCosine", "[24] A_l of irradiance E_lm = A_l L_lm",
              [decimal(clamped_cosine(l)) * PI for l in range(24)]),
        "}  // namespace prt::test",
    ]
    text = "\n".join(parts) + "\n"
    if len(sys.argv) < 2 or sys.argv[1] == "-":
        sys.stdout.write(text)
    else:
        with open(sys.argv[1], "w", encoding="utf-8") as file:
            file.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())

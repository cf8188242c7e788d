#!/usr/bin/env python3
"""Writes precompute/math/sh_product_generated.h: products of spherical harmonics as straight-line code.

usage: generate_sh_product.py [OUTPUT]        ('-', the default, is standard output)

The tripling coefficients c = integral of Y_i Y_j Y_k are square roots of rational numbers over pi: they are computed
exactly and rounded once. They are symmetric in i, j and k, so that each unordered triple is visited once. Triples are
grouped by a pair (i, j) they share, with thirds k; then, for F and G the two factors and y the product,
  a = sum_k c F_k,  b = sum_k c G_k,  t = F_i G_j + F_j G_i,
  y_i += a G_j + b F_j,  y_j += a G_i + b F_i,  y_k += c t,
which costs three operations per triple and six per pair. The pairs are a greedy cover of the triples.
"""
import sys
from decimal import Decimal, getcontext
from fractions import Fraction
from itertools import product
from math import factorial

ORDERS = range(1, 7)
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")
getcontext().prec = 50


def polynomial_product(a, b):
    result = [Fraction(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return result


def legendre_derivative(l, m):
    """Coefficients of the m-th derivative of P_l, by Rodrigues' formula."""
    p = [Fraction(0)] * (l + 1)
    for k in range(l // 2 + 1):
        p[l - 2 * k] = Fraction((-1) ** k * factorial(2 * l - 2 * k),
                                2 ** l * factorial(k) * factorial(l - k) * factorial(l - 2 * k))
    for _ in range(m):
        p = [power * c for power, c in enumerate(p)][1:]
    return p


def azimuth_integral(ms):
    """Integral over a circle of cos(m phi) (m >= 0) and sin(|m| phi) (m < 0), a factor for each m; over pi."""
    total = 0
    for signs in product((1, -1), repeat=len(ms)):  # cos = (e + e*) / 2, sin = (e - e*) / 2i
        if sum(s * abs(m) for s, m in zip(signs, ms)) == 0:
            term = 1
            for s, m in zip(signs, ms):
                term *= -1j * s if m < 0 else 1
            total += term
    return Fraction(int(total.real), 2 ** len(ms)) * 2


def tripling(bands_and_ms):
    """Sign and pi times the square of the integral of three functions; None where it is zero."""
    ls, ms = zip(*bands_and_ms)
    if sum(ls) % 2 or 2 * max(ls) > sum(ls):
        return None
    azimuth = azimuth_integral(ms)
    if azimuth == 0:
        return None
    p, square = [Fraction(1)], Fraction(1)
    for l, m in bands_and_ms:
        p = polynomial_product(p, legendre_derivative(l, abs(m)))
        square *= Fraction((2 * l + 1) * factorial(l - abs(m)), 4 * factorial(l + abs(m))) * (2 if m else 1)
    for _ in range(sum(map(abs, ms)) // 2):  # sin(theta)^2, in pairs of factors
        p = polynomial_product(p, [Fraction(1), Fraction(0), Fraction(-1)])
    value = azimuth * sum(2 * c / (power + 1) for power, c in enumerate(p) if power % 2 == 0)
    # The signs (-1)^m of Condon and Shortley cancel: the |m| of a triple that is not zero add up to an even number.
    return (1 if value > 0 else -1, value * value * square) if value else None


class Code:
    """Lines of one function, and how many operations they hold."""

    def __init__(self):
        self.lines, self.started, self.multiplications, self.additions = [], set(), 0, 0

    def sum_of(self, terms):
        self.multiplications += sum(t.count("*") for t in terms)
        self.additions += len(terms) - 1
        return " + ".join(terms)

    def define(self, name, terms):
        self.lines.append(f"const T {name} = {self.sum_of(terms)};")

    def add_to(self, i, terms):
        operator = "+=" if i in self.started else "="
        self.additions += i in self.started
        self.started.add(i)
        self.lines.append(f"y[{i}] {operator} {self.sum_of(terms)};")


def choose_pairs(triples):
    """Greedy cover of triples of three different functions: a list of (i, j, thirds)."""
    left, pairs = set(triples), []
    while left:
        count = {}
        for i, j, k in left:
            for pair in ((i, j), (i, k), (j, k)):
                count[pair] = count.get(pair, 0) + 1
        i, j = max(count, key=lambda pair: (count[pair], pair))
        covered = {t for t in left if i in t and j in t}
        left -= covered
        pairs.append((i, j, sorted(sum(t) - i - j for t in covered)))
    return sorted(pairs)


def generate(order, constant):
    """Code of the product of two expansions of `order` bands. constant(triple): its name, None for zero."""
    count = order * order
    triples = [(i, j, k) for i in range(count) for j in range(i, count) for k in range(j, count)
               if constant((i, j, k))]
    pairs = choose_pairs([t for t in triples if len(set(t)) == 3])
    mixed = {(i, j) for i, j, _ in pairs}
    name = lambda *t: constant(tuple(sorted(t)))
    code = Code()
    code.define("f0", [f"{name(0, 0, 0)} * f[0]"])
    code.add_to(0, ["f0 * g[0]"])
    if count > 1:
        code.define("g0", [f"{name(0, 0, 0)} * g[0]"])
    # Triples {i, i, k}; those with k = 0 share one constant.
    once = {i: [] for i in range(1, count)}  # k with {i, i, k}, by way of the pair (i, i)
    twice = {}                               # the same by way of the pair (i, k), which exists anyway
    for i in range(1, count):
        for k in range(1, count):
            if k == i or not name(i, i, k):
                continue
            if (min(i, k), max(i, k)) in mixed:
                twice.setdefault((min(i, k), max(i, k)), []).append((i, name(i, i, k)))
            else:
                once[i].append(k)
    for i in range(1, count):
        thirds = once[i]
        f, g = "f0", "g0"
        if thirds:
            code.define(f"a{i}", ["f0"] + [f"{name(i, i, k)} * f[{k}]" for k in thirds])
            code.define(f"b{i}", ["g0"] + [f"{name(i, i, k)} * g[{k}]" for k in thirds])
            f, g = f"a{i}", f"b{i}"
        code.add_to(i, [f"{f} * g[{i}]", f"{g} * f[{i}]"])
        code.define(f"s{i}", [f"f[{i}] * g[{i}]"])
        for k in thirds + ([i] if name(i, i, i) else []):
            code.add_to(k, [f"{name(i, i, k)} * s{i}"])
        for (p, q), uses in twice.items():
            for i2, c in uses:
                if i2 == i:
                    code.add_to(p + q - i, [f"{c} * s{i}"])
    if count > 1:
        code.define("squares", [f"s{i}" for i in range(1, count)])
        code.add_to(0, [f"{name(0, 0, 0)} * squares"])
    for i, j, thirds in pairs:
        tag = f"{i}_{j}"
        code.define(f"a{tag}", [f"{name(i, j, k)} * f[{k}]" for k in thirds])
        code.define(f"b{tag}", [f"{name(i, j, k)} * g[{k}]" for k in thirds])
        code.define(f"t{tag}", [f"f[{i}] * g[{j}]", f"f[{j}] * g[{i}]"])
        code.add_to(i, [f"a{tag} * g[{j}]", f"b{tag} * f[{j}]"])
        code.add_to(j, [f"a{tag} * g[{i}]", f"b{tag} * f[{i}]"])
        for k in thirds:
            code.add_to(k, [f"{name(i, j, k)} * t{tag}"])
        for i2, c in twice.get((i, j), []):
            code.add_to(i2, [f"{c} * t{tag}"])
    ordered = {1: 1, 2: 3, 3: 6}
    return code, sum(ordered[len(set(t))] for t in triples)


HEADER = """\
// Written by tools/generate_sh_product.py: change that, not this.
// Products of spherical-harmonic expansions of 1 to 6 bands as straight-line code, for one product or the body of a
// loop over many, which compilers vectorise. Tripling coefficients are exact before rounding; how the sums are grouped is explained in the script.
// [Ren2006], [Sloan2008, "SH products"]. Internal to prt_math.
#pragma once
// clang-format off

namespace prt::detail {
"""


def wrapped(line, indent, width=110):
    """The line at its indentation, broken after " +"."""
    pieces, here = [], " " * indent
    for word in line.replace(" + ", " +\0").split("\0"):
        if len(here) + len(word) > width:
            pieces.append(here.rstrip())
            here = " " * (indent + 4)
        here += word + (" " if word.endswith("+") else "")
    return pieces + [here.rstrip()]


def main():
    top = max(ORDERS)
    functions = [(l, m) for l in range(top) for m in range(-l, l + 1)]
    coefficient, values = {}, {}
    for i in range(len(functions)):
        for j in range(i, len(functions)):
            for k in range(j, len(functions)):
                exact = tripling((functions[i], functions[j], functions[k]))
                if exact:
                    coefficient[i, j, k] = exact
                    values.setdefault(exact, None)
    for number, exact in enumerate(values):
        values[exact] = number

    def constant(triple):
        exact = coefficient.get(triple)
        return None if exact is None else f"c[{values[exact]}]"

    lines = HEADER.splitlines()
    lines += ["/// The values of tripling coefficients, T float or double.", "template <typename T>",
              f"inline constexpr T kTriplingValues[{len(values)}] = {{"]
    for sign, square in values:
        root = (Decimal(square.numerator) / Decimal(square.denominator) / PI).sqrt()
        lines.append(f"    T({float(sign * root)!r}),")
    lines += ["};", "", "/// Code for N bands.", "template <int N>", "struct ShProductCode;"]
    for order in ORDERS:
        code, non_zeros = generate(order, constant)
        lines += ["", "template <>", f"struct ShProductCode<{order}> {{",
                  f"    static constexpr int kNonZeros = {non_zeros};",
                  f"    static constexpr int kMultiplications = {code.multiplications};",
                  f"    static constexpr int kAdditions = {code.additions};",
                  "    /// @param inF, inG, out  [N²], by operator[]; out is written once all of f and g are read, so that it may be one of them.",
                  "    /// All indices are constants: the undefined-behaviour sanitizer would take a minute to compile its checks.",
                  "    template <typename T, typename In, typename Out>",
                  "    __attribute__((always_inline, no_sanitize(\"undefined\")))",
                  "    static inline void run(const In& inF, const In& inG, const Out& out) {",
                  f"        constexpr const T(&c)[{len(values)}] = kTriplingValues<T>;",
                  f"        T f[{order * order}], g[{order * order}], y[{order * order}];"]
        # No loops: they would keep compilers from making vectors of a loop around this.
        lines += [f"        f[{i}] = inF[{i}], g[{i}] = inG[{i}];" for i in range(order * order)]
        for line in code.lines:
            lines += wrapped(line, 8)
        lines += [f"        out[{i}] = y[{i}];" for i in range(order * order)] + ["    }", "};"]
    lines += ["", "}  // namespace prt::detail", "// clang-format on", ""]
    text = "\n".join(lines)
    if len(sys.argv) > 2:
        sys.exit("usage: generate_sh_product.py [OUTPUT]")
    if len(sys.argv) == 2 and sys.argv[1] != "-":
        with open(sys.argv[1], "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    else:
        sys.stdout.buffer.write(text.encode("utf-8"))


if __name__ == "__main__":
    main()

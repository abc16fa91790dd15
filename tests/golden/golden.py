#!/usr/bin/python3
"""Computes the expected values of tests/golden, independently of the code under test.

    golden.py write            writes one JSON file per method into this folder
    golden.py check            computes all cases again; exits with 1 if a file differs by more than 1e-11, with 77 if
                               this machine has no SciPy

`c2`, `normalized` and the local methods are computed in exact rational numbers: c2 as one dense linear system for all
coefficients (interpolation, continuity and boundary conditions), not by the tridiagonal rows that the code solves.
`rounded` needs square roots, which are taken with 60 digits. hermite, quintic and smoothing come from SciPy.

A file is an object of cases by name. A case has `method`, `start` and `end` ([kind, values or null]), `t_ns`, `x`
([knot][dimension]) and, if the method needs them, `v`, `a` and `lambda`; `query_ns`; `expected.p`, `.v`, `.a`, `.j`
([query][dimension]) and `expected.segments` ([segment][dimension][coefficient, highest power first], seconds). A query
at a knot is evaluated in the segment on its right.
"""

import argparse
import decimal
import json
import random
import sys
from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).resolve().parent
SECOND = 10**9
TOLERANCE = 1e-11  # of the largest value of an array: SciPy's rounding differs between versions and processors


# Exact linear algebra


def solve(rows, right):
    """Solves a dense linear system of rationals by Gaussian elimination."""
    size = len(rows)
    system = [list(row) + [value] for row, value in zip(rows, right)]
    for column in range(size):
        pivot = next(r for r in range(column, size) if system[r][column] != 0)
        system[column], system[pivot] = system[pivot], system[column]
        scale = 1 / system[column][column]
        system[column] = [scale * value for value in system[column]]
        for r in range(size):
            factor = system[r][column]
            if r != column and factor != 0:
                system[r] = [a - factor * b for a, b in zip(system[r], system[column])]
    return [row[-1] for row in system]


# Polynomials: coefficients from the lowest power, in seconds from the left knot


def derivative(coefficients, times=1):
    for _ in range(times):
        coefficients = [k * c for k, c in enumerate(coefficients)][1:] or [coefficients[0] * 0]
    return coefficients


def value_at(coefficients, u):
    value = coefficients[0] * 0
    for c in reversed(coefficients):
        value = value * u + c
    return value


def cubic(x0, x1, v0, v1, h):
    m = (x1 - x0) / h
    return [x0, v0, (3 * m - 2 * v0 - v1) / h, (v0 + v1 - 2 * m) / h**2]


def quintic(left, right, h):
    """The quintic with the given position, velocity and acceleration at both ends, by six equations."""
    rows, values = [], []
    for u, state in ((0 * h, left), (h, right)):
        for order in range(3):
            row = []
            for power in range(6):
                unit = [0] * power + [1]
                row.append(Fraction(value_at(derivative(unit, order), u)) if power >= order else Fraction(0))
            rows.append(row)
            values.append(state[order])
    return solve(rows, values)


# Methods. Each returns the segments of one dimension


def powers(u, order):
    """The values of the order-th derivatives of 1, u, u², u³ at u."""
    return [Fraction(value_at(derivative([0] * k + [1], order), u)) if k >= order else Fraction(0) for k in range(4)]


def c2(h, x, start, end):
    """All coefficients at once: 4 unknowns per segment."""
    pieces = len(h)
    rows, values = [], []

    def equation(terms, value):
        row = [Fraction(0)] * (4 * pieces)
        for piece, coefficients, sign in terms:
            for k in range(4):
                row[4 * piece + k] += sign * coefficients[k]
        rows.append(row)
        values.append(Fraction(value))

    for i in range(pieces):
        equation([(i, powers(Fraction(0), 0), 1)], x[i])
        equation([(i, powers(h[i], 0), 1)], x[i + 1])
    for i in range(pieces - 1):
        for order in (1, 2):
            equation([(i, powers(h[i], order), 1), (i + 1, powers(Fraction(0), order), -1)], 0)
    if start[0] == "periodic":
        for order in (1, 2):
            equation([(0, powers(Fraction(0), order), 1), (pieces - 1, powers(h[-1], order), -1)], 0)
    else:
        for (kind, given), piece, u, inner in ((start, 0, Fraction(0), 0), (end, pieces - 1, h[-1], pieces - 2)):
            if kind == "not-a-knot":
                equation([(inner, powers(h[inner], 3), 1), (inner + 1, powers(Fraction(0), 3), -1)], 0)
            elif kind in ("velocity", "clamped", "halt"):
                equation([(piece, powers(u, 1), 1)], given or 0)
            else:
                equation([(piece, powers(u, 2), 1)], given or 0)
    solution = solve(rows, values)
    segments = [solution[4 * i : 4 * i + 4] for i in range(pieces)]
    for (kind, _), piece in ((start, 0), (end, pieces - 1)):
        if kind == "halt":
            both = pieces == 1 and start[0] == end[0] == "halt"
            segments[piece] = halting(segments[piece], h[piece], piece == 0, both)
    return segments


def halting(segment, h, at_start, both):
    """The quintic that also has acceleration 0 at the end of the curve."""
    states = [[value_at(derivative(segment, order), u) for order in range(3)] for u in (Fraction(0), h)]
    if at_start or both:
        states[0][2] = Fraction(0)
    if not at_start or both:
        states[1][2] = Fraction(0)
    return quintic(states[0], states[1], h)


def from_velocities(h, x, v):
    return [cubic(x[i], x[i + 1], v[i], v[i + 1], h[i]) for i in range(len(h))]


def chords(h, x):
    return [(x[i + 1] - x[i]) / h[i] for i in range(len(h))]


def parabola_end(m0, m1, h0, h1):
    return ((2 * h0 + h1) * m0 - h0 * m1) / (h0 + h1)


def bessel(h, x):
    m = chords(h, x)
    v = [(h[i] * m[i - 1] + h[i - 1] * m[i]) / (h[i - 1] + h[i]) for i in range(1, len(h))]
    return from_velocities(
        h, x, [parabola_end(m[0], m[1], h[0], h[1])] + v + [parabola_end(m[-1], m[-2], h[-1], h[-2])])


def akima_like(h, x, weight, without):
    m = chords(h, x)
    m = [3 * m[0] - 2 * m[1], 2 * m[0] - m[1]] + m + [2 * m[-1] - m[-2], 3 * m[-1] - 2 * m[-2]]
    v = []
    for i in range(len(x)):
        far_before, before, after, far_after = m[i : i + 4]
        left, right = weight(far_after, after), weight(before, far_before)
        both = left + right
        v.append((left * before + right * after) / both if both != 0 else without(before, after))
    return from_velocities(h, x, v)


def akima(h, x):
    return akima_like(h, x, lambda a, b: abs(a - b), lambda a, b: (a + b) / 2)


def makima(h, x):
    return akima_like(h, x, lambda a, b: abs(a - b) + abs(a + b) / 2, lambda a, b: 0 * a)


def pchip(h, x):
    m = chords(h, x)

    def interior(i):
        if m[i - 1] * m[i] <= 0:
            return Fraction(0)
        w1, w2 = 2 * h[i] + h[i - 1], h[i] + 2 * h[i - 1]
        return (w1 + w2) / (w1 / m[i - 1] + w2 / m[i])

    def at_end(m0, m1, h0, h1):
        v = parabola_end(m0, m1, h0, h1)
        if v * m0 <= 0:
            return Fraction(0)
        return 3 * m0 if m0 * m1 <= 0 and abs(v) > abs(3 * m0) else v

    v = [at_end(m[0], m[1], h[0], h[1])] + [interior(i) for i in range(1, len(h))]
    return from_velocities(h, x, v + [at_end(m[-1], m[-2], h[-1], h[-2])])


def rounded(h, x):
    def length(i):
        decimal.getcontext().prec = 60
        square = h[i] ** 2 + (x[i + 1] - x[i]) ** 2
        return Fraction((decimal.Decimal(square.numerator) / decimal.Decimal(square.denominator)).sqrt())

    unit = [length(i) for i in range(len(h))]
    v = [Fraction(0)]
    for i in range(1, len(h)):
        rise = (x[i + 1] - x[i]) / unit[i] + (x[i] - x[i - 1]) / unit[i - 1]
        v.append(rise / (h[i] / unit[i] + h[i - 1] / unit[i - 1]))
    m = chords(h, x)
    v[0] = (3 * m[0] - v[1]) / 2
    return from_velocities(h, x, v + [(3 * m[-1] - v[-1]) / 2])


def normalized(h, x):
    ones = [Fraction(1)] * len(h)
    natural = ("natural", None)
    segments = c2(ones, x, natural, natural)
    return [[c / h[i] ** k for k, c in enumerate(segment)] for i, segment in enumerate(segments)]


# Cases


def mesh(seed, knots, dimensions, spread):
    """Times with intervals around 10 ms, in a ratio of up to `spread`, and positions in multiples of 2⁻²⁰."""
    draw = random.Random(seed)
    times = [1_700_000_000_000_000_000 if seed % 2 else -3_000_000_000]
    for _ in range(knots - 1):
        times.append(times[-1] + round(10_000_000 * spread ** draw.uniform(-0.5, 0.5)))
    points = [[draw.randint(-(2**21), 2**21) / 2**20 for _ in range(dimensions)] for _ in range(knots)]
    return draw, times, points


def queries(times):
    """The knots, and five times inside each interval."""
    inside = [a + (b - a) * k // 6 for a, b in zip(times, times[1:]) for k in range(6)]
    return inside + [times[-1]]


def sampled(times, segments, query):
    """The derivatives 0 to 3 at each query; segments[i][d] from the lowest power."""
    found = {name: [] for name in "pvaj"}
    piece = 0
    for t in query:
        while piece + 2 < len(times) and t >= times[piece + 1]:
            piece += 1
        u = Fraction(t - times[piece], SECOND)
        for order, name in enumerate("pvaj"):
            found[name].append([float(value_at(derivative(c, order), u)) for c in segments[piece]])
    return found


def case(method, times, points, segments, **given):
    """segments[d][i] from the lowest power."""
    by_segment = [[segments[d][i] for d in range(len(points[0]))] for i in range(len(times) - 1)]
    query = queries(times)
    expected = sampled(times, by_segment, query)
    expected["segments"] = [[[float(c) for c in reversed(d)] for d in segment] for segment in by_segment]
    return {"method": method, **given, "t_ns": times, "x": points, "query_ns": query, "expected": expected}


def exact(times, points, curve):
    """curve(h, x, d) for each dimension, in rationals."""
    h = [Fraction(b - a, SECOND) for a, b in zip(times, times[1:])]
    return [curve(h, [Fraction(point[d]) for point in points], d) for d in range(len(points[0]))]


def c2_case(seed, knots, dimensions, spread, start, end):
    draw, times, points = mesh(seed, knots, dimensions, spread)
    if start == "periodic":
        points[-1] = list(points[0])
    values = {}
    for side, kind in (("start", start), ("end", end)):
        needs = kind in ("velocity", "acceleration")
        values[side] = [kind, [draw.randint(-1000, 1000) / 16 for _ in range(dimensions)] if needs else None]

    def at(side, d):
        kind, given = values[side]
        return kind, Fraction(given[d]) if given else None

    segments = exact(times, points, lambda h, x, d: c2(h, x, at("start", d), at("end", d)))
    return case("c2", times, points, segments, **values)


def local_case(method, curve, seed, knots, dimensions, spread):
    _, times, points = mesh(seed, knots, dimensions, spread)
    return case(method, times, points, exact(times, points, lambda h, x, d: curve(h, x)))


def scipy_case(method, seed, knots, dimensions):
    import numpy
    from scipy.interpolate import BPoly, CubicHermiteSpline, PPoly, make_smoothing_spline

    draw, times, points = mesh(seed, knots, dimensions, 3)
    given = {}
    if method != "smoothing":
        given["v"] = [[draw.uniform(-50, 50) for _ in range(dimensions)] for _ in range(knots)]
    if method == "quintic":
        given["a"] = [[draw.uniform(-500, 500) for _ in range(dimensions)] for _ in range(knots)]
    if method == "smoothing":
        given["lambda"] = 1e-6
    seconds = numpy.array([(t - times[0]) / SECOND for t in times])
    segments = []
    for d in range(dimensions):
        x = numpy.array([point[d] for point in points])
        if method == "hermite":
            curve = CubicHermiteSpline(seconds, x, [v[d] for v in given["v"]])
        elif method == "quintic":
            states = [[x[i], given["v"][i][d], given["a"][i][d]] for i in range(knots)]
            curve = PPoly.from_bernstein_basis(BPoly.from_derivatives(seconds, states))
        else:
            curve = PPoly.from_spline(make_smoothing_spline(seconds, x, lam=given["lambda"]))
        pieces = [i for i in range(len(curve.x) - 1) if curve.x[i + 1] > curve.x[i]]
        segments.append([[float(c) for c in reversed(curve.c[:, i])] for i in pieces])
    rational = [[[Fraction(c) for c in piece] for piece in pieces] for pieces in segments]
    return case(method, times, points, rational, **given)


def all_cases():
    cases = {}
    conditions = ("natural", "clamped", "halt", "velocity", "acceleration", "not-a-knot")
    pairs = [(c, c) for c in conditions] + [("velocity", "natural"), ("halt", "acceleration"),
                                            ("clamped", "not-a-knot"), ("periodic", "periodic")]
    for k, (start, end) in enumerate(pairs):
        cases[f"c2-{start}-{end}-n7"] = c2_case(100 + k, 7, 2, 4, start, end)
    for knots in (2, 3):
        for start, end in (("natural", "natural"), ("velocity", "clamped"), ("halt", "halt")):
            cases[f"c2-{start}-{end}-n{knots}"] = c2_case(200 + knots, knots, 1, 2, start, end)
    cases["c2-natural-natural-wild"] = c2_case(301, 12, 1, 1000, "natural", "natural")
    for k, (method, curve) in enumerate({"bessel": bessel, "akima": akima, "makima": makima, "pchip": pchip,
                                         "rounded": rounded, "normalized": normalized}.items()):
        cases[f"{method}-n9"] = local_case(method, curve, 400 + k, 9, 2, 4)
        cases[f"{method}-n4"] = local_case(method, curve, 500 + k, 4, 1, 20)
    for k, method in enumerate(("hermite", "quintic", "smoothing")):
        cases[f"{method}-n8"] = scipy_case(method, 600 + k, 8, 2)
    return cases


# Files


def difference(found, wanted, where=""):
    """The first place at which two values differ, in words; nothing if there is none."""
    if isinstance(wanted, dict):
        if not isinstance(found, dict) or found.keys() != wanted.keys():
            return f"{where}: other keys"
        return next(filter(None, (difference(found[k], wanted[k], f"{where}.{k}") for k in wanted)), None)
    if isinstance(wanted, list) and all(isinstance(v, list) for v in wanted):
        if not isinstance(found, list) or len(found) != len(wanted):
            return f"{where}: other length"
        places = (difference(f, w, f"{where}[{i}]") for i, (f, w) in enumerate(zip(found, wanted)))
        return next(filter(None, places), None)
    if isinstance(wanted, list) and wanted and all(isinstance(v, float) for v in wanted):
        scale = max(map(abs, wanted)) or 1
        if len(found) != len(wanted) or any(abs(f - w) > TOLERANCE * scale for f, w in zip(found, wanted)):
            return f"{where}: {found} instead of {wanted}"
        return None
    return None if found == wanted else f"{where}: {found} instead of {wanted}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["write", "check"])
    what = parser.parse_args().what
    try:
        import scipy.interpolate  # noqa: F401
    except ImportError:
        print("no SciPy (Debian: python3-scipy)")
        return 77
    methods = {}
    for name, content in all_cases().items():
        methods.setdefault(content["method"], {})[name] = content
    if what == "write":
        for method, cases in methods.items():
            (HERE / f"{method}.json").write_text(json.dumps(cases) + "\n", encoding="utf-8")
        return 0
    stored = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in HERE.glob("*.json")}
    wrong = difference(methods, stored)
    print(wrong or f"{sum(map(len, methods.values()))} cases agree with their files")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

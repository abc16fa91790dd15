"""Fits equal those of SciPy on random meshes, whose seeds are printed when a test fails."""

import unittest

import numpy as np
from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator, PPoly

import splinecast

SEEDS = range(60)
EQUAL = 1e-12  # of the largest value
SAME = 1e-13


def mesh(rng, n, kind):
    """Random increasing times: ns, floats, or floats of any size and place."""
    if kind == "ns":
        return np.sort(rng.choice(10**9, n, replace=False)).astype(np.int64)
    times = np.cumsum(rng.uniform(0.02, 1.0, n))
    if kind == "scaled":
        times = times * 10.0 ** rng.uniform(-9, 9)
        times += times[-1] * rng.uniform(-10, 10)
    return times


def in_seconds(times):
    return times / 1e9 if times.dtype == np.int64 else times


class Scipy:
    """An interpolator of SciPy, which computes in a unit of time near the mean interval.

    The unit is a power of two, so that it rounds nothing. With long intervals the equations of a clamped
    CubicSpline in seconds are badly scaled: it then loses up to 9 digits.
    """

    def __init__(self, make, seconds, x, **options):
        self.unit = 2.0 ** np.round(np.log2(np.diff(seconds).mean()))
        if isinstance(options.get("bc_type"), tuple):
            options["bc_type"] = tuple((nu, value * self.unit**nu) for nu, value in options["bc_type"])
        self.made = make(seconds / self.unit, x, **options)

    def __call__(self, seconds, nu):
        return self.made(seconds / self.unit, nu) / self.unit**nu


class Fit(unittest.TestCase):
    def check(self, ours, theirs, times, rng, is_periodic=False):
        x = in_seconds(times)
        knots = x[:0] if is_periodic else x  # SciPy rounds them, which may change the segment
        instants = np.concatenate([knots, rng.uniform(x[0], x[-1], 300)])
        polynomial = ours.to_ppoly()
        self.assertIsInstance(polynomial, PPoly)
        # SciPy computes with the seconds of integer times, which are rounded.
        rounded = 8 * np.abs(x).max() * 2.0**-53 / np.diff(x).min() if times.dtype == np.int64 else 0
        for nu in range(4):
            expected = theirs(instants, nu)
            size = np.abs(expected).max()
            self.assertLessEqual(np.abs(ours(instants, nu) - expected).max(), (EQUAL + rounded) * size, nu)
            if nu < 3:
                self.assertLessEqual(np.abs(polynomial(instants, nu) - ours(instants, nu)).max(),
                                     (SAME + rounded) * size, nu)

    def on_each_mesh(self, check):
        for seed in SEEDS:
            for kind in ("ns", "floats", "scaled"):
                rng = np.random.default_rng(seed)
                n = int(rng.integers(5, 60))
                times = mesh(rng, n, kind)
                with self.subTest(seed=seed, kind=kind):
                    check(rng, times, in_seconds(times), rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-6, 6))

    def test_c2_equals_cubic_spline_with_every_boundary_condition(self):
        def check(rng, times, seconds, x):
            h = np.diff(seconds).mean()
            v, a = rng.normal(size=(2, 3)) / h
            for ours, theirs in [("natural", "natural"), ("clamped", "clamped"), ("not-a-knot", "not-a-knot"),
                                 (None, "natural")]:
                self.check(splinecast.fit(times, x, start=ours, end=ours), Scipy(CubicSpline, seconds, x, bc_type=theirs),
                           times, rng)
            self.check(splinecast.fit(times, x, start=("velocity", v), end=("acceleration", a / h)),
                       Scipy(CubicSpline, seconds, x, bc_type=((1, v), (2, a / h))), times, rng)
            x[-1] = x[0]
            self.check(splinecast.fit(times, x, start="periodic", end="periodic"),
                       Scipy(CubicSpline, seconds, x, bc_type="periodic"), times, rng, True)

        self.on_each_mesh(check)

    def test_akima_and_pchip_equal_those_of_scipy(self):
        def check(rng, times, seconds, x):
            self.check(splinecast.fit(times, x, method="akima"), Scipy(Akima1DInterpolator, seconds, x), times, rng)
            self.check(splinecast.fit(times, x, method="pchip"), Scipy(PchipInterpolator, seconds, x), times, rng)

        self.on_each_mesh(check)

    def test_numbers_give_a_curve_of_numbers(self):
        curve = splinecast.fit([0.0, 1.0, 2.0, 3.0], [0, 1, 4, 9.0], start="not-a-knot", end="not-a-knot")
        self.assertAlmostEqual(curve(1.5), 2.25)
        self.assertIsInstance(curve(1.5), float)
        self.assertAlmostEqual(curve(1_500_000_000, nu=1), 3)
        np.testing.assert_allclose(curve(np.full((2, 3), 0.5), 2), np.full((2, 3), 2.0))
        self.assertEqual(curve(0.5, nu=7), 0)
        self.assertAlmostEqual(curve(4.0, extrapolate=True), 16)
        self.assertEqual(curve.to_ppoly().c.shape, (4, 3))
        self.assertEqual((curve.dimensions, curve.method, curve.lam, len(curve)), (1, "c2", None, 3))
        np.testing.assert_array_equal(curve.breaks, [0, 1, 2, 3])

    def test_large_times_of_a_clock_lose_nothing(self):
        times = 1_700_000_000_000_000_000 + np.arange(10) * 100_000_000
        x = np.sin(np.arange(10.0))
        curve = splinecast.fit(times, x)
        near = splinecast.fit(times - times[0], x)
        inside = times[:-1] + 12_345_678
        np.testing.assert_array_equal(curve(inside), near(inside - times[0]))
        polynomial = curve.to_ppoly(origin=int(times[0]))
        np.testing.assert_allclose(polynomial((inside - times[0]) / 1e9), curve(inside), rtol=1e-13, atol=1e-13)
        self.assertEqual(curve.breaks.dtype, np.int64)

    def test_smoothing_and_the_scale_of_rounded_are_those_of_true_seconds(self):
        rng = np.random.default_rng(3)
        ns = np.sort(rng.choice(10**10, 40, replace=False)).astype(np.int64)
        x = np.sin(ns * 1e-9) + 0.1 * rng.normal(size=40)
        inside = np.linspace(ns[0], ns[-1], 100).astype(np.int64)
        for options in (dict(method="smoothing", lam=0.01), dict(method="smoothing"),
                        dict(method="rounded", time_scale=0.3), dict(method="normalized"),
                        dict(method="hermite", velocities=np.cos(ns * 1e-9)),
                        dict(method="c2", start="halt", end="halt")):
            with self.subTest(options["method"]):
                of_ns = splinecast.fit(ns, x, **options)
                of_floats = splinecast.fit(ns * 1e-9, x, **options)
                for nu in range(3):
                    np.testing.assert_allclose(of_floats(inside, nu), of_ns(inside, nu), rtol=1e-6, atol=1e-7)
        self.assertAlmostEqual(splinecast.cross_validated_lambda(ns * 1e-9, x),
                               splinecast.cross_validated_lambda(ns, x), delta=1e-9)

    def test_errors_name_index_and_value(self):
        for times, x, options, text in [
            ([0.0, 1.0, 0.5], np.zeros(3), {}, r"times\[2\] = 0.5 s is not after times\[1\] = 1 s"),
            ([0.0, np.nan], np.zeros(2), {}, r"times\[1\] = nan"),
            ([0.0, 1e-30, 1.0], np.zeros(3), {}, r"times\[1\]"),
            ([5, 4], np.zeros(2), {}, "4 ns"),
            ([0.0, 1.0], [0, np.inf], {}, "waypoint 1.*inf"),
            ([0.0, 1.0], np.zeros(3), {}, "3 rows of 1 values, not 2"),
            ([], [], {}, "at least one"),
            ([0.0, 1.0], [0, 1], dict(method="cubic"), "'cubic'"),
            ([0.0, 1.0], [0, 1], dict(method="hermite"), "velocity"),
            ([0.0, 1.0], [0, 1], dict(start="halted"), "'halted'"),
            ([0.0, 1.0], [0, 1], dict(start=("velocity", [1, 2])), "2"),
            ([0.0, 1.0], [0, 1], dict(method="smoothing", lam=-1), "-1"),
        ]:
            with self.subTest(text), self.assertRaisesRegex(splinecast.BadRequest, text):
                splinecast.fit(times, x, **options)
        curve = splinecast.fit([0.0, 1.0], [0, 1])
        for t, text in ((1.5, "time 1.5 s .index 0. is not within 0 to 1 s"), ([0.5, np.nan], "index 1"),
                        (2_000_000_000, "2000000000 ns")):
            with self.subTest(t), self.assertRaisesRegex(ValueError, text):
                curve(t)
        with self.assertRaisesRegex(ValueError, "-1"):
            curve(0.5, nu=-1)
        with self.assertRaisesRegex(ValueError, "single waypoint"):
            splinecast.fit([0.0], [1]).to_ppoly()
        self.assertEqual(splinecast.fit([0.0], [7.0])(0.0), 7)


if __name__ == "__main__":
    unittest.main()

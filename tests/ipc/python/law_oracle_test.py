"""Samples of streams that follow a time law, against curves and law composed in 50 digits.

Snapshots of the law and of the streams give their polynomials. The oracle composes them as truncated power series in
host time: it knows no chain rule. It is compared with what readers sample, at random host times.
"""

import random
import time
import unittest

import numpy as np

import splinecast
from fixture import MS, PATIENCE, StreamTest, wait_for
from splinecast import SampleStatus, SegmentKind

try:
    import mpmath
except ImportError:
    mpmath = None

#: Power series in host seconds: value and three derivatives, as c[0] + c[1] h + c[2] h² + c[3] h³.
ORDER = 4
PERIOD = 2.0
KINDS = ["linear", f"periodic:{PERIOD}", "quaternion", "quaternion", "quaternion", "quaternion"]
#: Options of the methods that need some, or whose default settles late.
OPTIONS = {"smoothing": dict(lam=1e-7, settle=20, force_lag=True)}
INTERVAL = 50 * MS
WAYPOINTS = 60


def product(a, b):
    return [mpmath.fsum(a[i] * b[k - i] for i in range(k + 1)) for k in range(ORDER)]


def square_root(a):
    root = [mpmath.sqrt(a[0])]
    for k in range(1, ORDER):
        root.append((a[k] - mpmath.fsum(root[i] * root[k - i] for i in range(1, k))) / (2 * root[0]))
    return root


def quotient(a, b):
    found = []
    for k in range(ORDER):
        found.append((a[k] - mpmath.fsum(found[i] * b[k - i] for i in range(k))) / b[0])
    return found


def polynomial(coefficients, u):
    """The series of a polynomial of the series u, by Horner's rule."""
    total = [mpmath.mpf(0)] * ORDER
    for coefficient in reversed(coefficients):
        total = product(total, u)
        total[0] += mpmath.mpf(float(coefficient))
    return total


def derivatives(series):
    """Value and derivatives by host time."""
    return [float(c * mpmath.factorial(k)) for k, c in enumerate(series)]


def segment_at(segments, t):
    """The segment that contains a time, which segments of one snapshot do in order; the last one after its end."""
    lefts = [segment.left for segment in segments]
    return segments[np.searchsorted(lefts, int(mpmath.floor(t)), side="right") - 1]


def seconds(ns):
    return mpmath.mpf(ns) / 10**9


def angular(q):
    """Series of ω = 2 q′ q̄ from those of a unit quaternion x y z w, as three series."""
    rates = [[(k + 1) * c[k + 1] for k in range(ORDER - 1)] + [mpmath.mpf(0)] for c in q]
    (x, y, z, w), (dx, dy, dz, dw) = q, rates

    def combine(*terms):
        return [2 * mpmath.fsum(sign * product(a, b)[k] for sign, a, b in terms) for k in range(ORDER)]

    return [combine((1, dx, w), (-1, dw, x), (-1, dy, z), (1, dz, y)),
            combine((1, dy, w), (-1, dw, y), (-1, dz, x), (1, dx, z)),
            combine((1, dz, w), (-1, dw, z), (-1, dx, y), (1, dy, x))]


def angular_values(q, rate):
    """Vector part of 2 r q̄ for numbers."""
    (x, y, z, w), (dx, dy, dz, dw) = q, rate
    return 2 * np.array([dx * w - dw * x - dy * z + dz * y, dy * w - dw * y - dz * x + dx * z,
                         dz * w - dw * z - dx * y + dy * x])


class Composed:
    """A law and a curve as they were solved."""

    def __init__(self, law, curve, origin):
        self.law, self.curve, self.origin = law.segments, curve.segments, origin

    def law_at(self, host):
        """Series of the law's value [s] at a host time [ns]."""
        segment = segment_at(self.law, mpmath.mpf(host))
        u = [seconds(host - segment.left), mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0)]
        return polynomial(segment.coefficients[:, 0], u)

    def at(self, host):
        """Series of all dimensions at a host time [ns], quaternions of unit length; and its segment."""
        s = self.law_at(host)
        segment = segment_at(self.curve, self.origin + s[0] * 10**9)
        u = [s[0] - seconds(segment.left - self.origin), *s[1:]]
        x = [polynomial(segment.coefficients[:, d], u) for d in range(len(KINDS))]
        squares = [product(c, c) for c in x[2:6]]
        length = square_root([mpmath.fsum(column) for column in zip(*squares)])
        return x[:2] + [quotient(c, length) for c in x[2:6]], segment


@unittest.skipUnless(mpmath, "no mpmath (Debian: python3-mpmath)")
class Oracle(StreamTest):
    def setUp(self):
        super().setUp()
        mpmath.mp.dps = 50
        self.law = f"{self.name}-law"
        self.methods = splinecast.methods(streaming=True)
        self.names = {method: f"{self.name}-{method}" for method in self.methods}
        self.operator = splinecast.RateCommander(self.law, "operator")
        self.solvers = []
        self.addCleanup(self.remove_all)

    def remove_all(self):
        self.operator.close()
        for solver in self.solvers:
            solver.close()
        for name in (*self.names.values(), self.law):
            try:
                splinecast.remove(name)
            except splinecast.NoSuchStream:
                pass

    def start(self):
        """The law, and a stream of each method that follows it. Returns when the first waypoint is [ns]."""
        self.operator.set_rate(1, 0.005)
        self.solvers.append(splinecast.Solver(self.law, history=3600, capacity=4096).start())
        splinecast.Reader(self.law, timeout=PATIENCE)
        producers = []
        for method, name in self.names.items():
            self.solvers.append(
                splinecast.Solver(name, method, history=3600, **OPTIONS.get(method, {})).start())
            producers.append(splinecast.Producer(name, law=self.law, kinds=KINDS))
            self.assertTrue(producers[-1].wait_for_solver(PATIENCE))
        u = INTERVAL * 1e-9 * np.arange(WAYPOINTS)
        positions, velocities, accelerations = motion(u)
        begin = producers[0].now() + 500 * MS
        for producer in producers:
            producer.append_many(begin + INTERVAL * np.arange(WAYPOINTS), positions, velocities, accelerations)
            self.assertTrue(producer.wait_until_consumed(PATIENCE))
            self.assertEqual(producer.refusals(), [])
            producer.close()
        return begin

    def ask(self, begin):
        """Ramps, ramps that interrupt ramps, and a hold, in the middle of the curves."""
        reader = splinecast.Reader(next(iter(self.names.values())), timeout=PATIENCE)

        def sampled():
            self.assertTrue(reader.sample(time.monotonic_ns()).status.has_values)
            return reader.rate()

        def reach(rate):
            wait_for(lambda: sampled().rate == rate)

        def interrupt(beyond, rate, ramp):
            """Requests a rate in the middle of a ramp, unless this process is held up until its end."""
            wait_for(lambda: beyond(sampled().rate) or sampled().slope == 0)
            self.operator.set_rate(rate, ramp)

        wait_for(lambda: sampled().stream_time >= begin + 150 * MS)
        self.operator.set_rate(0.3, 0.2)
        reach(0.3)
        self.operator.set_rate(1, 0.3)
        interrupt(lambda rate: rate > 0.6, 0.1, 0.2)
        interrupt(lambda rate: rate < 0.4, 0.8, 0.15)
        reach(0.8)
        self.operator.hold(0.15)
        reach(0)
        self.operator.set_rate(1, 0.2)
        interrupt(lambda rate: rate > 0.5, 0, 0.2)
        reach(0)
        self.operator.release(0.1)
        wait_for(lambda: sampled().stream_time >= begin + INTERVAL * (WAYPOINTS - 5))

    def test_samples_are_the_composition_of_law_and_curve(self):
        begin = self.start()
        first = time.monotonic_ns()
        self.ask(begin)
        last = time.monotonic_ns()
        law = splinecast.Reader(self.law).snapshot(first, last)
        self.assertGreaterEqual(np.count_nonzero([abs(s.coefficients[2, 0]) > 1e-3 for s in law.segments]), 1,
                                "no ramp interrupted another one")
        self.assertIn(0, [round(float(s.coefficients[1, 0]), 12) for s in law.segments])
        seed = random.randrange(2**32)
        hosts = np.sort(np.random.default_rng(seed).integers(first, last, 400))
        for method, name in self.names.items():
            with self.subTest(method, seed=seed):
                self.compare(splinecast.Reader(name), law, hosts, begin)

    def compare(self, reader, law, hosts, begin):
        wait_for(lambda: reader.preview(int(hosts[-1])).status is SampleStatus.SETTLED)
        curve = reader.snapshot(begin, begin + INTERVAL * WAYPOINTS)
        oracle = Composed(law, curve, self.origin(reader, law, hosts))
        sampled, wanted, sampled_angular, wanted_angular = [], [], [], []
        for host in map(int, hosts):
            state = reader.preview(host)
            if reader.rate().stream_time < begin:
                self.assertIs(state.status, SampleStatus.HOLDING)
                continue
            self.assertIs(state.status, SampleStatus.SETTLED)
            series, segment = oracle.at(host)
            self.assertNotIn(segment.kind, (SegmentKind.STOP, SegmentKind.HOLD))
            values = np.transpose([derivatives(one) for one in series])
            values[0, 1] -= PERIOD * round(values[0, 1] / PERIOD)
            sampled.append(state.values.copy())
            wanted.append(values)
            q, v, a = state.values[:3, 2:6]
            sampled_angular.append([angular_values(q, v), angular_values(q, a)])
            wanted_angular.append(np.transpose([derivatives(one)[:2] for one in angular(series[2:6])]))
        self.assertGreater(len(sampled), 200)
        self.near(np.array(sampled), np.array(wanted))
        self.near(np.array(sampled_angular), np.array(wanted_angular))

    def near(self, found, wanted):
        """Compares arrays of [sample][derivative][dimension] with the largest of each derivative and dimension."""
        error = np.abs(found - wanted)
        largest = np.abs(wanted).max(axis=0)
        self.assertTrue((largest > 1e-3).any(axis=1).all(), "a derivative is 0 everywhere")
        worst = (error.max(axis=0) / np.maximum(largest, 1e-3)).max()
        self.assertLess(worst, 1e-9)

    def origin(self, reader, law, hosts):
        """Stream time of the law's value 0 [ns]: the one from which most of the stream times follow."""
        empty = Composed(law, law, 0)
        found = []
        for host in map(int, hosts[::20]):
            reader.preview(host)
            found.append(reader.rate().stream_time - int(mpmath.floor(empty.law_at(host)[0] * 10**9)))
        return max(set(found), key=found.count)


def motion(u):
    """A path of KINDS with its derivatives, arrays of [waypoint][dimension]."""
    turns = np.transpose([0.4 * np.sin(1.3 * u + d) for d in range(3)] + [1 + 0.2 * np.cos(u)])
    turned = np.transpose([0.52 * np.cos(1.3 * u + d) for d in range(3)] + [-0.2 * np.sin(u)])
    bent = np.transpose([-0.676 * np.sin(1.3 * u + d) for d in range(3)] + [-0.2 * np.cos(u)])
    wrapped = (3 * u + 0.3 * np.sin(2 * u) + 1) % PERIOD - 1
    return (np.column_stack([np.sin(2 * u), wrapped, turns]),
            np.column_stack([2 * np.cos(2 * u), 3 + 0.6 * np.cos(2 * u), turned]),
            np.column_stack([-4 * np.sin(2 * u), -1.2 * np.sin(2 * u), bent]))


if __name__ == "__main__":
    unittest.main()

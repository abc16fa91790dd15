"""Evaluates the output of `fit --emit bspline` and `--emit bezier` with SciPy and compares it with
`--emit samples`.

    scipy_check.py BSPLINE.json BEZIER.json SAMPLES.csv

Prints, as JSON, the largest difference in position, velocity, acceleration and jerk for each format,
relative to the largest value of that derivative. The jerk is not compared at knots, where it jumps.
"""

import json
import sys

import numpy
from scipy.interpolate import BPoly, BSpline


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def seconds(times_ns, origin_ns):
    return numpy.array([t - origin_ns for t in times_ns], dtype=float) / 1e9


def read_samples(path):
    """Times in integer nanoseconds and values [derivative][time][dimension]."""
    with open(path, encoding="utf-8") as file:
        rows = [line.split(",") for line in file.read().splitlines()[1:]]
    values = numpy.array([[float(field) for field in row[1:]] for row in rows])
    return [int(row[0]) for row in rows], numpy.split(values, 4, axis=1)


def largest_errors(curve, times, wanted, knots):
    errors = []
    for derivative, values in enumerate(wanted):
        compared = ~numpy.isin(times, knots) if derivative == 3 else numpy.full(len(times), True)
        got = curve(times, nu=derivative)
        error = numpy.abs(got - values)[compared].max()
        errors.append(error / numpy.abs(values).max())
    return errors


def main(b_spline_path, bezier_path, samples_path):
    b_spline, bezier = read_json(b_spline_path), read_json(bezier_path)
    times_ns, wanted = read_samples(samples_path)
    times = seconds(times_ns, b_spline["origin_ns"])
    breaks = seconds(bezier["breaks_ns"], b_spline["origin_ns"])
    by_knots = BSpline(b_spline["knots"], b_spline["control_points"], b_spline["degree"])
    by_points = BPoly(numpy.swapaxes(bezier["segments"], 0, 1), breaks)
    print(
        json.dumps(
            {
                "bspline": largest_errors(by_knots, times, wanted, breaks),
                "bezier": largest_errors(by_points, times, wanted, breaks),
            }
        )
    )


if __name__ == "__main__":
    main(*sys.argv[1:])

#!/usr/bin/env python3
"""Checks that each wrong form of splinecast/eigen.hpp gives one compile error, a sentence that names what to write.

    eigen_refusals.py COMPILER INCLUDE...      compiles one file of all forms, with these include folders
"""

import re
import subprocess
import sys

VALUES = """Eigen::VectorXd x; Eigen::VectorXf f; Eigen::MatrixXd m; std::span<const Time> times;
Eigen::Affine3d affine; Eigen::VectorXi whole; Time t; double dt = 0;
Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<2>> strided(x.data(), 3);
Eigen::Map<const Eigen::Vector3d, 0, Eigen::InnerStride<2>> strided3(x.data());
using Reference = Eigen::Ref<const Eigen::VectorXd>; using Reference3 = Eigen::Ref<const Eigen::Vector3d>;"""

# The form, and a part of the message. No two have vectors of the same type in the same place: the compiler reports such
# an error once.
FORMS = [
    ("(void)as_waypoint(t, f);", "give vectors of double; for float use .cast<double>()"),
    ("(void)as_waypoint(t, x, 2 * f);", "give vectors of double; for float use .cast<double>()"),
    ("(void)as_waypoint(t, m);", "m.col(i), m.row(i) or VectorXd; for a whole matrix use as_waypoints"),
    ("(void)as_waypoint(t, 1.0);", "give vectors of double, an Isometry3d or a Quaterniond"),
    ("(void)as_waypoint(t, affine);", "make an Isometry3d"),
    ("(void)as_waypoint(t, x, x, x, x);", "a position and, optionally, a velocity and an acceleration"),
    ("(void)as_waypoint(t);", "give a time, a position and"),
    ("(void)as_waypoints(times, m * 2);", "store the expression or temporary in a variable"),
    ("(void)as_waypoints(times, Eigen::MatrixXd(m));", "store the expression or temporary in a variable"),
    ("(void)as_waypoints(times, m.cast<float>());", "for float store .cast<double>() in a variable"),
    ("(void)as_span(x + x);", "use as_waypoint(t, ...) of splinecast/eigen.hpp, which copies it"),
    ("(void)as_span(m.row(0));", "use as_waypoint(t, ...) of splinecast/eigen.hpp, which copies it"),
    ("(void)as_span(strided);", "use as_waypoint(t, ...) of splinecast/eigen.hpp, which copies it"),
    ("(void)as_span(Reference(x));", "use as_waypoint(t, ...) of splinecast/eigen.hpp, which copies it"),
    ("(void)as_span(m);", "give a vector, one column or one row: m.col(i)"),
    ("(void)Waypoint{.time = t, .position = x + x * dt};", "use as_waypoint(t, ...)"),
    ("(void)Waypoint{.time = t, .position = Eigen::VectorXd(x)};", "use as_waypoint(t, ...)"),
    ("(void)Waypoint{.time = t, .position = strided3};", "use as_waypoint(t, ...)"),
    ("(void)Waypoint{.time = t, .position = Reference3(x)};", "use as_waypoint(t, ...)"),
    ("(void)Waypoint{.time = t, .position = whole};", "as_waypoint(t, x.cast<double>())"),
]


def main():
    compiler, *includes = sys.argv[1:]
    # One template per form, so that each has an instance of its own.
    text = ["#include <splinecast/eigen.hpp>", "using namespace splinecast;"]
    lines = {}
    for i, (form, _) in enumerate(FORMS):
        text.append(f"void form_{i}() {{ {' '.join(VALUES.split())}")
        text.append(form)
        lines[len(text)] = i
        text.append("}")
    words = [compiler, "-std=c++20", "-fsyntax-only", "-w", "-x", "c++", "-"]
    words += [f"-isystem{folder}" if "eigen3" in folder else f"-I{folder}" for folder in includes]
    ended = subprocess.run(words, input="\n".join(text), capture_output=True, text=True, check=False)
    # Each instance prints the line of the form that needs it before the error.
    broken, line, found = [], None, {}
    for printed in ended.stderr.splitlines():
        required = re.match(r"<stdin>:(\d+):\d+:\s+required from", printed)
        if required:
            line = int(required[1])
        error = re.search(r"error: (.*)", printed)
        if error:
            found.setdefault(lines.get(line), []).append(error[1])
    for i, (form, sentence) in enumerate(FORMS):
        errors = found.get(i, [])
        if len(errors) != 1 or sentence not in errors[0]:
            broken.append(f"{form}\n  expected one error with: {sentence}\n  found: {errors}")
    print("\n".join(broken) or f"{len(FORMS)} wrong forms, each with one error")
    sys.exit(bool(broken))


main()

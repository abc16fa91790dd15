#!/usr/bin/env python3
"""For users of SciPy: fits, compares with scipy.interpolate, and looks for the peaks of a motion.

    4_scipy.py [--plot FILE]

Needs no stream, no solver and no other process.
"""

import argparse

import numpy as np
from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator

import splinecast

# %% Waypoints: times [s] as floats, positions of two joints.
random = np.random.default_rng(7)
times = np.cumsum(random.uniform(0.05, 0.2, 12))
positions = np.column_stack([np.sin(3 * times), np.cos(2 * times)])

# %% The same curves as SciPy's. `nu` is the derivative, as in SciPy.
at = np.linspace(times[0], times[-1], 1001)
peers = {
    "natural": (splinecast.fit(times, positions, start="natural", end="natural"),
                CubicSpline(times, positions, bc_type="natural")),
    "clamped": (splinecast.fit(times, positions, start="clamped", end="clamped"),
                CubicSpline(times, positions, bc_type="clamped")),
    "not-a-knot": (splinecast.fit(times, positions, start="not-a-knot", end="not-a-knot"),
                   CubicSpline(times, positions)),
    "akima": (splinecast.fit(times, positions, method="akima"), Akima1DInterpolator(times, positions)),
    "pchip": (splinecast.fit(times, positions, method="pchip"), PchipInterpolator(times, positions)),
}
for name, (curve, peer) in peers.items():
    difference = max(np.abs(curve(at, nu=nu) - peer(at, nu)).max() / np.abs(peer(at, nu)).max() for nu in range(3))
    print(f"{name:10} differs from SciPy by at most {difference:.0e} of the largest value"
          if difference > 1e-12 else f"{name:10} equals SciPy's to 1e-12")

# %% A curve is a PPoly too: integrate, find roots, differentiate.
curve = splinecast.fit(times, positions, start="halt", end="halt")
spline = curve.to_ppoly()
largest = np.abs(curve(at)).max()
print(f"PPoly equals the curve to 1e-13: {np.abs(spline(at) - curve(at)).max() <= 1e-13 * largest}")
print(f"mean position: {spline.integrate(times[0], times[-1]) / (times[-1] - times[0])}")

# %% Peaks against the limits of the machine: at the knots, and where the next derivative is 0.
LIMITS = {"velocity": 3.0, "acceleration": 40.0}
for nu, (name, limit) in enumerate(LIMITS.items(), start=1):
    derivative = spline.derivative(nu)
    for joint, roots in enumerate(spline.derivative(nu + 1).roots(extrapolate=False)):
        places = np.concatenate([spline.x, roots[np.isfinite(roots)]])
        values = np.abs(derivative(places)[:, joint])
        worst = values.argmax()
        verdict = "within" if values[worst] <= limit else "beyond"
        print(f"largest {name} of q{joint + 1}: {values[worst]:.2f} at {places[worst]:.3f} s, "
              f"{verdict} the limit of {limit:g}")


# %% Draw it.
def draw(path):
    """Draws the positions and velocities of both joints."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (above, below) = plt.subplots(2, 1, sharex=True, constrained_layout=True)
    above.plot(at, curve(at))
    above.plot(times, positions, "k.")
    above.set_ylabel("position [rad]")
    below.plot(at, curve(at, nu=1))
    below.axhline(LIMITS["velocity"], color="k", ls=":")
    below.axhline(-LIMITS["velocity"], color="k", ls=":")
    below.set_ylabel("velocity [rad/s]")
    below.set_xlabel("time [s]")
    figure.savefig(path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plot")
    plot = parser.parse_args().plot
    if plot:
        draw(plot)

"""Laws of the first stick, for the unit tests of the stick phase: of the scene of the paper under
weak noise, and at a bent threshold.

    python3 tests/reference/first_stick.py

Needs numpy. The reference is the Volterra equation of the second kind for the first-passage density
of Brownian motion to a moving boundary a(s) (Buonocore, Nobile and Ricciardi, Adv. Appl. Probab.
19, 1987),

    p(s) = (a(s)/s - a'(s)) f(a(s), s)
           + int_0^s (a'(s) - (a(s) - a(r))/(s - r)) f(a(s) - a(r), s - r) p(r) dr,

after Doob's change of time, by the trapezoidal rule. Its error falls like N^{-3/2} and is removed
by extrapolation. Only the nearer threshold counts, because the other is more than 14 standard
deviations away. A backward Kolmogorov equation on a grid would have to resolve a density of width
0.05 here.
"""

import numpy as np


def density(threshold, slope, theta, t0, t1, n):
    """Times, their spacing, and the density of the first time at which v with dv = -theta v dt +
    dW, v(0) = 0, meets threshold(t)."""
    t, dt = np.linspace(t0, t1, n + 1, retstep=True)
    u, du = threshold(t), slope(t)
    s, rate = (np.exp(2 * theta * t) - 1) / (2 * theta), np.exp(2 * theta * t)
    a, da = np.exp(theta * t) * u, np.exp(-theta * t) * (theta * u + du)

    def f(x, s):
        return np.exp(-x * x / (2 * s)) / np.sqrt(2 * np.pi * s)

    p = np.zeros(n + 1)
    for i in range(n + 1):
        if s[i] == 0:
            continue  # the threshold does not begin at the start of the path
        p[i] = (a[i] / s[i] - da[i]) * f(a[i], s[i])
        if i > 0:
            gap = s[i] - s[:i]
            kernel = (da[i] - (a[i] - a[:i]) / gap) * f(a[i] - a[:i], gap)
            p[i] += dt * np.sum(rate[:i] * p[:i] * kernel)
    return t, dt, p * rate


def extrapolated(of, n):
    coarse, fine = of(n), of(2 * n)
    return fine + (fine - coarse) / (2**1.5 - 1)


def feeble(rho, t0, t1, n):
    """Mean and standard deviation of the first stick of the scene of the paper under weak noise."""
    t, _, q = density(
        lambda t: (6 * np.cos(t / 4) - 4.8) / (6 * rho),
        lambda t: -1.5 * np.sin(t / 4) / (6 * rho),
        1,
        t0,
        t1,
        n,
    )
    mean, square = (np.trapezoid(q * t**k, t) / np.trapezoid(q, t) for k in (1, 2))
    return np.array([mean, np.sqrt(square - mean * mean)])


def bent(n):
    """A threshold 1 + 100 (1 - cos((t - 2.5)/10)), whose curvature at its minimum is 1, with theta
    = 0.0354: the probability to leave before t = 8, and the mean time of the paths that do."""
    threshold, slope = (
        lambda t: 1 + 100 * (1 - np.cos((t - 2.5) / 10)),
        lambda t: 10 * np.sin((t - 2.5) / 10),
    )
    t, _, q = density(threshold, slope, 0.0354, 0, 8, n)
    return np.array([np.trapezoid(q, t), np.trapezoid(q * t, t) / np.trapezoid(q, t)])


for rho, t0, t1 in [(0.01, 2.0, 3.2), (0.02, 1.6, 3.5)]:
    print(rho, extrapolated(lambda n: feeble(rho, t0, t1, n), 4000))
for n in (2000, 4000):
    print("bent", n, extrapolated(bent, n))

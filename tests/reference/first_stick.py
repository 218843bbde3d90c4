"""Mean and sd of the first stick of the paper's scene under feeble noise, for the unit tests of the stick phase.

    python3 tests/reference/first_stick.py

Needs numpy. Oracle: the Volterra equation of the second kind for the first-passage density of Brownian motion to a
moving boundary a(s) (Buonocore, Nobile and Ricciardi, Adv. Appl. Probab. 19, 1987),

    p(s) = (a(s)/s - a'(s)) f(a(s), s) + int_0^s (a'(s) - (a(s) - a(r))/(s - r)) f(a(s) - a(r), s - r) p(r) dr,

after Doob's time change, by the trapezoidal rule; its error falls like N^{-3/2} and is extrapolated away. Only the
nearer threshold counts: the other is more than 14 standard deviations away. A backward Kolmogorov equation on a grid has to resolve
a density of width 0.05 here.
"""
import numpy as np


def moments(rho, t0, t1, n):
    t, dt = np.linspace(t0, t1, n + 1, retstep=True)
    threshold = (6 * np.cos(t / 4) - 4.8) / (6 * rho)
    slope = -1.5 * np.sin(t / 4) / (6 * rho)
    s, rate = (np.exp(2 * t) - 1) / 2, np.exp(2 * t)
    a, da = np.exp(t) * threshold, np.exp(-t) * (threshold + slope)

    def f(x, s):
        return np.exp(-x * x / (2 * s)) / np.sqrt(2 * np.pi * s)

    p = np.zeros(n + 1)
    for i in range(n + 1):
        p[i] = (a[i] / s[i] - da[i]) * f(a[i], s[i])
        if i > 0:
            gap = s[i] - s[:i]
            kernel = (da[i] - (a[i] - a[:i]) / gap) * f(a[i] - a[:i], gap)
            p[i] += dt * np.sum(rate[:i] * p[:i] * kernel)
    q = p * rate
    mean, square = (np.trapezoid(q * t**k, t) / np.trapezoid(q, t) for k in (1, 2))
    return np.array([mean, np.sqrt(square - mean * mean)])


for rho, t0, t1 in [(0.01, 2.0, 3.2), (0.02, 1.6, 3.5)]:
    coarse, fine = moments(rho, t0, t1, 4000), moments(rho, t0, t1, 8000)
    print(rho, fine + (fine - coarse) / (2**1.5 - 1))

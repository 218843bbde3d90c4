"""Mean time at which a Brownian bridge that starts near a bent threshold first meets it, for the
unit tests of the stick step.

    python3 tests/reference/bent_bridge.py

Needs numpy. The bridge goes from 0 to 0 over [0, 1], and the threshold is a(s) = d0 (1 - s) + d1 s
- bent s (1 - s)/2. The reference is the Volterra equation of first_stick.py for Brownian motion,
whose density at s is then weighted with the probability to end at 0 from there. A grid that is
quadratic near 0 resolves the times d0^2.
"""

import numpy as np


def f(x, s):
    return np.exp(-x * x / (2 * s)) / np.sqrt(2 * np.pi * s)


def mean(d0, d1, bent, n):
    q = np.linspace(0, 1, n + 1)[1:-1]
    s, rate = q * q, 2 * q
    a, da = d0 * (1 - s) + d1 * s - bent * s * (1 - s) / 2, d1 - d0 - bent * (1 - 2 * s) / 2
    p = np.zeros(n - 1)
    for i in range(n - 1):
        gap, rise = s[i] - s[:i], a[i] - a[:i]
        kernel = (da[i] - rise / gap) * f(rise, gap)
        p[i] = (a[i] / s[i] - da[i]) * f(a[i], s[i]) + np.sum(rate[:i] * p[:i] * kernel) / n
    weight = rate * p * f(a, 1 - s)
    return np.sum(weight * s) / np.sum(weight)


for d1 in (-1, 0.5):
    for bent in (0.8, -0.8):
        print(d1, bent, mean(0.1, d1, bent, 2000), mean(0.1, d1, bent, 4000))

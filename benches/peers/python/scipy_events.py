"""One path of the scenario `duffing` without noise, with events of SciPy: ms per path, sticks, x.

Compare with `mc run duffing --set temperature.noise.intensity=0 --paths 1`, whose x at the end is
3.790017641, and with the time of a path with noise. With rtol = 1e-10 two sticks are missed.
"""
import math
import time

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

F_S, F_D, END = 1.2, 1.0, 155.0


def force(t, x):
    return 6.0 * math.cos(0.25 * t) - x - 0.02 * x**3


def stopped(t, state, eps):
    return eps * state[1]


stopped.terminal, stopped.direction = True, -1


def path():
    t, x, sticks = 0.0, 4.0, 0
    while True:
        grid = np.arange(t, END, 0.05)
        out = [s for s in grid if abs(force(s, x)) > F_S]
        if not out:
            return sticks, x
        if out[0] > t:
            sticks += 1
            t = brentq(lambda s: abs(force(s, x)) - F_S, out[0] - 0.05, out[0], xtol=1e-13)
        eps = math.copysign(1.0, force(t, x))
        slip = solve_ivp(
            lambda s, y, eps: [y[1], force(s, y[0]) - eps * F_D],
            (t, END),
            [x, 0.0],
            method="DOP853",
            events=stopped,
            args=(eps,),
            rtol=1e-13,
            atol=1e-15,
            first_step=1e-3,
        )
        t, x = slip.t[-1], slip.y[0][-1]
        if slip.status == 0:
            return sticks, x


begun, runs = time.process_time(), 0
while time.process_time() - begun < 2.0:
    result = path()
    runs += 1
print(f"{1e3 * (time.process_time() - begun) / runs:.2f} ms per path, {result[0]} sticks, x = {result[1]:.9f}")

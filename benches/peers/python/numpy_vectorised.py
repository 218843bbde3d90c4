"""NumPy: array operations over all paths, with boolean masks for the events. Runs on one thread."""

import numpy as np

import scene as s
from scene import paths, h

draw = np.random.Generator(np.random.SFC64(1))  # the fastest generator of NumPy
x, v, e = np.full(paths, s.x0), np.zeros(paths), np.zeros(paths)
b = s.beta * np.ones(paths) - x
stuck = np.abs(b) <= s.f_s
entry, sticks, stick_steps, turns = (np.zeros(paths) for _ in range(4))
xi = np.empty(paths)
forcing = s.beta * np.cos(s.w * h * np.arange(s.steps + 1))

watch = s.Watch()
for n in range(s.steps):
    S = v + h * b
    v_next = np.where(np.abs(S) <= h * s.f_s, 0.0, S - np.copysign(h * s.f_d, S))
    x += h * v
    draw.standard_normal(out=xi)
    xi *= s.kick
    e *= s.decay
    e += xi
    b = s.beta * s.rho * e
    b -= x
    b += forcing[n + 1]

    zero = v_next == 0
    leaves = np.flatnonzero(stuck & ~zero)
    enters = np.flatnonzero(~stuck & zero & (np.abs(b) <= s.f_s))
    turned = np.flatnonzero(~stuck & (v * v_next <= 0) & (v != 0))
    if leaves.size:
        stuck[leaves] = False
        counted = leaves[entry[leaves] > 0]
        sticks[counted] += 1
        stick_steps[counted] += n - entry[counted]
    if turned.size:
        turns[turned] += 1
    if enters.size:
        turns[enters] -= v[enters] != 0  # a zero that became a stick is not a turn
        stuck[enters] = True
        entry[enters] = n + 1
    v = v_next
watch.stop()
watch.report(x, sticks, stick_steps * h, turns)

"""Numba: the scalar loop under @njit(parallel=True) with Numba's own normals, as in its manual."""

import math
import time

import numba
import numpy as np

import scene as s

beta, rho, f_s, f_d, x0, h, decay, kick = s.beta, s.rho, s.f_s, s.f_d, s.x0, s.h, s.decay, s.kick
numba.set_num_threads(s.threads)


@numba.njit(parallel=True)
def run(forcing, results):
    paths, chunks = results.shape[1], 64
    for chunk in numba.prange(chunks):
        np.random.seed(chunk)
        for path in range(chunk * paths // chunks, (chunk + 1) * paths // chunks):
            x, v, e, b = x0, 0.0, 0.0, forcing[0] - x0
            stuck, entry = abs(b) <= f_s, 0
            sticks, stick_steps, turns = 0, 0, 0
            for n in range(forcing.size - 1):
                S = v + h * b
                v_next = 0.0 if abs(S) <= h * f_s else S - math.copysign(h * f_d, S)
                x += h * v
                e = decay * e + kick * np.random.standard_normal()
                b = forcing[n + 1] + beta * rho * e - x
                if stuck:
                    if v_next != 0:
                        stuck = False
                        if entry > 0:
                            sticks += 1
                            stick_steps += n - entry
                elif v_next == 0 and abs(b) <= f_s:
                    stuck, entry = True, n + 1
                elif v * v_next <= 0 and v != 0:
                    turns += 1
                v = v_next
            results[0, path], results[1, path], results[2, path], results[3, path] = (
                x,
                sticks,
                stick_steps,
                turns,
            )


forcing = s.beta * np.cos(s.w * s.h * np.arange(s.steps + 1))
results = np.empty((4, s.paths))
start = time.perf_counter()
run(forcing[:2], results)
setup = time.perf_counter() - start

watch = s.Watch()
run(forcing, results)
watch.stop()
x, sticks, stick_steps, turns = results
watch.report(x, sticks, stick_steps * s.h, turns, setup)

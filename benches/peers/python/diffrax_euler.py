"""diffrax: the scheme as a drift for its Euler solver at constant steps, the counters as further
components, and jax.vmap over paths.

Option: `unsafe` (UnsafeBrownianPath, the fastest) or `tree` (VirtualBrownianTree, which its manual
recommends).

A solver of this kind takes a drift f(t, y) and computes y + h f itself. So the change by the scheme
in one step is divided by h first, and Euler's e + h(-e) + dW takes the place of the exact
transition of the noise. With eight components instead of nine (without the completed slips) XLA's
code runs three times slower. A stick is entered where |b_n| instead of |b_{n+1}| is within f_s,
because the drift does not know the end of its own step.
"""

import time

import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)
import diffrax  # noqa: E402, after the precision is chosen

import scene as s  # noqa: E402
from scene import h  # noqa: E402

end = s.steps * h
noise_enters_e = jnp.zeros(9).at[2].set(1.0)


def drift(t, y, _):
    x, v, e, stuck, entry, sticks, stick_time, turns, slips = y
    b = s.beta * (jnp.cos(s.w * t) + s.rho * e) - x
    S = v + h * b
    v_next = jnp.where(jnp.abs(S) <= h * s.f_s, 0, S - h * s.f_d * jnp.sign(S))
    still, zero = stuck > 0.5, v_next == 0
    leaves = still & ~zero
    counted = leaves & (entry > h / 2)
    enters = ~still & zero & (jnp.abs(b) <= s.f_s)
    turned = (
        ~still & ~enters & (v * v_next <= 0) & (jnp.abs(v) > 1e-12)
    )  # v + h (0 - v)/h is zero only up to rounding
    return jnp.array(
        [
            v,
            (v_next - v) / h,
            -e,
            jnp.where(enters, 1 - stuck, jnp.where(leaves, -stuck, 0)) / h,
            jnp.where(enters, t + h - entry, 0) / h,
            counted / h,
            jnp.where(counted, t - entry, 0) / h,
            turned / h,
            enters / h,
        ]
    )


def solve(key):
    if s.option == "tree":
        brownian = diffrax.VirtualBrownianTree(0.0, end, tol=h / 2, shape=(), key=key)
    else:
        brownian = diffrax.UnsafeBrownianPath(shape=(), key=key)
    noise = diffrax.ControlTerm(lambda t, y, _: noise_enters_e, brownian)
    start = jnp.zeros(9).at[0].set(s.x0).at[3].set(1.0)
    adjoint = diffrax.ForwardMode() if s.option == "tree" else diffrax.DirectAdjoint()
    return diffrax.diffeqsolve(
        diffrax.MultiTerm(diffrax.ODETerm(drift), noise),
        diffrax.Euler(),
        0.0,
        end,
        h,
        start,
        saveat=diffrax.SaveAt(t1=True),
        max_steps=s.steps + 16,
        adjoint=adjoint,
        throw=False,
    ).ys[0]


keys = jax.random.split(jax.random.key(1), s.paths)
start = time.perf_counter()
run = jax.jit(jax.vmap(solve)).lower(keys).compile()
setup = time.perf_counter() - start

watch = s.Watch()
y = jax.block_until_ready(run(keys))
watch.stop()
watch.report(y[:, 0], jnp.round(y[:, 5]), y[:, 6], jnp.round(y[:, 7]), setup)

"""JAX: lax.fori_loop over the steps, arrays over the paths, its default generator.

Option: f32 or f64.
"""

import time

import jax
import jax.numpy as jnp

import scene as s
from scene import h, paths

jax.config.update("jax_enable_x64", s.option == "f64")
real = jnp.dtype("float64" if s.option == "f64" else "float32").type


def step(n, state):
    key, x, v, e, b, stuck, entry, sticks, stick_steps, turns = state
    S = v + h * b
    v_next = jnp.where(jnp.abs(S) <= h * s.f_s, 0, S - h * s.f_d * jnp.sign(S))
    x = x + h * v
    e = s.decay * e + s.kick * jax.random.normal(jax.random.fold_in(key, n), (paths,), real)
    b = s.beta * jnp.cos(s.w * h * (n + 1)).astype(real) + s.beta * s.rho * e - x

    zero = v_next == 0
    leaves = stuck & ~zero
    counted = leaves & (entry > 0)
    enters = ~stuck & zero & (jnp.abs(b) <= s.f_s)
    turned = ~stuck & ~enters & (v * v_next <= 0) & (v != 0)
    return (
        key,
        x,
        v_next,
        e,
        b,
        (stuck & zero) | enters,
        jnp.where(enters, n + 1, entry),
        sticks + counted,
        stick_steps + jnp.where(counted, n - entry, 0),
        turns + turned,
    )


@jax.jit
def run(steps):
    zeros, none = jnp.zeros(paths, real), jnp.zeros(paths, jnp.int32)
    x, b = jnp.full(paths, s.x0, real), zeros + (s.beta - s.x0)
    state = (jax.random.key(1), x, zeros, zeros, b, jnp.abs(b) <= s.f_s, none, none, none, none)
    return jax.lax.fori_loop(jnp.int32(0), steps, step, state)


start = time.perf_counter()
jax.block_until_ready(run(jnp.int32(1)))
setup = time.perf_counter() - start

watch = s.Watch()
state = jax.block_until_ready(run(jnp.int32(s.steps)))
watch.stop()
watch.report(state[1], state[7], state[8] * h, state[9], setup)

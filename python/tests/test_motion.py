"""Friction that is fitted to a measured motion, with the cells of examples/motion.ipynb."""

from __future__ import annotations

import numpy as np
import pytest
import stickslip as ss
from conftest import ROOT

pytestmark = pytest.mark.filterwarnings("ignore:overflow")


def integrate(body, force, times, h=1e-4):
    """Displacement of a body by RK4 in steps of h, which are cut where it comes to rest. It shares
    nothing with the engine."""
    m, stiffness, alpha, f_s, f_d, x = body
    t, v, side = 0.0, 0.0, 0

    def rk4(t, x, v, h):
        def rate(t, x, v):
            return (force(t) - stiffness * x - 2 * alpha * v - side * f_d) / m

        a = rate(t, x, v)
        b = rate(t + h / 2, x + h / 2 * v, v + h / 2 * a)
        c = rate(t + h / 2, x + h / 2 * v + h * h / 4 * a, v + h / 2 * b)
        d = rate(t + h, x + h * v + h * h / 2 * b, v + h * c)
        return x + h * v + h * h / 6 * (a + b + c), v + h / 6 * (a + 2 * b + 2 * c + d)

    out = []
    for end in times:
        while t < end:
            step = min(h, end - t)
            drive = force(t) - stiffness * x
            if side == 0 and abs(drive) <= f_s:
                t = t + step if step == h else end
                continue
            side = side or (1 if drive > 0 else -1)
            far, fast = rk4(t, x, v, step)
            if fast * side < 0:
                step *= v / (v - fast)
                far, _ = rk4(t, x, v, step)
                fast, side = 0.0, 0
            t, x, v = t + step, far, fast
        out.append(x)
        t = end
    return np.array(out)


@pytest.fixture(scope="module")
def cells():
    """The definitions of the notebook."""
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("scipy")
    notebook = nbformat.read(ROOT / "examples/motion.ipynb", as_version=4)
    names = {}
    for cell in notebook.cells[:-1]:
        if cell.cell_type == "code":
            exec(cell.source, names)
    return names


def linear(times, values):
    """A function that is linear between samples with a constant step."""
    values, step = values.tolist(), times[1]

    def at(t):
        k = min(int(t / step), len(values) - 2)
        return values[k] + (t / step - k) * (values[k + 1] - values[k])

    return at


def clean(cells, kind):
    """The record of a kind without noise, by the plain integrator."""
    _, times, _, truth, *_ = cells["KINDS"][kind]
    if kind == "decay":
        stiffness, alpha, f = truth
        return integrate((1, stiffness, alpha, f, f, 0.5), lambda t: 0.0, times)
    if kind == "base":
        f_d, excess = truth
        force = linear(times, -cells["acceleration"])
        return integrate((1, 0, 0, f_d * (1 + excess), f_d, 0), force, times)
    m, alpha, f_d, excess = truth
    force = linear(times, cells["torque"])
    return integrate((m, 0, alpha, f_d * (1 + excess), f_d, 0), force, times)


@pytest.mark.parametrize(("kind", "bound"), [("decay", 1e-7), ("base", 1e-4), ("joint", 1e-4)])
def test_a_motion_is_that_of_a_plain_integrator(cells, kind, bound):
    """The integrator starts a slip up to a step of 1e-4 late, a decay has none."""
    motion, times, settings, truth, *_ = cells["KINDS"][kind]
    assert np.abs(motion.at(times, settings(*truth))[0] - clean(cells, kind)).max() < bound


@pytest.mark.parametrize("kind", ["decay", "base", "joint"])
def test_intervals_of_95_percent_hold_the_true_values(cells, kind):
    """20 records a kind. If the intervals hold 95 %, fewer than 16 of 20 for a parameter has a
    probability of 0.003, and some of the nine of 2 %."""
    record = clean(cells, kind)
    held = np.sum([cells["held"](kind, record, seed) for seed in range(20)], axis=0)
    print(kind, held)
    assert (held >= 16).all(), held


def test_a_velocity_is_the_slope_of_the_displacement():
    motion = ss.Motion("rho025", scheme="event-driven", path=3)
    times = np.linspace(0, 60, 600_001)
    x, v = motion.at(times)
    assert np.abs(np.diff(x) / np.diff(times) - (v[1:] + v[:-1]) / 2).max() < 0.02
    ds = ss.run("rho025", scheme="event-driven", paths=4, record={"trajectories": 4})
    row = ds.trajectory_displacement.isel(trajectory=3)
    same = motion.at(ds.time.values)[0] - row.values
    assert np.abs(same).max() < 1e-6


def test_a_motion_refuses_what_it_cannot_compute():
    motion = ss.Motion("shaw", until=10)
    with pytest.raises(ss.ArgumentError, match="must be between 0 and 10"):
        motion.at([1.0, 11.0])
    with pytest.raises(ss.ScenarioError, match=r"friction\.dynamic"):
        motion.at([1.0], {"friction.dynamic": -1.0})
    with pytest.raises(ss.ArgumentError, match="path"):
        ss.Motion("shaw", path=-1)


@pytest.mark.parametrize("scheme", ["discrete-vi", "corrected-vi", "event-driven"])
def test_a_motion_is_that_of_the_rows_of_a_replay(scheme):
    """Sticks included, where the velocity is 0. The events of a noiseless path have all digits, and
    rows of the scheme without a step are off by the polynomial between them."""
    replay = ss.replay(ss.run("shaw", scheme=scheme, paths=1), 0)
    x, v = ss.Motion("shaw", scheme=scheme).at(replay.time.values)
    assert np.abs(x - replay.trajectory_displacement.values[0]).max() < 1e-9
    assert np.abs(v - replay.trajectory_velocity.values[0]).max() < 1e-9
    assert 0.1 < np.mean(v == 0) < 0.2


def test_a_body_that_never_moves_is_at_rest():
    x, v = ss.Motion("never-slips", until=10).at([0, 5, 10])
    assert (x == x[0]).all() and (v == 0).all()

"""Realisations that the caller gives or draws, one for each path."""

import numpy as np
import pytest
import stickslip as ss
import xarray as xr

BLOCK = """
oscillator = { mass = 1, stiffness = 0, force_per_temperature = 1 }
friction = { static = 1, dynamic = 1 }
temperature.harmonics = []
initial.displacement = 0
time.end = 10
force.expression = "k"
scheme.kind = "event-driven"
record.trajectories = 8
"""
TIMES = np.linspace(0, 10, 201)


def sheets(count=8):
    rng = np.random.default_rng(5)
    return 3 * rng.normal(size=(count, 1)) * np.sin(TIMES)


def ends(ds):
    return ds["path_displacement_end"].to_numpy()


def test_each_path_takes_its_row():
    """Path n moves as the only path of a run with that row does."""
    values = sheets()
    together = ends(ss.run(BLOCK, paths=8, inputs={"k": (TIMES, values)}))
    alone = [ends(ss.run(BLOCK, paths=1, inputs={"k": (TIMES, row)}))[0] for row in values]
    assert np.abs(together).max() > 1
    np.testing.assert_allclose(together, alone, atol=1e-9)


def test_xarray_with_a_dimension_path_is_the_same():
    values = sheets()
    array = xr.DataArray(values.T, dims=("time", "path"), coords={"time": TIMES})
    one = ends(ss.run(BLOCK, paths=8, inputs={"k": array}))
    two = ends(ss.run(BLOCK, paths=8, inputs={"k": (TIMES, values)}))
    np.testing.assert_array_equal(one, two)


def test_a_function_draws_once_per_path_whatever_the_threads():
    def draw(rng, t):
        return 3 * rng.normal() * np.sin(t)

    runs = [
        ends(ss.run(BLOCK, paths=600, threads=threads, inputs={"k": (TIMES, draw)}))
        for threads in (1, 2)
    ]
    np.testing.assert_array_equal(*runs)
    assert len(np.unique(runs[0].round(12))) > 300
    other = ends(ss.run(BLOCK, paths=600, seed=2, inputs={"k": (TIMES, draw)}))
    assert (other != runs[0]).mean() > 0.5


def test_the_temperature_may_be_drawn():
    scene = BLOCK.replace('force.expression = "k"\n', "")
    values = sheets()
    by_temperature = ends(ss.run(scene, paths=8, temperature=(TIMES, values)))
    by_input = ends(ss.run(BLOCK, paths=8, inputs={"k": (TIMES, values)}))
    np.testing.assert_allclose(by_temperature, by_input, atol=1e-9)


def test_fewer_realisations_than_paths_are_refused():
    with pytest.raises(ss.ArgumentError, match="paths=8"):
        ss.run(BLOCK, paths=9, inputs={"k": (TIMES, sheets())})


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ss.ArgumentError, match=r"\(paths, time\)"):
        ss.run(BLOCK, paths=3, inputs={"k": (TIMES, np.ones((3, 7)))})

"""Runs the command beside the package: the package must return what the command writes."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCENARIOS = ROOT / "scenarios"


@pytest.fixture
def mc(tmp_path):
    """Run the command; returns standard output and standard error."""
    command = os.environ.get("MC", str(ROOT / "target/release/mc"))

    def call(*arguments, succeeds=True):
        done = subprocess.run(
            [command, *map(str, arguments)], capture_output=True, text=True, cwd=tmp_path
        )
        assert (done.returncode == 0) == succeeds, done.stderr
        return done.stdout, done.stderr

    return call


def bits(values):
    """Numbers as their bytes, so that NaN and the last digit are compared too."""
    return (
        values.astype(str).tolist()
        if values.dtype.kind in "UOT"
        else (str(values.dtype), values.tobytes())
    )


def same(mine, theirs, but=()):
    """Two data sets agree in every name, dimension, attribute, coordinate and bit, except for some
    attributes or variables.

    The commits that they were built from may differ, because one may have been built before a
    commit that changed nothing in it.
    """
    import xarray as xr

    def compared(ds):
        kept = {name: value for name, value in ds.attrs.items() if name not in ("git_hash", *but)}
        return ds.drop_vars(but, errors="ignore").drop_attrs(deep=False).assign_attrs(kept)

    mine, theirs = compared(mine), compared(theirs.load())
    xr.testing.assert_identical(mine, theirs)
    assert set(mine.coords) == set(theirs.coords)
    assert mine.sizes == theirs.sizes
    for name, variable in theirs.variables.items():
        assert bits(mine[name].to_numpy()) == bits(variable.to_numpy()), name
        assert {k: type(v) for k, v in mine[name].attrs.items()} == {
            k: type(v) for k, v in variable.attrs.items()
        }, name
    assert {k: type(v) for k, v in mine.attrs.items()} == {
        k: type(v) for k, v in theirs.attrs.items()
    }

"""Recompute the estimates in a file of antithetic pairs from the columns of its paths.

usage: pairs.py FILE.h5

Paths 2k and 2k + 1 see the same noise with opposite signs, and the pair is the independent unit. So
the error of a mean is that of the means of pairs, and the error of a ratio that of the sums of
pairs (by the delta method). Computed with the path as the unit, the numbers must differ; otherwise
the file would test nothing.
"""

import math
import sys

import h5py
import numpy as np


def error_of_mean(values):
    return values.std(ddof=1) / math.sqrt(len(values))


def error_of_ratio(parts, wholes):
    rest = parts - parts.sum() / wholes.sum() * wholes
    return math.sqrt((rest**2).sum() * len(rest) / (len(rest) - 1)) / wholes.sum()


with h5py.File(sys.argv[1]) as file:
    assert file.attrs["antithetic"] == 1
    names = [name.decode() for name in file["statistic"][:]]
    told = dict(zip(names, file["standard_error"][:], strict=True))
    estimates = dict(zip(names, file["estimate"][:], strict=True))
    column = lambda name: file[f"path_{name}"][:].astype(float)
    end, sticks, slips, sub_phases, work = map(
        column, ["displacement_end", "sticks", "slips", "sub_phases", "friction_work"]
    )

pairs = lambda values: values.reshape(-1, 2).sum(axis=1)
for name, estimate, alone, paired in [
    ("displacement_end_mean", end.mean(), error_of_mean(end), error_of_mean(pairs(end) / 2)),
    ("sticks_per_path", sticks.mean(), error_of_mean(sticks), error_of_mean(pairs(sticks) / 2)),
    ("friction_work_mean", work.mean(), error_of_mean(work), error_of_mean(pairs(work) / 2)),
    (
        "sub_phases_mean",
        sub_phases.sum() / slips.sum(),
        error_of_ratio(sub_phases, slips),
        error_of_ratio(pairs(sub_phases), pairs(slips)),
    ),
]:
    assert math.isclose(estimates[name], estimate, rel_tol=1e-12), (name, estimates[name], estimate)
    assert math.isclose(told[name], paired, rel_tol=1e-9), (name, told[name], paired)
    print(f"{name}: {paired:.3g} with the pair for the unit, {alone:.3g} with the path")
    assert name == "sticks_per_path" or abs(paired / alone - 1) > 0.05, (
        f"{name}: the unit makes no difference"
    )

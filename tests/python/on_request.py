"""Recompute what a run measures on request from its events and its trajectories.

    target/venv/bin/python tests/python/on_request.py RUN.h5

RUN.h5 has the laws, densities, spectra, energies and levels of a run without a force of the user's
own, with the events and the trajectories of all its paths, none of which is lost. The program here
does not use the sums of the other one: it computes each number from all values at once, by its
definition, and the lags of the autocovariance one by one.

Exits with 1 at the first variable that is wrong, and names it.
"""

import sys
import tomllib

import h5py
import numpy as np

BATCHES, BLOCK = 32, 256

# The names of the laws in the file, by those of their statistics.
NAMES = {"slip_duration": "slip", "jump_abs": "jump", "jump_forward": "jump_forward", "jump_backward": "jump_backward", "recurrence_time": "recurrence"}


def same(name, got, wanted, within=1e-9):
    got, wanted = np.asarray(got, float), np.asarray(wanted, float)
    scale = np.maximum(np.abs(wanted), 1e-12 + 1e-3 * np.max(np.abs(wanted), initial=0.0))
    if got.shape != wanted.shape or not np.all(np.abs(got - wanted) <= within * scale):
        sys.exit(f"{name}: {got} in the file, {wanted} recomputed")
    print(f"{name:40} ok")


def phases(data, after):
    """For each path, the values of every law, as pairs of (values, censored)."""
    counts = data["event_count"][:]
    ends = np.cumsum(counts)
    time, x, kind = (data[f"event_{name}"][:] for name in ("time", "displacement", "kind"))
    end = data["time"][-1]
    for stop, count in zip(ends, counts):
        of = slice(stop - count, stop)
        laws = {name: ([], []) for name in NAMES}
        jumps, slip, start = [], None, None
        for t, y, what in zip(time[of], x[of], kind[of]):
            if what == 1:
                if start is not None and start >= after:
                    laws["recurrence_time"][0].append(t - start)
                slip = start = t
                origin = y
            elif what == 0:
                if slip is not None and slip >= after:
                    jump = y - origin
                    jumps.append(jump)
                    laws["slip_duration"][0].append(t - slip)
                    laws["jump_abs"][0].append(abs(jump))
                    if jump != 0:
                        laws["jump_forward" if jump > 0 else "jump_backward"][0].append(abs(jump))
                slip = None
        if slip is not None and slip >= after:
            laws["slip_duration"][1].append(end - slip)
        if start is not None and start >= after:
            laws["recurrence_time"][1].append(end - start)
        yield laws, jumps


def kaplan_meier(values, censored, edges):
    """P(D > edge)."""
    surviving, curve = 1.0, []
    ordered = sorted([(v, 0) for v in values] + [(c, 1) for c in censored])
    at_risk, i = len(ordered), 0
    for edge in edges:
        while i < len(ordered) and ordered[i][0] < edge:
            if ordered[i][1] == 0:
                surviving *= (at_risk - 1) / at_risk
            at_risk -= 1
            i += 1
        curve.append(surviving)
    return curve


def check_laws(data, statistic, after):
    paths = list(phases(data, after))
    jumps = np.array([jump for _, jumps in paths for jump in jumps])
    for law in NAMES:
        values = np.array([v for laws, _ in paths for v in laws[law][0]])
        censored = np.array([c for laws, _ in paths for c in laws[law][1]])
        row = [name.decode() for name in data["law"][:]].index(NAMES[law])
        of = {name: data[f"law_{name}"][row] for name in ("completed", "censored", "lower", "upper", "count", "survival")}
        same(f"{law}_completed", of["completed"], len(values))
        same(f"{law}_censored", of["censored"], len(censored))
        bins = np.isfinite(of["upper"])
        lower, upper = of["lower"][bins], of["upper"][bins]
        count = [np.sum((lo <= values) & (values < hi)) for lo, hi in zip(lower, upper)]
        same(f"{law}_count", of["count"][bins], count)
        # The file counts values that share a fine bin, of 1/256 of an octave, as ties.
        off = np.abs(of["survival"][bins] - kaplan_meier(values, censored, upper))
        if off.max() > 3e-4:
            sys.exit(f"{law}_survival: off by {off.max()}")
        if law in ("slip_duration", "jump_abs", "recurrence_time"):
            sd = np.std(values)
            for name, number in (("sd", sd), ("cv", sd / values.mean())):
                same(f"{law}_{name}", statistic(f"{law}_{name}"), number)
            low, high = np.quantile(values, [0.499, 0.501])
            if not low <= statistic(f"{law}_median") <= high:
                sys.exit(f"{law}_median: {statistic(f'{law}_median')} is not between {low} and {high}")
    same("jump_sd", statistic("jump_sd"), np.std(jumps))
    for law in ("slip_duration", "recurrence_time"):
        values = np.concatenate([laws[law][0] for laws, _ in paths])
        same(f"{law}_mean", statistic(f"{law}_mean"), values.mean())


def rests(data, after):
    """The time that each path is at rest from `after` on."""
    time, kind = data["event_time"][:], data["event_kind"][:]
    ends, end = np.cumsum(data["event_count"][:]), data["time"][-1]
    for stop, count, begins_static in zip(ends, data["event_count"][:], data["trajectory_static"][:, 0]):
        since, rest = (0.0 if begins_static == 1 else None), 0.0
        for t, what in zip(time[stop - count : stop], kind[stop - count : stop]):
            if what == 0:
                since = t
            elif what == 1 and since is not None:
                rest, since = rest + max(0.0, t - max(since, after)), None
        yield rest + (end - max(since, after) if since is not None else 0.0)


def near(name, shares, count, total):
    """Densities are of times along the motion. So many rows tell them at least as well as as many
    independent numbers would, whose shares of bins differ by sqrt(2 share/(pi total)) in the mean."""
    off, scatter = np.sum(np.abs(shares - count / total)), np.sum(np.sqrt(2 / np.pi * shares / total))
    print(f"{name}: {off:.4f} of the rows are in another bin, and {scatter:.4f} by chance")
    if off > scatter:
        sys.exit(f"{name} is not that of the rows")


def check_densities(data, x, v, is_static, rows, after):
    x, v, is_static = x[:, rows], v[:, rows], is_static[:, rows] == 1
    rest_share = np.mean(list(rests(data, after))) / (data["time"][-1] - after)
    same("rest_share", data["rest_share"][()], rest_share, 1e-7)
    for name, values, whole in (("displacement", x, 1.0), ("velocity", v[~is_static], 1.0 - rest_share)):
        lower, upper = data[f"{name}_bin_lower"][:], data[f"{name}_bin"][:]
        count, _ = np.histogram(values, np.append(lower, upper[-1]))
        shares = data[f"{name}_density"][:] * (upper - lower)
        same(f"integral of {name}_density", shares.sum(), whole, 1e-7)
        near(f"{name}_density", shares, count, x.size)
    edges = [np.append(data[f"joint_{axis}_bin_lower"][:], data[f"joint_{axis}_bin"][-1]) for axis in ("displacement", "velocity")]
    count, _, _ = np.histogram2d(x[~is_static], v[~is_static], edges)
    shares = data["joint_density"][:] * np.outer(np.diff(edges[0]), np.diff(edges[1]))
    same("integral of joint_density", shares.sum(), 1.0 - rest_share, 1e-7)
    near("joint_density", shares, count, x.size)


def check_spectrum(data, x, v, rows, spacing):
    """Periodograms of one tapered segment, which has all counted rows."""
    lags, w, length = data["lag"][:], data["frequency"][:], int(rows.sum())
    same("spectrum_segments", data["spectrum_segments"][()], 1)
    taper = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length)
    overlap = np.array([np.sum(taper[: length - l] * taper[l:]) for l in range(len(lags))])
    turn = np.exp(-1j * np.outer(np.arange(length) * spacing, w))
    for name, values in (("displacement", x), ("velocity", v)):
        powers, products, number = np.zeros(len(w)), np.zeros(len(lags)), 0
        for first in range(0, len(values), BLOCK):
            block = values[first : first + BLOCK, rows]
            y = taper * (block - block.mean(axis=0))
            powers += np.sum(np.abs(y @ turn) ** 2, axis=0)
            products += np.array([np.sum(y[:, : length - l] * y[:, l:]) for l in range(len(lags))])
            number += len(block) - 1
        covariance, spectrum = products / number / overlap, spacing * powers / number / overlap[0]
        same(f"{name}_autocovariance", data[f"{name}_autocovariance"][:], covariance)
        same(f"{name}_spectrum", data[f"{name}_spectrum"][:], spectrum)
        whole = (2 * np.sum(spectrum) - spectrum[0] - spectrum[-1]) * w[1] / (2 * np.pi)
        same(f"integral of {name}_spectrum", whole, covariance[0])


def check_passages(data, x, levels):
    """x is monotone between events, so the farthest point until a row is at an event or a row."""
    time, start = data["time"][:], x[0, 0]
    counts = data["event_count"][:]
    ends = np.cumsum(counts)
    when, where = data["event_time"][:], data["event_displacement"][:]
    below = np.zeros((len(levels), len(time)))
    largest = []
    for path, (stop, count) in enumerate(zip(ends, counts)):
        t = np.concatenate([when[stop - count : stop], time])
        far = np.abs(np.concatenate([where[stop - count : stop], x[path]]) - start)
        order = np.argsort(t, kind="stable")
        reached = np.maximum.accumulate(far[order])
        at_rows = reached[np.searchsorted(t[order], time, side="right") - 1]
        below += at_rows[None, :] < levels[:, None]
        largest.append(reached[-1])
    same("passage_survival", data["passage_survival"][:], below / len(counts))
    return np.array(largest)


def main(path):
    with h5py.File(path) as data:
        scenario = tomllib.loads(data.attrs["scenario"])
        names = [name.decode() for name in data["statistic"][:]]
        statistic = lambda name: data["estimate"][names.index(name)]
        after = scenario["statistics"]["after"]
        time = data["time"][:]
        rows = time >= after * (1 - 1e-9)
        x, v, is_static = (data[f"trajectory_{name}"][:] for name in ("displacement", "velocity", "static"))
        check_laws(data, statistic, after)
        check_densities(data, x, v, is_static, rows, after)
        check_spectrum(data, x, v, rows, time[1] - time[0])
        largest = check_passages(data, x, data["level"][:])
        same("largest_displacement_mean", statistic("largest_displacement_mean"), largest.mean())
        same("largest_displacement_sd", statistic("largest_displacement_sd"), np.std(largest, ddof=1))
        if statistic("largest_speed_mean") < np.abs(v).max(axis=1).mean():
            sys.exit("largest_speed_mean is below the speeds on the output grid")
        # Kinetic energy and that of the spring at the end of the burn-in, which is a row, and at the
        # end of the run.
        oscillator = scenario["oscillator"]
        stored = 0.5 * oscillator["mass"] * v**2 + 0.5 * oscillator["stiffness"] * x**2
        same("stored_energy_change_mean", statistic("stored_energy_change_mean"), np.mean(stored[:, -1] - stored[:, rows][:, 0]))
        works = {name: statistic(f"{name}_mean") for name in ("temperature_work", "own_force_work", "damping_work", "friction_work", "stored_energy_change")}
        left = works["temperature_work"] + works["own_force_work"] - works["damping_work"] - works["friction_work"] - works["stored_energy_change"]
        # Under noise the balance closes by itself, to rounding; both numbers are shares of friction's.
        residual = statistic("energy_residual_mean") / works["friction_work"]
        same("1 + energy_residual_mean", 1 + residual, 1 + left / works["friction_work"], 1e-12)
        # The trapezoidal rule on the rows gives what damping takes to some per cent.
        rough = 2 * oscillator["damping"] * np.mean(np.trapezoid(v[:, rows] ** 2, time[rows], axis=1))
        same("damping_work_mean", works["damping_work"], rough, 0.05)


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Recompute every derived variable of a run from the others.

    target/venv/bin/python tests/python/derived.py RUN.h5 ...

What a file has decides what is recomputed: corrected estimates and their intervals from estimates
and biases; the rows of paths from their events; estimates, errors and counts from the rows of paths;
bands and the probability of rest from the trajectories of all paths; forces, friction and the reading
of the sensor from the states of a trajectory. Without a force of the user's own.

Exits with 1 at the first variable that is wrong, and names it.
"""

import sys
import tomllib

import h5py
import numpy as np
from on_request import kaplan_meier, same


class Run:
    """The variables of a file, its scenario, and its statistics by name."""

    def __init__(self, file):
        self.file, self.scenario = file, tomllib.loads(file.attrs["scenario"])
        self.names = [name.decode() for name in file["statistic"][:]]
        self.is_paired = "antithetic" in file.attrs
        self.after = self.scenario["statistics"]["after"]
        self.end = self.scenario["time"]["end"]

    def __contains__(self, name):
        return name in self.file

    def __getitem__(self, name):
        return self.file[name][()]

    def statistic(self, name, of="estimate"):
        return self.file[of][self.names.index(name)]

    def units(self, values):
        """Sums over the independent units: paths, or antithetic pairs."""
        values = np.asarray(values, float)
        return values.reshape(-1, 2).sum(axis=1) if self.is_paired else values

    def finite(self, name):
        """A column of the paths that are in the statistics."""
        return self[name][self["path_diverged"] == 0].astype(float)


def check_axes(run):
    same("time", run["time"], np.arange(len(run["time"])) * run.scenario["time"]["output_step"])
    same("quantile", run["quantile"], [0.05, 0.25, 0.5, 0.75, 0.95])
    for name in ("path", "trajectory"):
        if name in run and not run.file.attrs["diverged_paths"]:
            same(name, run[name], np.arange(len(run[name])))


def check_corrected(run):
    estimate, low, high = (run[name] for name in ("estimate", "interval_low", "interval_high"))
    bias, uncertainty = run["bias"], run["bias_uncertainty"]
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = np.where(np.abs(bias) > uncertainty, 1 - (uncertainty / bias) ** 4, 0)
        centre = estimate - bias
        ends = centre - np.hypot(estimate - low, uncertainty), centre + np.hypot(high - estimate, uncertainty)
        known = np.isfinite(ends[0]) & np.isfinite(ends[1])
    if not known.any() or not (np.abs(bias[known]) > uncertainty[known]).any():
        sys.exit("no bias is known")
    for name, wanted in (("", estimate - weight * bias), ("_low", ends[0]), ("_high", ends[1])):
        found = run[f"estimate_corrected{name}"]
        if (np.isfinite(found) != known).any():
            sys.exit(f"estimate_corrected{name} is not there exactly where a bias is known")
        same(f"estimate_corrected{name}", found[known], wanted[known], 1e-12)


def phases(run):
    """For each path, its phases: whether it is a stick, the times and places of its begin and of its end, its sub-phases,
    and whether it ended."""
    counts = run["event_count"]
    time, x, kind = (run[f"event_{name}"] for name in ("time", "displacement", "kind"))
    moves = run.scenario["initial"].get("velocity", 0) != 0
    x0 = run.scenario["initial"]["displacement"]
    for stop, count in zip(np.cumsum(counts), counts):
        of = slice(stop - count, stop)
        found = [] if moves else [[True, 0.0, x0, run.end, np.nan, 0, False]]
        for t, place, what in zip(time[of], x[of], kind[of]):
            if what == 2:
                found[-1][5] += 1
                continue
            if found:
                found[-1][3:5], found[-1][6] = (t, place), True
            found.append([what == 0, t, place, run.end, np.nan, int(what == 1), False])
        yield found, moves


def check_rows_of_paths(run):
    rows = {name: [] for name in ("sticks", "slips", "sub_phases", "stick_time", "first_stick_duration")}
    farthest = []
    ends = np.cumsum(run["event_count"])
    places = np.split(np.abs(run["event_displacement"]), ends[:-1])
    x0 = abs(run.scenario["initial"]["displacement"])
    for (found, moves), far, end in zip(phases(run), places, np.abs(run["path_displacement_end"])):
        counted = [phase for phase in found[not moves:] if phase[6] and phase[1] >= run.after]
        slips = [phase for phase in counted if not phase[0]]
        rows["sticks"].append(len(counted) - len(slips))
        rows["slips"].append(len(slips))
        rows["sub_phases"].append(sum(phase[5] for phase in slips))
        rows["stick_time"].append(sum(max(0.0, phase[3] - max(phase[1], run.after)) for phase in found if phase[0]))
        has_first = not moves and found[0][6]
        rows["first_stick_duration"].append(found[0][3] if has_first else np.nan)
        farthest.append(max([x0, end, *far]))
    for name, wanted in rows.items():
        finite = np.isfinite(wanted)
        if (np.isfinite(run[f"path_{name}"]) != finite).any():
            sys.exit(f"path_{name} is missing, or is there, for the wrong paths")
        same(f"path_{name}", run[f"path_{name}"][finite], np.asarray(wanted)[finite])
    same("path_max_displacement", run["path_max_displacement"], farthest)


def check_events(run):
    """The body moves in the direction of its sub-phase, which has none in a stick; without noise the force of an event
    in a stick is that of its row of T, and at the end of a stick it is a threshold."""
    ends = np.cumsum(run["event_count"])
    x, sign, kind, force = (run[f"event_{name}"] for name in ("displacement", "sign", "kind", "force"))
    if ((kind == 0) != (sign == 0)).any():
        sys.exit("event_sign: a stick has none, and a sub-phase has one")
    for start, stop, last in zip(ends - run["event_count"], ends, run["path_displacement_end"]):
        way = np.sign(np.diff(np.append(x[start:stop], last)))
        if (way * sign[start:stop] < 0).any() or way[sign[start:stop] == 0].any():
            sys.exit("event_sign is not the direction of the motion that follows")
    friction = run.scenario["friction"]["static"]
    if not isinstance(friction, dict) and (np.abs(force[kind == 0]) > friction * (1 + 1e-9)).any():
        sys.exit("event_force: a stick begins beyond the threshold")
    if "step" not in run.file.attrs and not isinstance(friction, dict):
        leaves = (kind == 1) & (run["event_time"] > 0)
        same("event_force where sticks end", np.abs(force[leaves]), np.full(leaves.sum(), friction), 1e-6)
        turns = kind == 2
        if (force[turns] * sign[turns] <= friction).any():
            sys.exit("event_force: a body turns in the band")
    else:
        same("event_sign where slips begin", np.sign(force[kind > 0]), sign[kind > 0])


def check_law_of_sticks(run, durations, lasting):
    """Counts in bins, the survival curve, and quantiles."""
    row = [name.decode() for name in run["law"]].index("stick")
    upper = run["law_upper"][row]
    bins = np.isfinite(upper)
    lower, upper = run["law_lower"][row][bins], upper[bins]
    for name, values in (("law_count", durations), ("law_censored_count", lasting)):
        # A duration of whole steps may differ from the edge by rounding.
        wanted = [np.sum((values >= low * (1 - 1e-12)) & (values < high * (1 - 1e-12))) for low, high in zip(lower, upper)]
        same(f"{name} of sticks", run[name][row][bins], wanted)
    off = np.abs(run["law_survival"][row][bins] - kaplan_meier(durations, lasting, upper * (1 - 1e-12)))
    if off.max() > 1e-3:
        sys.exit(f"law_survival of sticks is off by {off.max()}")
    for level, found in zip(run["quantile"], run["law_quantile"][row]):
        below = np.quantile(durations, max(level - 0.002, 0), method="lower")
        above = np.quantile(durations, min(level + 0.002, 1), method="higher")
        if not below * (1 - 1e-6) <= found <= above * (1 + 1e-6):
            sys.exit(f"law_quantile: {level} of sticks is {found}, not from {below} to {above}")


def check_phases(run):
    """Means over phases, and how many phases there are."""
    all_phases = list(phases(run))
    def counted(is_stick):
        for found, moves in all_phases:
            yield [phase for phase in found[not moves:] if phase[6] and phase[0] == is_stick and phase[1] >= run.after]
    def ratio(name, parts, wholes):
        parts, wholes = run.units(parts), run.units(wholes)
        value = parts.sum() / wholes.sum()
        same(name, run.statistic(name), value)
        n, rest = len(parts), parts - value * wholes
        if n > 1:
            same(f"standard error of {name}", run.statistic(name, "standard_error"), np.sqrt((rest**2).sum() * n / (n - 1)) / wholes.sum())
    sticks, slips = list(counted(True)), list(counted(False))
    ratio("stick_duration_mean", [sum(p[3] - p[1] for p in of) for of in sticks], [len(of) for of in sticks])
    ratio("jump_mean", [sum(p[4] - p[2] for p in of) for of in slips], [len(of) for of in slips])
    ratio("jump_abs_mean", [sum(abs(p[4] - p[2]) for p in of) for of in slips], [len(of) for of in slips])
    ratio("sub_phases_multiple_share", [sum(p[5] > 1 for p in of) for of in slips], [len(of) for of in slips])
    durations = np.array([p[3] - p[1] for of in sticks for p in of])
    same("stick_duration_sd", run.statistic("stick_duration_sd"), durations.std())
    k = np.array([p[5] for of in slips for p in of])
    numbers = run["sub_phase"]
    wanted = [np.sum(k == n) for n in numbers[:-1]] + [np.sum(k >= numbers[-1])]
    same("sub_phase_count", run["sub_phase_count"], wanted)
    same("sub_phase_share", run["sub_phase_share"], np.array(wanted) / len(k))
    lasting = [found[-1] for found, moves in all_phases if len(found) > (not moves)]
    same("sub_phase_censored", run["sub_phase_censored"], sum(not p[0] and p[1] >= run.after for p in lasting))
    row = [name.decode() for name in run["law"]].index("stick")
    same("law_completed of sticks", run["law_completed"][row], len(durations))
    same("law_censored of sticks", run["law_censored"][row], sum(p[0] and p[1] >= run.after for p in lasting))
    check_law_of_sticks(run, durations, np.array([run.end - p[1] for p in lasting if p[0] and p[1] >= run.after]))
    first = [found[0][6] for found, moves in all_phases if not moves]
    same("first_stick_duration_completed", run["first_stick_duration_completed"], sum(first))
    same("first_stick_duration_censored", run["first_stick_duration_censored"], len(first) - sum(first))
    if "transient_sticks" in run:
        early = [p for found, moves in all_phases for p in found[not moves:] if p[6] and p[1] < run.after]
        same("transient_sticks", run["transient_sticks"], sum(p[0] for p in early))
        same("transient_slips", run["transient_slips"], sum(not p[0] for p in early))


def check_estimates(run):
    """Means over paths, their errors, and standard deviations, from the rows of paths."""
    columns = {
        "displacement_end_mean": run.finite("path_displacement_end"),
        "sticks_per_path": run.finite("path_sticks"),
        "slips_per_path": run.finite("path_slips"),
        "sticking_fraction": run.finite("path_stick_time") / (run.end - run.after),
        "friction_work_mean": run.finite("path_friction_work"),
    }
    for name, column in columns.items():
        units = run.units(column) / (1 + run.is_paired)
        same(name, run.statistic(name), column.mean())
        if len(units) > 1:
            same(f"standard error of {name}", run.statistic(name, "standard_error"), units.std(ddof=1) / np.sqrt(len(units)))
    f_d = run.scenario["friction"]["dynamic"]
    if not isinstance(f_d, dict) and f_d > 0:
        rate = columns["friction_work_mean"].mean() / f_d / (run.end - run.after)
        same("sliding_path_rate", run.statistic("sliding_path_rate"), rate)
    if not run.is_paired and len(columns["sticks_per_path"]) > 1:
        same("displacement_end_sd", run.statistic("displacement_end_sd"), columns["displacement_end_mean"].std(ddof=1))
    slips = run.finite("path_slips").sum()
    if slips > 0:
        same("sub_phases_mean", run.statistic("sub_phases_mean"), run.finite("path_sub_phases").sum() / slips)
    first = run.finite("path_first_stick_duration")
    if np.isfinite(first).any():
        same("first_stick_duration_mean", run.statistic("first_stick_duration_mean"), np.nanmean(first))


def check_bands(run):
    """Means, deviations and quantiles over all paths, at each row of the output grid."""
    for name in ("displacement", "velocity", "temperature"):
        values = run[f"trajectory_{name}"]
        same(f"{name}_mean", run[f"{name}_mean"], values.mean(axis=0))
        if not run.is_paired and len(values) > 1:
            same(f"{name}_sd", run[f"{name}_sd"], values.std(axis=0, ddof=1))
        # Quantiles are right to a fiftieth of the standard deviation.
        sd = values.std(axis=0)
        for level, found in zip(run["quantile"], run[f"{name}_quantile"]):
            below, above = (np.quantile(values, np.clip(level + off, 0, 1), axis=0) for off in (-2 / len(values), 2 / len(values)))
            if ((found < below - sd / 50 - 1e-12) | (found > above + sd / 50 + 1e-12)).any():
                sys.exit(f"{name}_quantile: {level}")
    same("static_probability", run["static_probability"], run["trajectory_static"].mean(axis=0))


def check_trajectories(run):
    """The forces of each state, and what a sensor at the bearing reads."""
    oscillator, friction = run.scenario["oscillator"], run.scenario["friction"]
    x, v, temperature = (run[f"trajectory_{name}"] for name in ("displacement", "velocity", "temperature"))
    k, alpha = oscillator["stiffness"], oscillator.get("damping", 0.0)
    c = oscillator.get("force_per_temperature", k * oscillator.get("dilatation", 0.0))
    b, found = c * temperature - k * x - 2 * alpha * v, run["trajectory_force"]
    scale = np.abs(c * temperature).max() + np.abs(k * x).max()
    if np.abs(found - b).max() > 1e-12 * scale:
        sys.exit(f"trajectory_force is off by {np.abs(found - b).max()}")
    force, is_static = run["trajectory_friction"], run["trajectory_static"] == 1
    if np.abs(force - b)[is_static].max(initial=0.0) > 1e-12 * scale or (np.abs(b)[is_static] > friction["static"] * (1 + 1e-9)).any():
        sys.exit("in a stick friction holds the force, up to f_s")
    moves = ~is_static & (v != 0)
    same("friction in slips", force[moves], friction["dynamic"] * np.sign(v[moves]))
    if "trajectory_bearing_displacement" in run:
        bearing = run.scenario["bearing"]
        read = bearing["offset"] + x + (force / bearing["stiffness"] if "stiffness" in bearing else 0.0)
        same("trajectory_bearing_displacement", run["trajectory_bearing_displacement"], read)


def check_periods(run):
    period = run.scenario["statistics"].get("period")
    if period is not None:
        same("period_time", run["period_time"], run["period"] * period)
    mean, variance = run["displacement_period_mean"], run["displacement_period_variance"]
    first = np.searchsorted(run["period_time"], max(run.after * (1 - 1e-9), 1e-300))
    t = run["period_time"][first:]
    if len(t) > 1:
        slope = np.polyfit(t, mean[first:], 1)[0]
        same("drift_velocity", run.statistic("drift_velocity"), slope, 1e-7)
        if np.isfinite(variance).all():
            slope = np.polyfit(t, variance[first:], 1)[0]
            same("diffusion_coefficient", run.statistic("diffusion_coefficient"), slope / 2, 1e-7)


def main(paths):
    for path in paths:
        print(path)
        with h5py.File(path) as file:
            run = Run(file)
            has_all = "trajectory" in run and len(run["trajectory"]) == file.attrs["completed_paths"] == file.attrs["paths"]
            is_whole = file.attrs["diverged_paths"] == 0
            for is_there, check in (
                (True, check_axes),
                ("estimate_corrected" in run, check_corrected),
                ("event_count" in run and is_whole, check_rows_of_paths),
                ("event_count" in run and is_whole, check_events),
                ("event_count" in run and is_whole, check_phases),
                ("path_slips" in run, check_estimates),
                (has_all and is_whole, check_bands),
                ("trajectory" in run, check_trajectories),
                ("period_time" in run, check_periods),
            ):
                if is_there:
                    check(run)
    print("every derived variable follows from the others")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])

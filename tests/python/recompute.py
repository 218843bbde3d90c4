"""Recompute every variable of a file of `mc run` from its events, its trajectories and its scenario, and hold its units against a list.

    target/venv/bin/python tests/python/recompute.py RUN.h5 [REPLAY.h5 ...]

RUN.h5 holds the events and the trajectories of all its paths (`record.events=true`, `record.trajectories` as many as paths), none of which
is lost, on an output grid that passes through the ends of the forcing periods; its unit labels are s, mm, N and K. REPLAY.h5 is a path
of it. Nothing here knows how the program folds its sums: each number is computed from all values at once, as its definition says.

Exits with 1 and names the variable that is not what it should be.
"""

import math
import sys
import tomllib

import h5py
import numpy as np

# The unit of every variable, in UDUNITS notation; None where it has none.
UNITS = {
    None: """statistic statistic_long_name statistic_unit estimate standard_error interval_low interval_high bias bias_uncertainty
        bias_order estimate_corrected estimate_corrected_low estimate_corrected_high path_diverged event event_sign event_kind trajectory_static""",
    "1": """quantile static_probability stick_duration_count stick_duration_censored_count stick_duration_survival
        stick_duration_completed stick_duration_censored first_stick_duration_completed first_stick_duration_censored
        sub_phase sub_phase_count sub_phase_censored period path path_sticks path_slips path_sub_phases event_count trajectory""",
    "s": """time duration_bin duration_bin_lower stick_duration_quantile period_time path_first_stick_duration path_stick_time
        event_time""",
    "mm": """displacement_mean displacement_sd displacement_quantile displacement_period_mean path_displacement_end
        path_max_displacement event_displacement trajectory_displacement""",
    "mm2": "displacement_period_variance",
    "mm s-1": "velocity_mean velocity_sd velocity_quantile trajectory_velocity",
    "N": "event_force trajectory_force trajectory_friction",
    "N mm": "path_friction_work",
    "K": "temperature_mean temperature_sd temperature_quantile trajectory_temperature",
}
UNIT = {name: unit for unit, names in UNITS.items() for name in names.split()}

# Every statistic, in the order of the file, with its unit.
STATISTICS = {
    "stick_duration_mean": "s",
    "stick_duration_sd": "s",
    "stick_duration_median": "s",
    "first_stick_duration_mean": "s",
    "sticks_per_path": "1",
    "slips_per_path": "1",
    "sub_phases_mean": "1",
    "sub_phases_multiple_share": "1",
    "sticking_fraction": "1",
    "displacement_end_mean": "mm",
    "displacement_end_sd": "mm",
    "drift_velocity": "mm s-1",
    "diffusion_coefficient": "mm2 s-1",
    "jump_mean": "mm",
    "jump_abs_mean": "mm",
    "friction_work_mean": "N mm",
}

LEVELS = [0.05, 0.25, 0.5, 0.75, 0.95]
ENTERED, STARTED, TURNED = 0, 1, 2

# Sums of thousands of numbers in another order.
ROUNDING = 1e-11

checked = set()


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def same(name, got, wanted, within=ROUNDING):
    """Each number of a variable is the one wanted, up to a share of the largest of them; NaN is NaN."""
    got, wanted = np.asarray(got, dtype=float), np.asarray(wanted, dtype=float)
    check(got.shape == wanted.shape, f"{name}: shape {got.shape}, not {wanted.shape}")
    check(bool((np.isnan(got) == np.isnan(wanted)).all()), f"{name}: other numbers are missing")
    finite = np.isfinite(wanted)
    if finite.any():
        off = np.abs(got[finite] - wanted[finite])
        worst = int(np.argmax(off))
        scale = np.abs(wanted[finite]).max()
        check(off[worst] <= within * scale, f"{name}: {got[finite][worst]!r}, not {wanted[finite][worst]!r}")
    checked.add(name)


def student(freedom):
    """The 97.5 % quantile of Student's t: the density, summed up until there are 47.5 %."""
    constant = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2)) / math.sqrt(freedom * math.pi)
    low, high = 0.0, 200.0
    for _ in range(60):
        middle = (low + high) / 2
        x = np.linspace(0, middle, 20001)
        share = np.trapezoid(constant * (1 + x * x / freedom) ** (-(freedom + 1) / 2), x)
        low, high = (middle, high) if share < 0.475 else (low, middle)
    return (low + high) / 2


class Path:
    """What the events of one path and its place at the end come to."""

    def __init__(self, scenario, events, end):
        self.t_end, x0 = scenario["time"]["end"], scenario["initial"]["displacement"]
        f_d = scenario["friction"]["dynamic"]
        self.sticks, self.first, self.censored_stick = [], math.nan, None
        self.jumps, self.counts = [], []
        self.stick_time, travel = 0.0, 0.0
        is_first, entered, origin, x, k = True, 0.0, x0, x0, None
        self.largest = max(abs(x0), abs(end))
        for time, displacement, kind in zip(events["time"], events["displacement"], events["kind"], strict=True):
            check((k is None) == (kind == STARTED), "a slip starts from a stick, and turns or ends in a slip")
            travel += abs(displacement - x)
            check(k is not None or displacement == x, "the body rests in a stick")
            x, self.largest = displacement, max(self.largest, abs(displacement))
            if kind == STARTED:
                duration = time - entered
                self.stick_time += duration
                if is_first:
                    self.first, is_first = duration, False
                else:
                    self.sticks.append(duration)
                origin, k = x, 1
            elif kind == TURNED:
                k += 1
            else:
                self.jumps.append(x - origin)
                self.counts.append(k)
                entered, k = time, None
        if k is None:
            self.stick_time += self.t_end - entered
            self.censored_stick = None if is_first else self.t_end - entered
        self.is_first_censored, self.is_slip_censored = is_first, k is not None
        self.end, self.work = end, f_d * (travel + abs(end - x))


def check_events(data, paths, events, is_on_grid):
    """The signs against what the body does next, the forces against the thresholds and, where every step is kept, against the trajectories."""
    friction, oscillator = data.scenario["friction"], data.scenario["oscillator"]
    moves = 0
    for path, of in zip(paths, events, strict=True):
        places = np.append(of["displacement"], path.end)
        for i, (sign, kind, force) in enumerate(zip(of["sign"], of["kind"], of["force"], strict=True)):
            check((sign == 0) == (kind == ENTERED), "event_sign: 0 where a stick starts, and nowhere else")
            change = places[i + 1] - places[i]
            if kind == ENTERED:
                # The quasi-static recursion does not ask: where the force does not hold, the stick is empty.
                holds = abs(force) <= friction["static"] * (1 + 1e-12) or data.attributes["scheme"] == "quasi-static"
                check(holds, f"event_force: {force} holds no stick")
                check(change == 0, "the body rests in a stick")
                continue
            check(sign * change >= 0, f"event_sign: {sign}, and the body moves by {change}")
            moves += sign * change > 0
            check(sign * force > 0, f"event_force: {force} against a motion of sign {sign}")
            # A step may pass a turn, and lets a body go at the last instant before the force is too large.
            if not data.has_step:
                check(abs(force) >= friction["static"] * (1 - 1e-9), f"event_force: {force} moves nothing")
    check(moves > 1000, f"event_sign: {moves} of the sub-phases move")
    if is_on_grid:
        k, alpha = oscillator["stiffness"], oscillator["damping"]
        rows = [np.rint(of["time"] / data.spacing).astype(int) for of in events]
        for path, (of, at) in enumerate(zip(events, rows, strict=True)):
            same("event_time", of["time"], at * data.spacing)
            same("event_displacement", of["displacement"], data["trajectory_displacement"][path, at])
            b = k * (oscillator["dilatation"] * data["trajectory_temperature"][path, at] - of["displacement"])
            velocity = np.where(of["kind"] == TURNED, data["trajectory_velocity"][path, at], 0)
            at_rest = (of["kind"] == TURNED) & (velocity == 0)
            check(bool((np.abs(of["force"][at_rest]) > friction["static"]).all()), "event_force: a turn at rest that is a stick")
            same("event_force", of["force"], b - 2 * alpha * velocity)
    checked.update(["event_time", "event_displacement", "event_force", "event_sign", "event_kind", "event"])


def check_trajectories(data, events):
    """b and F by their formulas, from the phases that the events tell."""
    friction, oscillator = data.scenario["friction"], data.scenario["oscillator"]
    time, x, v = data["time"], data["trajectory_displacement"], data["trajectory_velocity"]
    b = oscillator["stiffness"] * (oscillator["dilatation"] * data["trajectory_temperature"] - x) - 2 * oscillator["damping"] * v
    same("trajectory_force", data["trajectory_force"], b)
    static, sign = np.ones(x.shape, dtype=bool), np.zeros(x.shape)
    for path, of in enumerate(events):
        # A stick lasts up to the instant at which it ends; a sub-phase begins at its own.
        begins = np.where(of["kind"] == STARTED, np.searchsorted(time, of["time"], "right"), np.searchsorted(time, of["time"], "left"))
        # A start outside the corridor is not at rest for an instant.
        begins = np.where((of["kind"] == STARTED) & (of["time"] == 0), 0, begins)
        for first, kind, direction in zip(begins, of["kind"], of["sign"], strict=True):
            static[path, first:] = kind == ENTERED
            sign[path, first:] = direction
    same("trajectory_static", data["trajectory_static"], static)
    check(bool((v[static] == 0).all()), "trajectory_velocity: zero in a stick")
    same("trajectory_friction", data["trajectory_friction"], np.where(static, b, friction["dynamic"] * sign))
    # The way is the integral of the velocity: the trapezoidal rule, whose error is h^2/12 times the change of the force, and in a scheme with a step h/2 times it.
    way = np.diff(x, axis=1) - np.diff(time) * 0.5 * (v[:, 1:] + v[:, :-1])
    largest = np.abs(b).max() / oscillator["mass"]
    check(bool((np.abs(way) <= largest * data.spacing**2).all()), "trajectory_velocity: the rate of the displacement")
    harmonics = data.scenario["temperature"]["harmonics"]
    mean = sum(h["amplitude"] * np.cos(h["angular_frequency"] * time + h["phase"]) for h in harmonics)
    noise = data["trajectory_temperature"] - mean
    # v(0) = 0, and then the law of the noise; its variance is known to 5 sqrt(2/paths).
    parts = data.scenario["temperature"]["noise"]
    theta, amplitude = parts["relaxation_rate"], parts["intensity"] * parts["diffusion"]
    variance = amplitude**2 * (1 - np.exp(-2 * theta * time)) / (2 * theta)
    allowed = 5 * math.sqrt(2 / len(noise)) * variance + 1e-20
    check(bool((np.abs((noise**2).mean(axis=0) - variance) <= allowed).all()), "trajectory_temperature: the variance of the noise")
    checked.update(["trajectory_displacement", "trajectory_velocity", "trajectory_temperature"])


def check_bands(data):
    for name in ("displacement", "velocity", "temperature"):
        rows = data[f"trajectory_{name}"]
        same(f"{name}_mean", data[f"{name}_mean"], rows.mean(axis=0))
        same(f"{name}_sd", data[f"{name}_sd"], rows.std(axis=0, ddof=1), 1e-9)
        check_quantiles(f"{name}_quantile", data[f"{name}_quantile"], rows)
    same("static_probability", data["static_probability"], data["trajectory_static"].mean(axis=0))


def check_quantiles(name, got, values):
    """Level by level, along the columns of values: between the neighbouring order statistics, since so few values are all kept."""
    check(got.shape == (len(LEVELS), *values.shape[1:]), f"{name}: axes {got.shape}")
    ordered = np.sort(values, axis=0)
    for level, row in zip(LEVELS, got, strict=True):
        rank = level * (len(values) - 1)
        below, above = ordered[math.floor(rank)], ordered[math.ceil(rank)]
        is_between = (below - ROUNDING * np.abs(below) <= row) & (row <= above + ROUNDING * np.abs(above))
        check(bool(np.all(is_between)), f"{name} at {level}: not between {below} and {above}")
    checked.add(name)


def check_durations(data, paths):
    durations = np.array([d for path in paths for d in path.sticks])
    cut = np.array([path.censored_stick for path in paths if path.censored_stick is not None])
    lower, upper = data["duration_bin_lower"], data["duration_bin"]
    check(bool((lower[1:] == upper[:-1]).all() and (lower < upper).all()), "duration_bin: the bins touch")
    count = lambda values: [int(((lo <= values) & (values < hi)).sum()) for lo, hi in zip(lower, upper, strict=True)]
    same("stick_duration_count", data["stick_duration_count"], count(durations))
    same("stick_duration_censored_count", data["stick_duration_censored_count"], count(cut))
    # Kaplan and Meier's product over the sticks in the order of their durations, those that end first where some are cut off as well.
    survival, at_risk, product, curve = {}, len(durations) + len(cut), 1.0, []
    marks = sorted([(d, 0) for d in durations] + [(d, 1) for d in cut])
    i = 0
    for edge in upper:
        while i < len(marks) and marks[i][0] < edge:
            if marks[i][1] == 0:
                product *= 1 - 1 / at_risk
            at_risk -= 1
            i += 1
        curve.append(product)
    # Sticks that are cut off in a narrow bin count as having outlasted those that end in it: some in a thousand.
    check(float(np.abs(data["stick_duration_survival"] - curve).max()) < 0.002, "stick_duration_survival")
    if data.has_step:
        # Those of a discrete law: the smallest multiple of the step that so large a share does not exceed.
        ordered = np.sort(in_steps(data, durations))
        smallest = [ordered[math.ceil(level * len(ordered) - 1e-9) - 1] for level in LEVELS]
        same("stick_duration_quantile", data["stick_duration_quantile"], np.array(smallest) * data.spacing)
    else:
        check_quantiles("stick_duration_quantile", data["stick_duration_quantile"], durations)
    for name, number in [
        ("stick_duration_completed", len(durations)),
        ("stick_duration_censored", len(cut)),
        ("first_stick_duration_completed", sum(not path.is_first_censored for path in paths)),
        ("first_stick_duration_censored", sum(path.is_first_censored for path in paths)),
    ]:
        same(name, data[name], number)
    checked.update(["duration_bin", "duration_bin_lower", "stick_duration_survival"])


def check_sub_phases(data, paths):
    counts = np.array([k for path in paths for k in path.counts])
    most = len(data["sub_phase"])
    same("sub_phase", data["sub_phase"], np.arange(1, most + 1))
    same("sub_phase_count", data["sub_phase_count"], np.bincount(np.minimum(counts, most), minlength=most + 1)[1:])
    same("sub_phase_censored", data["sub_phase_censored"], sum(path.is_slip_censored for path in paths))
    # In the quasi-static recursion each has one.
    is_recursion = data.attributes["scheme"] == "quasi-static"
    check((counts > 1).sum() > 100 or is_recursion, "the scene has dynamic phases of several sub-phases")


def check_periods(data):
    frequency = next(h["angular_frequency"] for h in data.scenario["temperature"]["harmonics"] if h["angular_frequency"] > 0)
    period = 2 * math.pi / frequency
    number = math.floor(data.scenario["time"]["end"] / period + 1e-9)
    times = period * np.arange(1, number + 1)
    same("period", data["period"], np.arange(1, number + 1))
    same("period_time", data["period_time"], times)
    rows = np.rint(times / data.spacing).astype(int)
    check(bool((np.abs(data["time"][rows] - times) < 1e-9).all()), "the output grid passes through the ends of the periods")
    x = data["trajectory_displacement"][:, rows] - data.scenario["initial"]["displacement"]
    same("displacement_period_mean", data["displacement_period_mean"], x.mean(axis=0))
    same("displacement_period_variance", data["displacement_period_variance"], x.var(axis=0, ddof=1))
    return times, x


def check_paths(data, paths):
    same("path", data["path"], np.arange(len(paths)))
    same("trajectory", data["trajectory"], np.arange(len(paths)))
    columns = {
        "displacement_end": [path.end for path in paths],
        "max_displacement": [path.largest for path in paths],
        "first_stick_duration": [path.first for path in paths],
        "stick_time": [path.stick_time for path in paths],
        "friction_work": [path.work for path in paths],
        "sticks": [len(path.sticks) for path in paths],
        "slips": [len(path.jumps) for path in paths],
        "sub_phases": [sum(path.counts) for path in paths],
        "diverged": [0 for _ in paths],
    }
    for name, wanted in columns.items():
        same(f"path_{name}", data[f"path_{name}"], wanted)
    # It is looked for at events, and the corrected step from a turn to the next instant has its new velocity: h times the velocity of a step may be missing.
    largest = np.abs(data["trajectory_displacement"]).max(axis=1)
    hardest = (np.abs(data["trajectory_force"]).max() + data.scenario["friction"]["dynamic"]) / data.scenario["oscillator"]["mass"]
    missing = data.attributes["step"] ** 2 * hardest if data.attributes["scheme"] == "corrected-vi" else 1e-9
    check(bool((data["path_max_displacement"] >= largest - missing).all()), "path_max_displacement: nothing is farther out")


def check_statistics(data, paths, times, x):
    """Estimates, standard errors and intervals; the path is the independent unit."""
    n = len(paths)
    column = lambda of: np.array([float(of(path)) for path in paths])

    def mean(values):
        return values.mean(), values.std(ddof=1) / math.sqrt(len(values)), len(values) - 1

    def pooled(tops, bottoms, estimate=None):
        """sum/sum, whose residuals are those of the paths that put something into the pool."""
        ratio = tops.sum() / bottoms.sum() if estimate is None else estimate
        residuals = tops - (ratio * bottoms if estimate is None else 0)
        m = int((bottoms > 0).sum())
        return ratio, math.sqrt(m / (m - 1) * (residuals**2).sum()) / bottoms.sum(), m - 1

    durations = np.concatenate([path.sticks for path in paths])
    sticks = column(lambda p: len(p.sticks))
    centre, sd = durations.mean(), durations.std()
    spread = column(lambda p: sum((d - centre) ** 2 - sd**2 for d in p.sticks)) / (2 * sd)
    slips = column(lambda p: len(p.jumps))
    ends = column(lambda p: p.end)
    squares = (ends - ends.mean()) ** 2
    first = column(lambda p: 0 if p.is_first_censored else p.first)
    weights = (times - times.mean()) / ((times - times.mean()) ** 2).sum()
    block = int(data.attributes["block_size"])
    shares = []
    for begin in range(0, n, block):
        part = x[begin : begin + block]
        shares.extend((part - part.mean(axis=0)) ** 2 @ weights * len(part) / (len(part) - 1))
    diffusion = 0.5 * float(weights @ x.var(axis=0, ddof=1))
    found = {
        "stick_duration_mean": pooled(column(lambda p: sum(p.sticks)), sticks),
        "stick_duration_sd": pooled(spread, sticks, sd),
        "first_stick_duration_mean": pooled(first, column(lambda p: not p.is_first_censored)),
        "sticks_per_path": mean(sticks),
        "slips_per_path": mean(slips),
        "sub_phases_mean": pooled(column(lambda p: sum(p.counts)), slips),
        "sub_phases_multiple_share": pooled(column(lambda p: sum(k > 1 for k in p.counts)), slips),
        "sticking_fraction": mean(column(lambda p: p.stick_time / p.t_end)),
        "displacement_end_mean": mean(ends),
        "displacement_end_sd": (
            ends.std(ddof=1),
            math.sqrt(((squares - squares.mean()) ** 2).sum() / (n * (n - 1))) / (2 * ends.std(ddof=1)),
            n - 1,
        ),
        "drift_velocity": mean(x @ weights),
        "diffusion_coefficient": (diffusion, 0.5 * mean(np.array(shares))[1], n - 1),
        "jump_mean": pooled(column(lambda p: sum(p.jumps)), slips),
        "jump_abs_mean": pooled(column(lambda p: sum(abs(jump) for jump in p.jumps)), slips),
        "friction_work_mean": mean(column(lambda p: p.work)),
    }
    check(list(data["statistic"]) == list(STATISTICS), "statistic: the names, in their order")
    check(list(data["statistic_unit"]) == list(STATISTICS.values()), "statistic_unit")
    for row, name in enumerate(STATISTICS):
        check(data["statistic_long_name"][row], f"statistic_long_name of {name}")
        told = [data[kind][row] for kind in ("estimate", "standard_error", "interval_low", "interval_high")]
        if name in found:
            value, error, freedom = found[name]
            reach = student(freedom) * error
            wanted, scale = [value, error, value - reach, value + reach], abs(value) + error
            for kind, a, b in zip(("estimate", "error", "low", "high"), told, wanted, strict=True):
                check(abs(a - b) <= 1e-8 * scale, f"{name}, {kind}: {a!r}, not {b!r}")
    check_median(data, paths, durations)
    check_corrected(data)
    checked.update("""statistic statistic_long_name statistic_unit estimate standard_error interval_low interval_high bias
        bias_uncertainty bias_order""".split())


def check_corrected(data):
    """The estimate less max(0, 1 - (uncertainty/bias)^4) of its bias, in the interval of the estimate less all of it."""
    if "estimate_corrected" not in data:
        for name in ("bias", "bias_uncertainty", "bias_order"):
            check(bool(np.isnan(data[name]).all()), f"{name}: the run was told not to estimate it")
        return 0
    corrected = 0
    for row, name in enumerate(data["statistic"]):
        estimate, bias, uncertainty = (data[kind][row] for kind in ("estimate", "bias", "bias_uncertainty"))
        weight = 0.0 if abs(bias) <= uncertainty else 1 - (uncertainty / bias) ** 4
        below, above = estimate - data["interval_low"][row], data["interval_high"][row] - estimate
        whole = estimate - bias
        wanted = [estimate - weight * bias, whole - math.hypot(below, uncertainty), whole + math.hypot(above, uncertainty)]
        told = [data[f"estimate_corrected{end}"][row] for end in ("", "_low", "_high")]
        check(np.allclose(told, wanted, rtol=1e-12, atol=0, equal_nan=True), f"{name}, corrected: {told}, not {wanted}")
        corrected += weight > 0
    checked.update(["estimate_corrected", "estimate_corrected_low", "estimate_corrected_high"])
    return corrected


def check_bias(path):
    """A run of so many paths that some of its biases exceed their uncertainties."""
    corrected = check_corrected(Data(path))
    check(corrected >= 3, f"{corrected} statistics have a bias beyond its uncertainty")
    print(f"  {corrected} corrected estimates are what they should be")


def in_steps(data, durations):
    """The scenarios of this test have an output step as long as the step of the scheme."""
    durations = np.asarray(durations)
    steps = np.round(durations / data.spacing)
    check(bool(np.all(np.abs(durations - steps * data.spacing) <= 1e-9)), "durations are multiples of the step")
    return steps


def check_median(data, paths, durations):
    """Woodruff's interval: the error of the share of sticks up to the median, from 32 batches of whole paths, read back through the distribution."""
    row = list(STATISTICS).index("stick_duration_median")
    told = [data[kind][row] for kind in ("estimate", "standard_error", "interval_low", "interval_high")]
    batches = [np.array([d for path in paths[first::32] for d in path.sticks]) for first in range(32)]
    t = student(31)

    def share(longest):
        """The share of sticks no longer than this, and half the width of its interval."""
        below = np.array([(batch <= longest).sum() for batch in batches])
        of = np.array([len(batch) for batch in batches])
        estimate = below.sum() / of.sum()
        return estimate, t * math.sqrt(32 / 31 * ((below - estimate * of) ** 2).sum()) / of.sum()

    if not data.has_step:
        median = np.quantile(durations, 0.5)
        _, reach = share(median)
        low, high = (np.quantile(durations, p) for p in (0.5 - reach, 0.5 + reach))
        # Neighbouring sticks are this far apart.
        near = 3 * (high - low) / (2 * reach * len(durations))
        wanted, allowed = [median, (high - low) / (2 * t), low, high], [near] * 4
    else:
        batches = [in_steps(data, batch) for batch in batches]
        ordered = np.sort(in_steps(data, durations))
        median = ordered[math.ceil(len(ordered) / 2) - 1]
        _, reach = share(median)
        # The quantiles of the law that is spread evenly over half a step to either side of each multiple.
        values, counts = np.unique(ordered, return_counts=True)
        corners = np.column_stack([values - 0.5, values + 0.5]).ravel()
        heights = np.column_stack([np.cumsum(counts) - counts, np.cumsum(counts)]).ravel()
        spread = [np.interp(p * len(ordered), heights, corners) for p in (0.5 - reach, 0.5 + reach)]
        # A multiple m is refuted if F(m) is certainly below 1/2, or F(m - 1) certainly not.
        possible = [m for m in np.arange(values[0], values[-1] + 1) if sum(share(m)) >= 0.5 and np.subtract(*share(m - 1)) < 0.5]
        wanted = [median, (spread[1] - spread[0]) / (2 * t), possible[0], possible[-1]]
        wanted, allowed = [data.spacing * number for number in wanted], [1e-6 * data.spacing] * 4
    for kind, a, b, near in zip(("estimate", "error", "low", "high"), told, wanted, allowed, strict=True):
        check(abs(a - b) <= near, f"stick_duration_median, {kind}: {a!r}, not {b!r}")


class Data(dict):
    """The variables of a file, and what it says of itself."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.attributes = dict(file.attrs)
            units = {}
            for name, dataset in file.items():
                values = dataset[()]
                self[name] = np.array([text.decode() for text in values]) if dataset.dtype.kind == "O" else values
                units[name] = dataset.attrs.get("units")
        for name, unit in units.items():
            check(name in UNIT, f"{name} is in the file, and not in the list of this test")
            check(unit == UNIT[name], f"{name}: unit {unit!r}, not {UNIT[name]!r}")
        self.scenario = tomllib.loads(self.attributes["scenario"])
        self.spacing = self.scenario["time"]["output_step"]
        self.has_step = "step" in self.attributes

    def events(self):
        ends = np.cumsum(self["event_count"].astype(int))[:-1]
        parts = {name: np.split(self[f"event_{name}"], ends) for name in ("time", "displacement", "force", "sign", "kind")}
        return [{name: part[i] for name, part in parts.items()} for i in range(len(self["event_count"]))]


def check_header(data):
    attributes, scenario = data.attributes, data.scenario
    ensemble = scenario["ensemble"]
    check(ensemble["seed"] != 1, "the seed of this test is not that of the shipped scenarios")
    for name, wanted in [
        ("seed", ensemble["seed"]),
        ("paths", ensemble["paths"]),
        ("completed_paths", ensemble["paths"]),
        ("diverged_paths", 0),
        ("status", "complete"),
        ("scheme", scenario["scheme"]["kind"]),
        ("title", scenario["title"]),
        ("time_unit", "s"),
        ("length_unit", "mm"),
        ("force_unit", "N"),
        ("temperature_unit", "K"),
    ]:
        check(attributes[name] == wanted, f"attribute {name}: {attributes[name]!r}, not {wanted!r}")
    check(attributes.get("step") == scenario["time"].get("step") or not data.has_step, "attribute step")


def check_run(path):
    data = Data(path)
    check_header(data)
    steps = round(data.scenario["time"]["end"] / data.spacing)
    same("time", data["time"], data.spacing * np.arange(steps + 1))
    same("quantile", data["quantile"], LEVELS)
    same("event_count", data["event_count"], [len(of["time"]) for of in data.events()])
    check(len(data["trajectory"]) == len(data["path"]), "the trajectories of all paths are there")
    events = data.events()
    paths = [Path(data.scenario, of, end) for of, end in zip(events, data["trajectory_displacement"][:, -1], strict=True)]
    check_events(data, paths, events, data.has_step and data.attributes["step"] == data.spacing)
    check_trajectories(data, events)
    check_bands(data)
    check_durations(data, paths)
    check_sub_phases(data, paths)
    times, x = check_periods(data)
    check_paths(data, paths)
    check_statistics(data, paths, times, x)
    check(set(data) == checked, f"not recomputed: {sorted(set(data) - checked)}; absent: {sorted(checked - set(data))}")
    checked.clear()
    print(f"  {len(data)} variables of {len(paths)} paths are what they should be")
    return data


def check_replay(path, run):
    data = Data(path)
    check(len(data["path"]) == 1, "a replay is one path")
    number = int(data["path"][0])
    check(number > 0 and list(data["trajectory"]) == [number], f"trajectory: {data['trajectory']}, not {number}")
    check(data.attributes["seed"] == run.attributes["seed"], "the seed of a replay is that of the run")
    (here,) = data.events()
    there = run.events()[number]
    for name, values in here.items():
        check(np.array_equal(values, there[name]), f"event_{name} of path {number}")
    for name in [name for name in run if name.startswith("path")]:
        check(np.array_equal(data[name][0], run[name][number], equal_nan=True), f"{name} of path {number}")
    # On the instants that both are looked at.
    times = {round(t, 9): i for i, t in enumerate(data["time"])}
    rows = [times[round(t, 9)] for t in run["time"]]
    for name in [name for name in run if name.startswith("trajectory_")]:
        check(np.array_equal(data[name][0, rows], run[name][number]), f"{name} of path {number}")
    print(f"  path {number} is that of the run")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    try:
        if sys.argv[1] == "--bias":
            sys.exit(check_bias(sys.argv[2]))
        print(sys.argv[1])
        ensemble = check_run(sys.argv[1])
        for replay in sys.argv[2:]:
            print(replay)
            check_replay(replay, ensemble)
    except AssertionError as error:
        sys.exit(f"not what it should be: {error}")

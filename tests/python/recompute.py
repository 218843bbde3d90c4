"""Recompute every variable of a file of `mc run` from its events, its trajectories and its
scenario, and compare its units with a list.

    target/venv/bin/python tests/python/recompute.py RUN.h5 [REPLAY.h5 ...]

RUN.h5 has the events and the trajectories of all its paths (`record.events=true`, and
`record.trajectories` as many as there are paths), none of which is lost, on an output grid that
contains the ends of the forcing periods. Its unit labels are s, mm, N and K. REPLAY.h5 is a replay
of one of its paths. The program here does not use the sums of the other one: it computes each
number from all values at once, by its definition.

Exits with 1 at the first variable that is wrong, and names it.
"""

import csv
import datetime
import functools
import math
import sys
import tomllib

import h5py
import numpy as np

# The unit of every variable, in UDUNITS notation; None where it has none.
UNITS = {
    None: """statistic statistic_long_name statistic_unit estimate standard_error interval_low interval_high bias bias_uncertainty
        bias_order estimate_corrected estimate_corrected_low estimate_corrected_high bound law law_long_name law_unit law_lower law_upper
        law_quantile path_diverged event event_sign event_kind trajectory_static
        cycle cycle_number""",
    "1": """quantile static_probability law_bin law_count law_censored_count law_survival law_completed law_censored first_stick_duration_completed first_stick_duration_censored
        sub_phase sub_phase_count sub_phase_share sub_phase_censored transient_sticks transient_slips period path path_sticks path_slips path_sub_phases event_count trajectory section_state""",
    "s": """time series_time period_time path_first_stick_duration path_stick_time
        event_time transient_end""",
    "mm": """transient_displacement transient_displacement_error
        displacement_mean displacement_sd displacement_quantile displacement_period_mean path_displacement_end
        path_max_displacement event_displacement trajectory_displacement trajectory_bearing_displacement section""",
    "mm2": "displacement_period_variance",
    "mm s-1": "drift_velocity_limit velocity_mean velocity_sd velocity_quantile trajectory_velocity",
    "N": "event_force trajectory_force trajectory_friction",
    "N mm": "path_friction_work",
    "K": "temperature_mean temperature_sd temperature_quantile trajectory_temperature series_temperature",
}
UNIT = {name: unit for unit, names in UNITS.items() for name in names.split()}

# Variables that are estimated from the paths have an interval in their own unit.
WITH_INTERVAL = """displacement_mean displacement_sd displacement_quantile velocity_mean velocity_sd velocity_quantile temperature_mean
    temperature_sd temperature_quantile static_probability law_survival law_quantile
    sub_phase_share displacement_period_mean displacement_period_variance transient_displacement""".split()
UNIT |= {f"{name}_interval": UNIT[name] for name in WITH_INTERVAL}

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
    "period_displacement_mean": "mm",
    "period_displacement_sd": "mm",
    "period_displacement_correlation": "1",
    "phase_displacement_sd": "mm",
    "jump_mean": "mm",
    "jump_abs_mean": "mm",
    "friction_work_mean": "N mm",
    "sliding_path_rate": "mm s-1",
}

LEVELS = [0.05, 0.25, 0.5, 0.75, 0.95]
ENTERED, STARTED, TURNED = 0, 1, 2

# The tolerance for sums of thousands of numbers in another order.
ROUNDING = 1e-11

checked = set()


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def same(name, got, wanted, within=ROUNDING):
    """Each number of a variable equals the expected one, up to a share of the largest of them. NaN
    equals NaN."""
    got, wanted = np.asarray(got, dtype=float), np.asarray(wanted, dtype=float)
    check(got.shape == wanted.shape, f"{name}: shape {got.shape}, not {wanted.shape}")
    check(bool((np.isnan(got) == np.isnan(wanted)).all()), f"{name}: other numbers are missing")
    finite = np.isfinite(wanted)
    if finite.any():
        off = np.abs(got[finite] - wanted[finite])
        worst = int(np.argmax(off))
        scale = np.abs(wanted[finite]).max()
        check(
            off[worst] <= within * scale,
            f"{name}: {got[finite][worst]!r}, not {wanted[finite][worst]!r}",
        )
    checked.add(name)


@functools.cache
def student(freedom):
    """The 97.5 % quantile of Student's t. With x = sqrt(freedom) tan(angle) the density is
    proportional to cos(angle)^(freedom - 1), which is integrated by Simpson's rule up to 47.5 %."""
    constant = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2)) / math.sqrt(
        math.pi
    )
    weights = np.array([1] + [4, 2] * 199 + [4, 1]) / 3
    low, high = 0.0, math.pi / 2
    for _ in range(60):
        middle = (low + high) / 2
        angles = np.linspace(0, middle, 401)
        share = constant * (weights * np.cos(angles) ** (freedom - 1)).sum() * middle / 400
        low, high = (middle, high) if share < 0.475 else (low, middle)
    return math.sqrt(freedom) * math.tan((low + high) / 2)


def wilson(share, n, t=1.959963984540054):
    """The ends of the interval of shares s with (share - s)^2 <= t^2 s (1 - s)/n, by bisection from
    either side."""
    share, n = np.broadcast_arrays(np.asarray(share, dtype=float), np.asarray(n, dtype=float))
    ends = []
    for outside in (np.zeros_like(share), np.ones_like(share)):
        out, within = outside.copy(), share.copy()
        for _ in range(80):
            middle = (out + within) / 2
            is_within = (share - middle) ** 2 <= t**2 * middle * (1 - middle) / n
            out, within = np.where(is_within, out, middle), np.where(is_within, middle, within)
        ends.append(within)
    return ends


def same_interval(data, name, low, high, within=1e-8):
    """The ends of an interval equal the expected ones, and the estimate is between them."""
    for end, wanted in (("low", low), ("high", high)):
        got, wanted = (
            np.asarray(data[f"{name}_{end}"], dtype=float),
            np.asarray(wanted, dtype=float),
        )
        infinite = np.isinf(wanted)
        check(
            bool((got[infinite] == wanted[infinite]).all()) if got.shape else True,
            f"{name}_{end}: not infinite",
        )
        same(f"{name}_{end}", np.where(infinite, 0, got), np.where(infinite, 0, wanted), within)
    below, above = data[f"{name}_low"] <= data[name], data[name] <= data[f"{name}_high"]
    check(bool(np.all(below & above)), f"{name}: the estimate is in its interval")


def holds(data, name):
    """The interval holds the estimate. Its rule for skewed numbers and for spreads is compared with closed
    forms in the tests of the library."""
    low, high = data[f"{name}_low"], data[f"{name}_high"]
    inside = (low <= data[name]) & (data[name] <= high)
    check(bool(np.all(inside | np.isnan(low))), f"{name}: the estimate is in its interval")
    checked.update([f"{name}_low", f"{name}_high"])


def in_batches(paths, of):
    """The sum over the paths of each of 32 batches. A batch has the paths whose numbers have the
    same remainder modulo 32."""
    return np.array(
        [sum(np.asarray(of(path), dtype=float) for path in paths[first::32]) for first in range(32)]
    )


def share_interval(parts, wholes, contributing):
    """The interval of sum parts/sum wholes over batches, along the last axis of the parts."""
    share = parts.sum(axis=0) / wholes.sum()
    error = np.sqrt(32 / 31 * ((parts - np.outer(wholes, share)) ** 2).sum(axis=0)) / wholes.sum()
    is_sure = error < 1e-12
    n = np.where(is_sure, max(wholes.sum(), contributing), share * (1 - share) / np.where(is_sure, 1, error) ** 2)
    few, many = wilson(share, n), wilson(share, n, student(31))
    return [np.where(is_sure, a, b) for a, b in zip(few, many, strict=True)]


class Path:
    """What follows from the events of one path, its place at the end, and that at the end of the
    burn-in. Phases that begin after the burn-in are counted, and time and way from there on."""

    def __init__(self, scenario, events, end, after, place_after):
        self.t_end, x0 = scenario["time"]["end"], scenario["initial"]["displacement"]
        f_d = scenario["friction"]["dynamic"]
        self.sticks, self.first, self.censored_stick = [], math.nan, None
        self.jumps, self.counts = [], []
        self.stick_time, self.travel, self.early_sticks, self.early_slips = 0.0, 0.0, 0, 0
        self.early_displacement = place_after - x0
        is_first, entered, origin, x, k = True, 0.0, x0, x0, None
        began, slid = 0.0, 0.0
        self.largest = max(abs(x0), abs(end))
        for time, displacement, kind in zip(
            events["time"], events["displacement"], events["kind"], strict=True
        ):
            check(
                (k is None) == (kind == STARTED),
                "a slip starts from a stick, and turns or ends in a slip",
            )
            # Between events the body moves in one direction only.
            self.travel += (
                abs(displacement - x)
                if began >= after
                else abs(displacement - place_after)
                if time > after
                else 0.0
            )
            began = time
            check(k is not None or displacement == x, "the body rests in a stick")
            x, self.largest = displacement, max(self.largest, abs(displacement))
            if kind == STARTED:
                duration = time - entered
                self.stick_time += max(0.0, time - max(entered, after))
                if is_first:
                    self.first, is_first = duration, False
                elif entered >= after:
                    self.sticks.append(duration)
                else:
                    self.early_sticks += 1
                origin, slid, k = x, time, 1
            elif kind == TURNED:
                k += 1
            else:
                if slid >= after:
                    self.jumps.append(x - origin)
                    self.counts.append(k)
                else:
                    self.early_slips += 1
                entered, k = time, None
        if k is None:
            self.stick_time += self.t_end - max(entered, after)
            self.censored_stick = None if is_first or entered < after else self.t_end - entered
        self.is_first_censored, self.is_slip_censored = is_first, k is not None and slid >= after
        self.travel += abs(end - (x if began >= after else place_after))
        self.end, self.work = end, f_d * self.travel


def check_events(data, paths, events, is_on_grid):
    """The signs of events agree with the motion that follows, their forces with the thresholds and,
    where every step is kept, with the trajectories."""
    friction, oscillator = data.scenario["friction"], data.scenario["oscillator"]
    moves = 0
    for path, of in zip(paths, events, strict=True):
        places = np.append(of["displacement"], path.end)
        for i, (sign, kind, force) in enumerate(
            zip(of["sign"], of["kind"], of["force"], strict=True)
        ):
            check(
                (sign == 0) == (kind == ENTERED),
                "event_sign: 0 where a stick starts, and nowhere else",
            )
            change = places[i + 1] - places[i]
            if kind == ENTERED:
                # The quasi-static recursion does not require it: where friction does not hold the
                # body, the stick has no duration.
                holds = (
                    abs(force) <= friction["static"] * (1 + 1e-12)
                    or data.attributes["scheme"] == "quasi-static"
                )
                check(holds, f"event_force: {force} holds no stick")
                check(change == 0, "the body rests in a stick")
                continue
            check(sign * change >= 0, f"event_sign: {sign}, and the body moves by {change}")
            moves += sign * change > 0
            check(sign * force > 0, f"event_force: {force} against a motion of sign {sign}")
            # A step may pass a turn, and a stick ends at the last instant before the force is too
            # large.
            if not data.has_step:
                check(
                    abs(force) >= friction["static"] * (1 - 1e-9),
                    f"event_force: {force} moves nothing",
                )
    check(moves > 1000, f"event_sign: {moves} of the sub-phases move")
    if is_on_grid:
        k, alpha = oscillator["stiffness"], oscillator["damping"]
        rows = [np.rint(of["time"] / data.spacing).astype(int) for of in events]
        for path, (of, at) in enumerate(zip(events, rows, strict=True)):
            same("event_time", of["time"], at * data.spacing)
            same(
                "event_displacement", of["displacement"], data["trajectory_displacement"][path, at]
            )
            b = k * (
                oscillator["dilatation"] * data["trajectory_temperature"][path, at]
                - of["displacement"]
            )
            velocity = np.where(of["kind"] == TURNED, data["trajectory_velocity"][path, at], 0)
            at_rest = (of["kind"] == TURNED) & (velocity == 0)
            check(
                bool((np.abs(of["force"][at_rest]) > friction["static"]).all()),
                "event_force: a turn at rest that is a stick",
            )
            same("event_force", of["force"], b - 2 * alpha * velocity)
    checked.update(
        ["event_time", "event_displacement", "event_force", "event_sign", "event_kind", "event"]
    )


def holding_force(data):
    """The force up to which a scheme with a step holds a body at rest: f_s, or for the corrected
    scheme less the overshoot of a barrier that is looked at once a step, -zeta(1/2)/sqrt(2 pi)
    standard deviations of the force in a step, but no less than f_d."""
    friction, oscillator = data.scenario["friction"], data.scenario["oscillator"]
    if data.scenario["scheme"]["kind"] != "corrected-vi":
        return friction["static"]
    noise = data.scenario["temperature"]["noise"]
    in_a_step = noise["intensity"] * noise["diffusion"] * math.sqrt(data.attributes["step"])
    shift = 0.5825971579390107 * oscillator["stiffness"] * abs(oscillator["dilatation"]) * in_a_step
    return max(friction["static"] - shift, friction["dynamic"])


def check_trajectories(data, events):
    """b and F of the trajectories follow from their formulas, with the phases of the events."""
    friction, oscillator = data.scenario["friction"], data.scenario["oscillator"]
    time, x, v = data["time"], data["trajectory_displacement"], data["trajectory_velocity"]
    b = (
        oscillator["stiffness"] * (oscillator["dilatation"] * data["trajectory_temperature"] - x)
        - 2 * oscillator["damping"] * v
    )
    same("trajectory_force", data["trajectory_force"], b)
    static, sign = np.ones(x.shape, dtype=bool), np.zeros(x.shape)
    for path, of in enumerate(events):
        # A stick and a sub-phase include the instant at which they begin, and not that at which
        # they end.
        begins = np.searchsorted(time, of["time"], "left")
        for first, kind, direction in zip(begins, of["kind"], of["sign"], strict=True):
            static[path, first:] = kind == ENTERED
            sign[path, first:] = direction
    if data.has_step:
        # A stick ends at the instant from which the force no longer holds the body. At the end of
        # the run that shows in the row only, because the event is found in the next step.
        is_left = static[:, -1] & (np.abs(b[:, -1]) > holding_force(data))
        static[is_left, -1], sign[is_left, -1] = False, np.sign(b[is_left, -1])
    same("trajectory_static", data["trajectory_static"], static)
    check(bool((v[static] == 0).all()), "trajectory_velocity: zero in a stick")
    same(
        "trajectory_friction",
        data["trajectory_friction"],
        np.where(static, b, friction["dynamic"] * sign),
    )
    bearing = data.scenario["bearing"]
    shown = (
        bearing["offset"]
        + x
        + np.where(static, b, friction["dynamic"] * sign) / bearing["stiffness"]
    )
    same("trajectory_bearing_displacement", data["trajectory_bearing_displacement"], shown)
    # The way is the integral of the velocity. The trapezoidal rule has an error of h^2/12 times the
    # change of the force; in a scheme with a step it is h/2 times that change.
    way = np.diff(x, axis=1) - np.diff(time) * 0.5 * (v[:, 1:] + v[:, :-1])
    largest = np.abs(b).max() / oscillator["mass"]
    check(
        bool((np.abs(way) <= largest * data.spacing**2).all()),
        "trajectory_velocity: the rate of the displacement",
    )
    harmonics = data.scenario["temperature"]["harmonics"]
    mean = sum(
        h["amplitude"] * np.cos(h["angular_frequency"] * time + h["phase"]) for h in harmonics
    )
    noise = data["trajectory_temperature"] - mean
    # v(0) = 0, and later v has the law of the noise. The bound for its variance is 5 standard
    # errors, 5 sqrt(2/paths).
    parts = data.scenario["temperature"]["noise"]
    theta, amplitude = parts["relaxation_rate"], parts["intensity"] * parts["diffusion"]
    variance = amplitude**2 * (1 - np.exp(-2 * theta * time)) / (2 * theta)
    allowed = 5 * math.sqrt(2 / len(noise)) * variance + 1e-20
    check(
        bool((np.abs((noise**2).mean(axis=0) - variance) <= allowed).all()),
        "trajectory_temperature: the variance of the noise",
    )
    checked.update(["trajectory_displacement", "trajectory_velocity", "trajectory_temperature"])


def check_bands(data):
    for name in ("displacement", "velocity", "temperature"):
        rows = data[f"trajectory_{name}"]
        same(f"{name}_mean", data[f"{name}_mean"], rows.mean(axis=0))
        same(f"{name}_sd", data[f"{name}_sd"], rows.std(axis=0, ddof=1), 1e-9)
        check_band_intervals(data, name, rows)
        check_quantiles(f"{name}_quantile", data[f"{name}_quantile"], rows)
    same("static_probability", data["static_probability"], data["trajectory_static"].mean(axis=0))
    low, high = wilson(data["static_probability"], len(data["trajectory_static"]))
    if data.scenario["temperature"]["noise"]["initial"] != "stationary":
        # Whether a path is static at t = 0 is the same for all.
        low[0] = high[0] = data["static_probability"][0]
    same_interval(data, "static_probability", low, high)


def check_band_intervals(data, name, rows):
    """The intervals of means, standard deviations and shares along time. Where all paths agree by
    chance at a time after t = 0, the spread of other paths is not known, and an interval has no
    upper end. Temperatures never agree by chance."""
    n, sd = len(rows), rows.std(axis=0, ddof=1)
    agree = (rows == rows[0]).all(axis=0)
    starts = (np.arange(rows.shape[1]) == 0) | (name == "temperature")
    reach = student(n - 1) * sd / math.sqrt(n)
    reach = np.where(agree, np.where(starts, 0, np.inf), reach)
    same_interval(data, f"{name}_mean", rows.mean(axis=0) - reach, rows.mean(axis=0) + reach)
    holds(data, f"{name}_sd")
    wanted = []
    for level in LEVELS:
        reach = 1.959963984540054 * math.sqrt(level * (1 - level) / n)
        for p in (level - reach, level + reach):
            wanted.append(
                np.quantile(rows, p, axis=0)
                if 0 < p < 1
                else np.full(rows.shape[1], np.sign(p) * np.inf)
            )
    low, high = np.array(wanted[::2]), np.array(wanted[1::2])
    low[:, agree & starts] = high[:, agree & starts] = rows[0, agree & starts]
    same_interval(data, f"{name}_quantile", low, high)


def check_quantiles(name, got, values):
    """The quantiles, with levels along rows and times along columns, lie between the neighbouring
    order statistics; with so few paths every value is kept."""
    check(got.shape == (len(LEVELS), *values.shape[1:]), f"{name}: axes {got.shape}")
    ordered = np.sort(values, axis=0)
    for level, row in zip(LEVELS, got, strict=True):
        rank = level * (len(values) - 1)
        below, above = ordered[math.floor(rank)], ordered[math.ceil(rank)]
        is_between = (below - ROUNDING * np.abs(below) <= row) & (
            row <= above + ROUNDING * np.abs(above)
        )
        check(bool(np.all(is_between)), f"{name} at {level}: not between {below} and {above}")
    checked.add(name)


def check_durations(data, paths):
    durations = np.array([d for path in paths for d in path.sticks])
    cut = np.array([path.censored_stick for path in paths if path.censored_stick is not None])
    lower, upper = data["law_lower"], data["law_upper"]
    check(
        bool((lower[1:] == upper[:-1]).all() and (lower < upper).all()),
        "law_upper: the bins touch",
    )
    count = lambda values: [
        int(((lo <= values) & (values < hi)).sum()) for lo, hi in zip(lower, upper, strict=True)
    ]
    same("law_count", data["law_count"], count(durations))
    same("law_censored_count", data["law_censored_count"], count(cut))
    # The product of Kaplan and Meier over the sticks in the order of their durations. At equal
    # durations, sticks that end come before those that are cut off.
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
    # Sticks that are cut off in a bin count as longer than those that end in it, which concerns
    # some in a thousand.
    check(
        float(np.abs(data["law_survival"] - curve).max()) < 0.002,
        "law_survival",
    )
    if data.has_step:
        # Quantiles of a discrete law: the smallest multiple of the step that at least this share of
        # the sticks does not exceed.
        ordered = np.sort(in_steps(data, durations))
        smallest = [ordered[math.ceil(level * len(ordered) - 1e-9) - 1] for level in LEVELS]
        same(
            "law_quantile",
            data["law_quantile"],
            np.array(smallest) * data.spacing,
        )
    else:
        check_quantiles("law_quantile", data["law_quantile"], durations)
    for name, number in [
        ("law_completed", len(durations)),
        ("law_censored", len(cut)),
        ("first_stick_duration_completed", sum(not path.is_first_censored for path in paths)),
        ("first_stick_duration_censored", sum(path.is_first_censored for path in paths)),
    ]:
        same(name, data[name], number)
    checked.update(["law_upper", "law_lower", "law_survival"])
    check_duration_intervals(data, paths, count)


def check_duration_intervals(data, paths, count):
    contributing = sum(len(path.sticks) > 0 for path in paths)
    def survival(paths):
        """The survival curve computed bin by bin of the file, which is near the curve of the file."""
        ended = np.array(count(np.array([d for path in paths for d in path.sticks])))
        cut = np.array(
            count(
                np.array([path.censored_stick for path in paths if path.censored_stick is not None])
            )
        )
        at_risk = (ended + cut)[::-1].cumsum()[::-1]
        return np.cumprod(1 - ended / np.maximum(at_risk, 1)), at_risk - ended - cut

    curve, at_risk = survival(paths)
    without = np.array(
        [survival([p for i, p in enumerate(paths) if i % 32 != batch])[0] for batch in range(32)]
    )
    error = np.sqrt(31 / 32 * ((without - without.mean(axis=0)) ** 2).sum(axis=0))
    is_sure = error < 1e-12
    told = data["law_survival"]
    n = np.where(
        is_sure,
        np.clip(at_risk, 1, contributing),
        curve * (1 - curve) / np.where(is_sure, 1, error) ** 2,
    )
    few, many = wilson(told, np.maximum(n, 1e-9)), wilson(told, np.maximum(n, 1e-9), student(31))
    for end, a, b in zip(("low", "high"), few, many, strict=True):
        got = data[f"law_survival_{end}"]
        off = np.abs(got - np.where(is_sure, a, b))[told > 0]
        check(float(off.max()) < 0.01, f"law_survival_{end}: off by {off.max()}")
    check(
        bool(
            (data["law_survival_low"] <= told).all()
            and (told <= data["law_survival_high"]).all()
        ),
        "survival in its interval",
    )
    ended = told == 0
    check(
        bool((data["law_survival_low"][ended] == 0).all()),
        "law_survival_low: 0 where none is left",
    )
    check(
        bool(
            (data["law_survival_high"] <= 1).all()
            and (data["law_survival_high"] > 0).all()
        ),
        "law_survival_high",
    )
    checked.update(["law_survival_low", "law_survival_high"])


def check_sub_phases(data, paths):
    counts = np.array([k for path in paths for k in path.counts])
    most = len(data["sub_phase"])
    same("sub_phase", data["sub_phase"], np.arange(1, most + 1))
    same(
        "sub_phase_count",
        data["sub_phase_count"],
        np.bincount(np.minimum(counts, most), minlength=most + 1)[1:],
    )
    same("sub_phase_share", data["sub_phase_share"], data["sub_phase_count"] / len(counts))
    same(
        "sub_phase_censored",
        data["sub_phase_censored"],
        sum(path.is_slip_censored for path in paths),
    )
    by_k = in_batches(
        paths,
        lambda path: np.bincount(np.minimum(path.counts, most).astype(int), minlength=most + 1)[1:],
    )
    ends = share_interval(by_k, by_k.sum(axis=1), sum(len(path.counts) > 0 for path in paths))
    same_interval(data, "sub_phase_share", *ends)
    # In the quasi-static recursion each slip has one sub-phase.
    is_recursion = data.attributes["scheme"] == "quasi-static"
    check(
        (counts > 1).sum() > 100 or is_recursion,
        "the scene has dynamic phases of several sub-phases",
    )


def check_periods(data):
    # The temperature has no trend.
    same("drift_velocity_limit", data["drift_velocity_limit"][()], 0.0)
    frequency = next(
        h["angular_frequency"]
        for h in data.scenario["temperature"]["harmonics"]
        if h["angular_frequency"] > 0
    )
    period = 2 * math.pi / frequency
    number = math.floor(data.scenario["time"]["end"] / period + 1e-9)
    times = period * np.arange(1, number + 1)
    same("period", data["period"], np.arange(1, number + 1))
    same("period_time", data["period_time"], times)
    rows = np.rint(times / data.spacing).astype(int)
    check(
        bool((np.abs(data["time"][rows] - times) < 1e-9).all()),
        "the output grid passes through the ends of the periods",
    )
    x = data["trajectory_displacement"][:, rows] - data.scenario["initial"]["displacement"]
    same("displacement_period_mean", data["displacement_period_mean"], x.mean(axis=0))
    same(
        "displacement_period_variance", data["displacement_period_variance"], x.var(axis=0, ddof=1)
    )
    holds(data, "displacement_period_mean")
    holds(data, "displacement_period_variance")
    return times, x


def check_transient(data, paths):
    """The variables of the burn-in, which are absent without one."""
    if data.after == 0:
        return
    moved = np.array([path.early_displacement for path in paths])
    error = moved.std(ddof=1) / math.sqrt(len(moved))
    for name, wanted in [
        ("end", data.after),
        ("sticks", sum(path.early_sticks for path in paths)),
        ("slips", sum(path.early_slips for path in paths)),
        ("displacement", moved.mean()),
        ("displacement_error", error),
    ]:
        same(f"transient_{name}", data[f"transient_{name}"], wanted, 1e-8)
    holds(data, "transient_displacement")
    check(
        data["transient_sticks"] > 100 and data["transient_slips"] > 100,
        "the burn-in leaves something out",
    )


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
    # The maximum is searched at events only, and the corrected step from a turn to the next instant
    # has the new velocity. So h times the velocity of a step may be missing.
    largest = np.abs(data["trajectory_displacement"]).max(axis=1)
    hardest = (
        np.abs(data["trajectory_force"]).max() + data.scenario["friction"]["dynamic"]
    ) / data.scenario["oscillator"]["mass"]
    missing = (
        data.attributes["step"] ** 2 * hardest
        if data.attributes["scheme"] == "corrected-vi"
        else 1e-9
    )
    check(
        bool((data["path_max_displacement"] >= largest - missing).all()),
        "path_max_displacement: nothing is farther out",
    )


def check_statistics(data, paths, times, x):
    """Estimates, standard errors and intervals, with the path as the independent unit."""
    n = len(paths)
    counted_time = data.scenario["time"]["end"] - data.after
    column = lambda of: np.array([float(of(path)) for path in paths])

    def mean(values):
        return values.mean(), values.std(ddof=1) / math.sqrt(len(values)), len(values) - 1

    def pooled(tops, bottoms, estimate=None):
        """sum/sum, whose residuals are those of the paths that put something into the pool."""
        ratio = tops.sum() / bottoms.sum() if estimate is None else estimate
        residuals = tops - (ratio * bottoms if estimate is None else 0)
        m = int((bottoms > 0).sum())
        error = math.sqrt(m / (m - 1) * (residuals**2).sum()) / bottoms.sum()
        return ratio, error

    def number(values):
        return mean(values)

    durations = np.concatenate([path.sticks for path in paths])
    sticks = column(lambda p: len(p.sticks))
    centre, sd = durations.mean(), durations.std()
    spread = column(lambda p: sum((d - centre) ** 2 - sd**2 for d in p.sticks)) / (2 * sd)
    counted = times >= data.after
    times, x = times[counted], x[:, counted]
    # Displacements from period to period, and the influence of each path on their standard
    # deviation and on the correlation of neighbouring periods.
    u = np.diff(x, axis=1)
    about, pairs = u - u.mean(), np.stack([u[:, :-1], u[:, 1:]])
    u_sd = u.std()
    on_sd = ((about**2).mean(axis=1) - u_sd**2) / (2 * u_sd)
    # The correlation is that of the pairs, about the mean of their members.
    members = pairs - pairs.mean()
    variance = (members**2).mean()
    correlation = (members[0] * members[1]).mean() / variance
    on_correlation = (members[0] * members[1]).mean(axis=1) / variance - correlation * (
        members**2
    ).mean(axis=(0, 2)) / variance
    slips = column(lambda p: len(p.jumps))
    ends = column(lambda p: p.end)
    squares = (ends - ends.mean()) ** 2
    first = column(lambda p: 0 if p.is_first_censored else p.first)
    weights = (times - times.mean()) / ((times - times.mean()) ** 2).sum()
    block = int(data.attributes["block_size"])
    shares, shares_at_phase = [], []
    influences = {"period_displacement_sd": [], "phase_displacement_sd": []}
    for begin in range(0, n, block):
        part = x[begin : begin + block]
        squares_of_part = (part - part.mean(axis=0)) ** 2 * len(part) / (len(part) - 1)
        shares.extend(squares_of_part @ weights)
        shares_at_phase.extend(squares_of_part.mean(axis=1))
        influences["phase_displacement_sd"].append(
            squares_of_part.mean(axis=1) - squares_of_part.mean()
        )
        displacements = np.diff(part, axis=1)
        about_part = ((displacements - displacements.mean()) ** 2).mean(axis=1)
        influences["period_displacement_sd"].append(about_part - about_part.mean())
    phase_sd = math.sqrt(x.var(axis=0, ddof=1).mean())
    diffusion = 0.5 * float(weights @ x.var(axis=0, ddof=1))
    found = {
        "stick_duration_mean": pooled(column(lambda p: sum(p.sticks)), sticks),
        "stick_duration_sd": pooled(spread, sticks, sd),
        "first_stick_duration_mean": pooled(first, column(lambda p: not p.is_first_censored)),
        "sticks_per_path": number(sticks),
        "slips_per_path": number(slips),
        "sub_phases_mean": pooled(column(lambda p: sum(p.counts)), slips),
        "sub_phases_multiple_share": pooled(column(lambda p: sum(k > 1 for k in p.counts)), slips),
        "sticking_fraction": number(column(lambda p: p.stick_time) / counted_time),
        "displacement_end_mean": mean(ends),
        "displacement_end_sd": (
            ends.std(ddof=1),
            math.sqrt(((squares - squares.mean()) ** 2).sum() / (n * (n - 1)))
            / (2 * ends.std(ddof=1)),
            n - 1,
        ),
        "drift_velocity": mean(x @ weights),
        "diffusion_coefficient": (diffusion, 0.5 * mean(np.array(shares))[1], n - 1),
        "period_displacement_mean": mean(u.mean(axis=1)),
        "period_displacement_sd": (u_sd, mean(on_sd)[1], n - 1),
        "period_displacement_correlation": (correlation, mean(on_correlation)[1], n - 1),
        "phase_displacement_sd": (
            phase_sd,
            mean(np.array(shares_at_phase))[1] / (2 * phase_sd),
            n - 1,
        ),
        "jump_mean": pooled(column(lambda p: sum(p.jumps)), slips),
        "jump_abs_mean": pooled(column(lambda p: sum(abs(jump) for jump in p.jumps)), slips),
        "friction_work_mean": mean(column(lambda p: p.work)),
        "sliding_path_rate": mean(column(lambda p: p.travel) / counted_time),
    }
    check(list(data["statistic"]) == list(STATISTICS), "statistic: the names, in their order")
    check(list(data["statistic_unit"]) == list(STATISTICS.values()), "statistic_unit")
    for row, name in enumerate(STATISTICS):
        check(data["statistic_long_name"][row], f"statistic_long_name of {name}")
        told = [
            data[kind][row]
            for kind in ("estimate", "standard_error", "interval_low", "interval_high")
        ]
        if name in found:
            value, error = found[name][:2]
            # The errors of spreads are those of the jackknife, which the tests of the library compute.
            is_mean = not name.endswith(("_sd", "_correlation", "diffusion_coefficient"))
            for kind, a, b in [("estimate", told[0], value), ("error", told[1], error)][: 1 + is_mean]:
                scale = abs(value) + error
                check(a == b or abs(a - b) <= 1e-7 * scale, f"{name}, {kind}: {a!r}, not {b!r}")
            low, high = told[2:]
            check(np.isnan(low) or low <= told[0] <= high, f"{name}: the estimate is in its interval")
    check_median(data, paths, durations)
    check_corrected(data)
    checked.update(
        """statistic statistic_long_name statistic_unit estimate standard_error interval_low interval_high bias
        bias_uncertainty bias_order""".split()
    )


def check_corrected(data):
    """The corrected estimate is the estimate less max(0, 1 - (uncertainty/bias)^4) of its bias; its
    interval is that of the estimate less the whole bias."""
    if "estimate_corrected" not in data:
        for name in ("bias", "bias_uncertainty", "bias_order"):
            check(bool(np.isnan(data[name]).all()), f"{name}: the run was told not to estimate it")
        return 0
    corrected = 0
    for row, name in enumerate(data["statistic"]):
        estimate, bias, uncertainty = (
            data[kind][row] for kind in ("estimate", "bias", "bias_uncertainty")
        )
        weight = 0.0 if abs(bias) <= uncertainty else 1 - (uncertainty / bias) ** 4
        below, above = estimate - data["interval_low"][row], data["interval_high"][row] - estimate
        whole = estimate - bias
        wanted = [
            estimate - weight * bias,
            whole - math.hypot(below, uncertainty),
            whole + math.hypot(above, uncertainty),
        ]
        told = [data[f"estimate_corrected{end}"][row] for end in ("", "_low", "_high")]
        check(
            np.allclose(told, wanted, rtol=1e-12, atol=0, equal_nan=True),
            f"{name}, corrected: {told}, not {wanted}",
        )
        corrected += weight > 0
    checked.update(["estimate_corrected", "estimate_corrected_low", "estimate_corrected_high"])
    return corrected


def check_bias(path):
    """A run with so many paths that some of its biases are larger than their uncertainties."""
    corrected = check_corrected(Data(path))
    check(corrected >= 3, f"{corrected} statistics have a bias beyond its uncertainty")
    print(f"  {corrected} corrected estimates are what they should be")


def stick_influences(paths, block):
    """The influence of each path on the standard deviation of stick durations: the sum over its
    sticks of (D - mean)^2 - sd^2, with the mean and sd of its block."""
    influences = []
    for begin in range(0, len(paths), block):
        part = [np.array(path.sticks) for path in paths[begin : begin + block]]
        durations = np.concatenate(part)
        influences.extend(
            ((sticks - durations.mean()) ** 2 - durations.var()).sum() for sticks in part
        )
    return np.array(influences)


def in_steps(data, durations):
    """Times in units of the step. The scenarios of this test have an output step as long as the
    step of the scheme."""
    durations = np.asarray(durations)
    steps = np.round(durations / data.spacing)
    check(
        bool(np.all(np.abs(durations - steps * data.spacing) <= 1e-9)),
        "durations are multiples of the step",
    )
    return steps


def check_median(data, paths, durations):
    """The interval of the median of stick durations by Woodruff's method: the error of the share of
    sticks up to the median follows from 32 batches of whole paths, and the ends of the interval of
    the share are converted to durations by the distribution."""
    row = list(STATISTICS).index("stick_duration_median")
    told = [
        data[kind][row] for kind in ("estimate", "standard_error", "interval_low", "interval_high")
    ]
    batches = [
        np.array([d for path in paths[first::32] for d in path.sticks]) for first in range(32)
    ]
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
        # The difference of the durations of neighbouring sticks.
        near = 3 * (high - low) / (2 * reach * len(durations))
        wanted, allowed = [median, (high - low) / (2 * t), low, high], [near] * 4
    else:
        batches = [in_steps(data, batch) for batch in batches]
        ordered = np.sort(in_steps(data, durations))
        median = ordered[math.ceil(len(ordered) / 2) - 1]
        _, reach = share(median)
        # The quantiles of the law in which each multiple is spread evenly over half a step to
        # either side.
        values, counts = np.unique(ordered, return_counts=True)
        corners = np.column_stack([values - 0.5, values + 0.5]).ravel()
        heights = np.column_stack([np.cumsum(counts) - counts, np.cumsum(counts)]).ravel()
        spread = [np.interp(p * len(ordered), heights, corners) for p in (0.5 - reach, 0.5 + reach)]
        # A multiple m is refuted if F(m) is significantly below 1/2, or if F(m - 1) is
        # significantly above it.
        possible = [
            m
            for m in np.arange(values[0], values[-1] + 1)
            if sum(share(m)) >= 0.5 and np.subtract(*share(m - 1)) < 0.5
        ]
        wanted = [median, (spread[1] - spread[0]) / (2 * t), possible[0], possible[-1]]
        wanted, allowed = [data.spacing * number for number in wanted], [1e-6 * data.spacing] * 4
    check_duration_quantile_intervals(data, share, durations, batches)
    for kind, a, b, near in zip(
        ("estimate", "error", "low", "high"), told, wanted, allowed, strict=True
    ):
        check(abs(a - b) <= near, f"stick_duration_median, {kind}: {a!r}, not {b!r}")


def check_duration_quantile_intervals(data, share, durations, batches):
    """The intervals of quantiles of stick durations by Woodruff's method. For durations that are
    multiples of a step, the interval consists of the multiples that are not refuted; otherwise it
    lies between the quantiles at either end."""
    in_units = in_steps(data, durations) if data.has_step else durations
    ordered = np.sort(in_units)
    unit = data.spacing if data.has_step else 1
    for row, level in enumerate(LEVELS):
        told = [data[f"law_quantile_{end}"][row] for end in ("low", "high")]
        quantile = (
            ordered[math.ceil(level * len(ordered) - 1e-9) - 1]
            if data.has_step
            else np.quantile(ordered, level)
        )
        _, reach = share(quantile)
        if data.has_step:
            possible = [
                m
                for m in np.arange(ordered[0], ordered[-1] + 1)
                if sum(share(m)) >= level and np.subtract(*share(m - 1)) < level
            ]
            ends, near = [unit * possible[0], unit * possible[-1]], 1e-6 * unit
        else:
            ends = [np.quantile(ordered, min(max(p, 0), 1)) for p in (level - reach, level + reach)]
            near = (
                5
                * np.diff(ordered)[
                    max(0, int((level - reach) * len(ordered)) - 3) : int(
                        (level + reach) * len(ordered)
                    )
                    + 3
                ].max()
            )
        if reach >= level:
            ends[0] = 0
        if level + reach >= 1:
            ends[1] = math.inf
        for a, b in zip(told, ends, strict=True):
            check(
                a == b or abs(a - b) <= near,
                f"law_quantile at {level}: {told}, not {ends}",
            )
    checked.update(["law_quantile_low", "law_quantile_high"])


class Data(dict):
    """The variables and attributes of a file."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.attributes = dict(file.attrs)
            units = {}
            for name, dataset in file.items():
                values = dataset[()]
                self[name] = (
                    np.array([text.decode() for text in values])
                    if dataset.dtype.kind == "O"
                    else values
                )
                units[name] = dataset.attrs.get("units")
        for name, unit in units.items():
            check(name in UNIT, f"{name} is in the file, and not in the list of this test")
            check(unit == UNIT[name], f"{name}: unit {unit!r}, not {UNIT[name]!r}")
        self.show()
        self.scenario = tomllib.loads(self.attributes["scenario"])
        self.spacing = self.scenario["time"]["output_step"]
        self.has_step = "step" in self.attributes
        self.after = self.scenario["statistics"]["after"]

    def show(self):
        """The law of sticks, which is the only one, and the ends of intervals as variables."""
        if "bound" in self:
            check(list(self.pop("bound")) == ["low", "high"], "the ends of an interval")
        if "law" in self:
            check([list(self.pop(n)) for n in ("law", "law_unit")] == [["stick"], ["s"]], "the law of sticks")
            check(list(self.pop("law_bin")) == list(range(self["law_upper"].shape[1])), "numbers of bins")
            self.pop("law_long_name")
        for name in [name for name in self if name.startswith("law_")]:
            self[name] = self[name][:, 0] if name.endswith("_interval") else self[name][0]
        for name in [name for name in self if name.endswith("_interval")]:
            self[name.replace("_interval", "_low")], self[name.replace("_interval", "_high")] = self.pop(name)

    def events(self):
        ends = np.cumsum(self["event_count"].astype(int))[:-1]
        parts = {
            name: np.split(self[f"event_{name}"], ends)
            for name in ("time", "displacement", "force", "sign", "kind")
        }
        return [
            {name: part[i] for name, part in parts.items()} for i in range(len(self["event_count"]))
        ]


def check_measured(path, samples):
    """A run with a measured temperature: its samples are those of the CSV file, and T is a straight
    line from one sample to the next."""
    data = Data(path)
    with open(samples, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    stamps = [datetime.datetime.fromisoformat(row["time"]) for row in rows]
    seconds = np.array([(stamp - stamps[0]).total_seconds() for stamp in stamps])
    celsius = np.array([float(row["temperature_degC"]) for row in rows])
    check(np.array_equal(data["series_time"], seconds), "series_time")
    check(np.array_equal(data["series_temperature"], celsius), "series_temperature")
    same(
        "trajectory_temperature",
        data["trajectory_temperature"][0],
        np.interp(data["time"], seconds, celsius),
    )
    check(data.scenario["time"]["end"] == seconds[-1], "time.end: the last sample")
    events = data.events()[0]
    force, friction = data["trajectory_force"][0], data.scenario["friction"]["static"]
    check(
        len(events["time"]) > 20 and np.abs(force).max() <= friction,
        "a bearing that slips, and no force above f_s on the hour",
    )
    print(f"  {len(rows)} samples, and T on {len(data['time'])} rows")


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
    check(
        attributes.get("step") == scenario["time"].get("step") or not data.has_step,
        "attribute step",
    )


def check_run(path):
    data = Data(path)
    check_header(data)
    steps = round(data.scenario["time"]["end"] / data.spacing)
    same("time", data["time"], data.spacing * np.arange(steps + 1))
    same("quantile", data["quantile"], LEVELS)
    same("event_count", data["event_count"], [len(of["time"]) for of in data.events()])
    check(len(data["trajectory"]) == len(data["path"]), "the trajectories of all paths are there")
    events = data.events()
    x = data["trajectory_displacement"]
    row = round(data.after / data.spacing)
    check(
        abs(data["time"][row] - data.after) < 1e-9,
        "the output grid passes through the end of the burn-in",
    )
    paths = [
        Path(data.scenario, of, end, data.after, there)
        for of, end, there in zip(events, x[:, -1], x[:, row], strict=True)
    ]
    check_events(data, paths, events, data.has_step and data.attributes["step"] == data.spacing)
    check_trajectories(data, events)
    check_bands(data)
    check_durations(data, paths)
    check_sub_phases(data, paths)
    times, x = check_periods(data)
    check_paths(data, paths)
    check_transient(data, paths)
    check_statistics(data, paths, times, x)
    check(
        set(data) == checked,
        f"not recomputed: {sorted(set(data) - checked)}; absent: {sorted(checked - set(data))}",
    )
    checked.clear()
    print(f"  {len(data)} variables of {len(paths)} paths are what they should be")
    return data


def check_replay(path, run):
    data = Data(path)
    check(len(data["path"]) == 1, "a replay is one path")
    number = int(data["path"][0])
    check(
        number > 0 and list(data["trajectory"]) == [number],
        f"trajectory: {data['trajectory']}, not {number}",
    )
    check(
        data.attributes["seed"] == run.attributes["seed"], "the seed of a replay is that of the run"
    )
    (here,) = data.events()
    there = run.events()[number]
    for name, values in here.items():
        check(np.array_equal(values, there[name]), f"event_{name} of path {number}")
    for name in [name for name in run if name.startswith("path")]:
        check(
            np.array_equal(data[name][0], run[name][number], equal_nan=True),
            f"{name} of path {number}",
        )
    # Compare the rows at the instants that both files have.
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
        if sys.argv[1] == "--measured":
            sys.exit(check_measured(*sys.argv[2:]))
        print(sys.argv[1])
        ensemble = check_run(sys.argv[1])
        for replay in sys.argv[2:]:
            print(replay)
            check_replay(replay, ensemble)
    except AssertionError as error:
        sys.exit(f"not what it should be: {error}")

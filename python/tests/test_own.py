"""User-defined statistics, and a run in parts."""

from __future__ import annotations

import zlib

import numpy as np
import pytest
import stickslip as ss
from conftest import SCENARIOS, same

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")


def slips(events):
    """The number of slips of each path that ended: a stick is entered after the first event of the
    path."""
    begins = np.cumsum(events.count) - events.count
    entered = events.kind == 0
    entered[begins[events.count > 0]] = False
    return events.per_path(entered)


def jumps(events):
    """For each path, the sum of the ways from the beginning to the end of its slips, and the number
    of slips. The ratio of their means is the mean jump."""
    began = np.flatnonzero(events.kind == 1)
    ended = np.searchsorted(np.flatnonzero(events.kind == 0), began)
    ends = np.append(np.flatnonzero(events.kind == 0), -1)[ended]
    whole = (ends >= 0) & (events.path[began] == events.path[ends])
    way, count = np.zeros(len(events.time)), np.zeros(len(events.time))
    way[began[whole]] = np.abs(events.displacement[ends[whole]] - events.displacement[began[whole]])
    count[began[whole]] = 1
    return events.per_path(way), events.per_path(count)


@pytest.mark.parametrize("antithetic", [False, True])
@pytest.mark.parametrize("scheme", ["discrete-vi", "event-driven"])
def test_a_user_defined_statistic_agrees_with_the_program(scheme, antithetic):
    ds = ss.run(
        "rho025",
        paths=1000,
        scheme=scheme,
        bias=False,
        set={"ensemble.antithetic": antithetic},
        own={"slips": slips, "jumps": jumps},
    )
    for own, statistic in [("slips", "slips_per_path"), ("jumps", "jump_abs_mean")]:
        mine, theirs = ds.sel(own=own), ds.sel(statistic=statistic)
        # The intervals of the program are symmetric on a logarithmic scale, and user-defined
        # ones on a linear one: where errors are small, the ends differ by their square.
        error = (theirs.standard_error / theirs.estimate).item()
        for name in ("estimate", "standard_error", "interval_low", "interval_high"):
            near = 1e-9 if name in ("estimate", "standard_error") else 4 * error**2
            assert mine[f"own_{name}"].item() == pytest.approx(theirs[name].item(), rel=near), (
                own,
                name,
            )


def test_the_bits_do_not_depend_on_threads():
    arguments = {"paths": 3000, "bias": False, "own": {"jumps": jumps}}
    one, two = (ss.run("rho025", threads=threads, **arguments) for threads in (1, 3))
    same(one, two)
    assert "event_time" not in one
    plain = ss.run("rho025", paths=3000, bias=False)
    same(one.drop_dims("own"), plain)
    kept = ss.run("rho025", record="events", **arguments)
    assert kept.event_count.sum() == kept.sizes["event"] > 0


def test_what_a_function_may_not_give_is_refused():
    for function, problem in [
        (lambda events: events.time, "returned shapes"),
        (lambda events: np.full(len(events.count), np.nan), "not finite"),
        (lambda events: (events.count, events.count, events.count), "returned shapes"),
    ]:
        with pytest.raises(ss.ArgumentError, match=problem) as raised:
            ss.run("rho025", paths=300, own={"mine": function})
        assert raised.value.argument == "own" and raised.value.value == "mine"

    def broken(events):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        ss.run("rho025", paths=10**8, bias=False, own={"broken": broken})


RECORD = {"events": True, "trajectories": 300}


@pytest.mark.parametrize("bias", [True, False])
def test_parts_are_the_run(bias):
    arguments = {"paths": 1500, "record": RECORD, "bias": bias}
    parts = [ss.run("rho025", part=f"{i}/4", threads=2, **arguments) for i in (3, 1, 4, 2)]
    assert [ds.attrs["status"] for ds in parts] == ["part"] * 4
    same(ss.merge(parts, bias=bias), ss.run("rho025", **arguments))


def test_a_part_is_that_of_the_command(mc, tmp_path):
    mc(
        "run",
        SCENARIOS / "rho025.toml",
        "--paths",
        1500,
        "--part",
        "2/4",
        "--quiet",
        "-o",
        "part.h5",
    )
    mine, file = (
        ss.run(SCENARIOS / "rho025.toml", paths=1500, part="2/4"),
        ss.load(tmp_path / "part.h5"),
    )
    same(mine.drop_dims("part_state"), file.drop_dims("part_state"))
    if mine.attrs["git_hash"] != file.attrs["git_hash"]:
        return
    # Of one build they are the same in all of their bytes, and parts of both kinds are joined.
    assert mine.part_state.to_numpy().tobytes() == file.part_state.to_numpy().tobytes()
    others = [ss.run(SCENARIOS / "rho025.toml", paths=1500, part=f"{i}/4") for i in (1, 3, 4)]
    same(ss.merge([file, *others]), ss.run(SCENARIOS / "rho025.toml", paths=1500))


def with_state(ds, state):
    """The part with another state."""
    return ds.drop_vars("part_state").assign(part_state=("part_state", np.array(state)))


def of_another_build(ds):
    """The part as another build would have made it, with a checksum that fits."""
    body = bytearray(ds.part_state.to_numpy().tobytes()[:-4])
    body[body.index(ss._native.GIT_HASH.encode())] ^= 1
    state = bytes(body) + zlib.crc32(body).to_bytes(4, "little")
    return with_state(ds, np.frombuffer(state, dtype=np.uint8))


def test_parts_that_do_not_go_together_are_named():
    half = [ss.run("rho025", paths=600, part=f"{i}/2", record="paths") for i in (1, 2)]
    other = [of_another_build(ds) for ds in half]
    wrong_rows = half[1].copy(deep=True)
    wrong_rows.path_stick_time[17] += 1e-9
    swapped = [with_state(ds, half[1 - i].part_state) for i, ds in enumerate(half)]
    damaged = half[1].part_state.to_numpy().copy()
    damaged[len(damaged) // 2] ^= 1
    for parts, problem in [
        ([], "no parts"),
        ([half[0], half[1].drop_vars("part_state")], "not a part"),
        # All of them are of one build, which is not this one.
        (other, "started by version"),
        ([half[0], wrong_rows], r"parts\[1\]: its rows differ"),
        (swapped, "its rows differ"),
        ([half[0], with_state(half[1], damaged)], "damaged"),
    ]:
        with pytest.raises(ss.ArgumentError, match=problem):
            ss.merge(parts)
    for part, arguments, problem in [
        ("0/2", {}, "it is not a part"),
        ("1/2", {"max_time": 1}, "cannot be combined with"),
        ("1/2", {"own": {"slips": slips}}, "cannot have user-defined statistics"),
    ]:
        with pytest.raises(ss.ArgumentError, match=problem):
            ss.run("rho025", paths=600, part=part, **arguments)


def test_a_sweep_has_the_user_defined_statistics_of_runs():
    vary = {"friction.static": [1.1, 1.2], "friction.dynamic": [0.8, 0.9, 1.0]}
    own = {"slips": slips, "jumps": jumps}
    ds = ss.sweep("rho025", vary, paths=600, bias=False, own=own)
    assert ds.own_estimate.dims == (*ds.estimate.dims[:2], "own")
    for i, static in enumerate(vary["friction.static"]):
        for j, dynamic in enumerate(vary["friction.dynamic"]):
            friction = {"friction.static": static, "friction.dynamic": dynamic}
            run = ss.run("rho025", paths=600, bias=False, set=friction, own=own)
            for name in ("estimate", "standard_error", "interval_low", "interval_high"):
                mine, theirs = ds[f"own_{name}"][i, j], run[f"own_{name}"]
                assert mine.values.tobytes() == theirs.values.tobytes(), (static, dynamic)
    frame = ss.summary(ds)
    assert frame.loc[(1.2, 0.9, "jumps"), "estimate"] == ds.own_estimate[1, 1, 1].item()
    assert len(frame) == 6 * (len(ds.statistic) + 2)
    without = ss.sweep("rho025", vary, paths=600, bias=False)
    mine = [name for name in ds.variables if name.startswith("own")]
    same(ds, without, but=[*mine, "point_seconds"])


def test_an_exception_of_a_statistic_ends_a_sweep():
    def refuse(events):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        ss.sweep("rho025", {"friction.static": [1.1, 1.2]}, paths=10**7, own={"bad": refuse})

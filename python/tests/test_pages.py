"""The code on the pages and in the notebooks runs, and gives the results that they show."""

from __future__ import annotations

import ast
import builtins
import glob
import json
import os
import re
import signal

import numpy as np
import pytest
import stickslip as ss
from conftest import ROOT, same

pytestmark = pytest.mark.filterwarnings("ignore")


def snippets(page):
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), flags=re.DOTALL)


@pytest.mark.parametrize(("name", "pictures"), [("tutorial", 4), ("lesson", 3), ("motion", 0)])
def test_a_notebook_runs_from_end_to_end_in_any_folder(name, pictures, tmp_path):
    """The cells hold what the text says by `assert`."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(ROOT / f"examples/{name}.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells)
    client = nbclient.NotebookClient(
        notebook,
        timeout=300,
        kernel_name="python3",
        resources={"metadata": {"path": tmp_path}},
    )
    client.execute()
    shown = [
        output.data
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if "data" in output
    ]
    assert sum("image/svg+xml" in data for data in shown) == pictures
    assert not list(tmp_path.iterdir())


def test_the_sections_of_the_short_lesson_stand_alone():
    """They take 45 minutes, and use no name that only another section defines."""
    cells = json.loads((ROOT / "examples/lesson.ipynb").read_text())["cells"]
    sources = ["".join(cell["source"]) for cell in cells]
    (chosen,) = re.findall(r"In 45 minutes, take sections ([\d, and]+);", sources[0])
    chosen = re.findall(r"\d", chosen)
    minutes = dict(re.findall(r"^\| (\d) \|.*\| (\d+) \|$", sources[0], re.MULTILINE))
    assert sum(int(minutes[section]) for section in chosen) == 45
    section, defined, used = None, {*dir(builtins)}, set()
    for cell, source in zip(cells, sources):
        if heading := re.match(r"## (\d)\. |# Solutions", source):
            section = heading[1] or "solutions"
        if cell["cell_type"] == "code" and section in (None, *chosen):
            for node in ast.walk(ast.parse(source)):
                if isinstance(node, ast.Name):
                    (used if isinstance(node.ctx, ast.Load) else defined).add(node.id)
                elif isinstance(node, (ast.FunctionDef, ast.alias)):
                    defined.add((getattr(node, "asname", None) or node.name).split(".")[0])
                elif isinstance(node, ast.arg):
                    defined.add(node.arg)
    assert used <= defined, used - defined


def test_the_snippet_for_dask_comes_to_the_bits_of_the_run():
    pytest.importorskip("distributed")
    names = {"__name__": "page"}
    exec(*snippets("docs/long-runs.md"), names)
    same(names["ds"], ss.run("rho025", paths=10_000))


def test_lost_parts_are_simulated_again():
    distributed = pytest.importorskip("distributed")
    with distributed.Client(n_workers=2, threads_per_worker=1) as client:
        parts = [
            client.submit(ss.run, "rho025", paths=10_000, part=f"{i}/8", threads=1, pure=False)
            for i in range(1, 9)
        ]
        distributed.wait(parts, return_when="FIRST_COMPLETED")
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
        ds = ss.merge(client.gather(parts))
    same(ds, ss.run("rho025", paths=10_000))


def test_a_law_is_fitted_as_the_page_of_statistics_says():
    pytest.importorskip("scipy")
    names = {}
    exec(*snippets("docs/statistics.md"), names)
    # The place of the greatest likelihood of these counts, found by another search.
    assert abs(names["scale"] - 2.6026) < 0.001
    assert abs(names["shape"] - 0.59356) < 0.0001


def test_the_snippets_of_the_guide_run(monkeypatch):
    """All of them except that with a measured temperature, whose arrays a reader must provide."""
    monkeypatch.chdir(ROOT)
    names = {"np": np}
    for snippet in snippets("docs/python.md"):
        if "times, temperatures" not in snippet:
            exec(snippet, names)
    # The output of `cargo run --release --example own_statistic`, which counts the same sticks of
    # the same paths.
    estimate, low, high = (
        names["ds"][f"own_{name}"].item() for name in ("estimate", "interval_low", "interval_high")
    )
    assert (
        f"{estimate:.4f}, 95 % interval [{low:.4f}, {high:.4f}]"
        == "0.1599, 95 % interval [0.1570, 0.1628]"
    )


def test_the_snippet_on_a_measured_motion_finds_its_parameters():
    pytest.importorskip("scipy")
    names = {}
    exec(*snippets("docs/motion.md"), names)
    assert np.allclose(np.exp(names["fit"].x), [100, 0.3, 1], rtol=0.05)


def test_records_of_a_folder_give_a_fragility_and_are_replayed(monkeypatch, tmp_path):
    """Rectangular pulses of 0.3 g and 0.5 g move a block that slides at 0.2 g by 0.1177 m and
    0.5884 m (docs/sweep.md), so the fractions beyond 0.01, 0.1 and 0.5 m are 1, 1 and 1/2."""
    monkeypatch.chdir(tmp_path)
    for size in (0.3, 0.5):
        rows = [f"{i / 1000},{9.80665 * size * (i <= 400)}" for i in range(3002)]
        (tmp_path / f"pulse-{size}.csv").write_text("time,ag\n" + "\n".join(rows) + "\n")
    block = """
        oscillator = { mass = 1000, stiffness = 0, dilatation = 0 }
        friction = { static = 1961.33, dynamic = 1961.33 }
        force.expression = "-m*s*ag"
        parameters = { m = 1000, s = 1 }
        input.ag = { file = "pulse-0.3.csv" }
        initial.displacement = 0
        scheme.kind = "event-driven"
        ensemble.paths = 1
    """
    (tmp_path / "block.toml").write_text(block)
    names = {"ss": ss, "glob": glob}
    exec(*snippets("docs/records.md"), names)
    assert names["fragility"] == [1.0, 1.0, 0.5]
    # Both polarities move it by as much, in opposite directions.
    ds = ss.sweep("block.toml", {"parameters.s": [1, -1]})
    moved = ds.estimate.sel(statistic="displacement_end_mean").to_numpy()
    assert moved[0] == -moved[1] != 0
    again = ss.replay(ss.run("block.toml"), path=0)
    assert abs(again.trajectory_displacement).max() == pytest.approx(0.1177, abs=1e-3)


def test_random_parameters_are_pooled_with_their_interval():
    names = {}
    exec(*snippets("docs/sweep.md")[1:], names)
    assert abs(names["sticks"].mean().item() - 4) < 3 * names["error"]
    # Uniform over a width of 0.2, times the slope 2/(K V) = 20.
    assert np.isclose(names["error"], 20 * 0.2 / 12**0.5 / 200**0.5, rtol=0.1)


def test_the_fragility_of_a_block_is_that_of_its_closed_form():
    """Newmark's distance for each peak of the page, whose chords of 1 ms lose (pi h/T)^2/12 = 5e-6 of the pulse, a few times more of a short slip."""
    names = {}
    exec(*snippets("docs/gallery.md"), names)
    w, T, a = np.pi / names["duration"], names["duration"], names["mu"] * names["g"]
    A = names["peaks"] * names["g"]
    t1 = np.arcsin(np.minimum(a / A, 1)) / w
    v = A / w * (1 + np.cos(w * t1)) - a * (T - t1)
    slip = A / w * ((T - t1) * np.cos(w * t1) + np.sin(w * t1) / w) - a * (T - t1) ** 2 / 2 + v**2 / 2 / a
    outlasts = (a < A) & (v > 0)      # the slip outlasts the pulse, as the formula assumes
    assert outlasts.mean() > 0.9
    assert np.allclose(names["slip"][outlasts], slip[outlasts], rtol=5e-5)
    assert (names["slip"][a >= A] == 0).all()

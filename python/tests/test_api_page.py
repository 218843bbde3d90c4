"""The page of all names is that of the docstrings, and the package names its licences."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from importlib.metadata import files, metadata

import pytest
import stickslip as ss
from conftest import ROOT


def test_the_page_of_all_names_is_up_to_date():
    printed = subprocess.run(
        [sys.executable, ROOT / "tools/python_api.py"], capture_output=True, text=True, check=True
    ).stdout
    assert printed == (ROOT / "docs/python-api.md").read_text()
    headings = {line[4:] for line in printed.splitlines() if line.startswith("### ")}
    assert headings == {name for name in ss.__all__ if callable(getattr(ss, name))} - {
        "ScenarioLike",
        "Scheme",
    }


@pytest.mark.parametrize("name", [n for n in ss.__all__ if inspect.isfunction(getattr(ss, n))])
def test_every_argument_of_a_function_is_explained(name):
    """By `help`; the page has the first sentence on those that no other function explains."""
    explained = inspect.getdoc(getattr(ss, name)).split("\nArgs:\n")[-1]
    for argument in inspect.signature(getattr(ss, name)).parameters:
        alone = re.search(rf"^    (\w+,\s+)*{argument}\b[\w\s,]*:", explained, re.M)
        assert alone or f"`{argument}`" in explained, argument


def test_the_package_holds_both_licences():
    kept = {file.name: file for file in files("stickslip") or [] if "licenses" in file.parts}
    assert set(kept) == {"LICENSE-APACHE", "LICENSE-MIT"}
    for name, file in kept.items():
        assert file.read_text() == (ROOT / name).read_text()
    assert metadata("stickslip")["Author"] == "The stick-slip developers"

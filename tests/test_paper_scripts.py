"""The scripts of the paper's study: all can be loaded, and a quick one runs to its figure."""

import importlib
import sys
from pathlib import Path

import pytest
from PIL import Image

PAPER = Path(__file__).parents[1] / "paper"
SCRIPTS = sorted(path.stem for path in PAPER.glob("*.py") if path.stem != "run_all")


@pytest.fixture
def scripts(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "path", [str(PAPER), *sys.path])
    modules = {name: importlib.import_module(name) for name in SCRIPTS}
    monkeypatch.setattr(modules["common"], "OUTPUT", tmp_path)
    yield modules
    for name in SCRIPTS:
        del sys.modules[name]


def test_every_script_has_a_main_and_is_run_by_make_paper(scripts):
    run_all = (PAPER / "run_all.py").read_text()
    for name, module in scripts.items():
        if name != "common":
            assert callable(module.main)
            assert name in run_all


def test_figure_6_is_drawn_with_its_table(scripts, tmp_path):
    fractions = []
    scripts["fig6_force_curves"].main(lambda fraction, message: fractions.append(fraction))
    with Image.open(tmp_path / "fig6_force_curves.png") as picture:
        assert picture.width > 800
    header, *rows = (tmp_path / "fig6_force_curves.csv").read_text().splitlines()
    assert len(header.split(",")) == len(rows[0].split(","))
    assert len(rows) >= 8
    assert fractions == sorted(fractions)

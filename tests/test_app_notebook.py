"""The page as an object: what a notebook needs of it, tried without one."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

MANUAL = Path(__file__).parents[1] / "docs" / "page.md"


def python(code):
    """Run lines in a fresh Python, and return what they print; their error if they fail."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    return done.stdout + done.stderr


def test_importing_the_package_imports_no_panel():
    code = "import sys, softafm.app; print({'panel', 'bokeh', 'param'} & set(sys.modules))"
    assert python(code) == "set()\n"


def test_without_panel_one_line_says_how_to_get_it():
    blocked = "import sys; sys.modules['panel'] = None\n"
    said = python(blocked + "from softafm.app import Page").splitlines()[-1]
    assert said.endswith("the page needs the package 'panel': pip install 'softafm[app]'")


def test_the_package_has_the_page_and_nothing_it_has_not():
    import softafm.app
    from softafm.app.page import Page

    assert softafm.app.Page is Page
    with pytest.raises(AttributeError, match="has no attribute 'Pages'"):
        _ = softafm.app.Pages


@pytest.fixture(scope="module")
def page():
    from softafm.app import Page

    one = Page()
    yield one
    one.close()


def test_in_a_cell_it_has_a_height_and_its_own_colours(page):
    layout = page.__panel__()
    assert layout.height == 760
    assert layout.sizing_mode == "stretch_width"
    assert ":host(.softafm-cell)" in layout.stylesheets[0]
    assert "softafm-cell" in layout.css_classes


def test_it_leaves_the_address_and_the_styles_of_a_notebook_alone(page):
    import panel as pn

    before = list(pn.config.raw_css), pn.state.location and pn.state.location.search
    page.form.edit("tip.radius", "11 nm")
    assert (pn.config.raw_css, pn.state.location and pn.state.location.search) == before


def test_a_run_from_python_gives_its_result_by_label(page):
    entry = page.run()
    assert entry.job.wait(60)
    assert list(page.results) == [entry.label]
    assert page.results[entry.label] is entry.job.result
    page.form.edit("tip.radius", "thin")
    assert page.run() is None


def test_pages_share_the_processes_of_their_limits(page):
    from softafm.app import Page
    from softafm.app.limits import Limits
    from softafm.app.notebook import share_runner

    other = Page()
    assert other.session._runner is page.session._runner is share_runner(Limits())
    other.close()


def test_the_lines_of_the_manual_run():
    cells = re.findall(r"```python\n(.*?)```", MANUAL.read_text(encoding="utf-8"), re.S)
    names = {}
    for cell in cells:
        exec(cell, names)
    page = names["page"]
    assert page.form.document["tip"] == {"shape": "sphere", "radius": "20 nm"}
    assert page.session.entries[0].job.wait(60)
    assert len(page.results) == 1
    page.close()

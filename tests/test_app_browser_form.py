"""The form of the page in a browser: every field of every mode, keyboard, colours."""

import pytest

from softafm.app.form import Alternatives, describe_section, list_tables
from softafm.modes import MODES

FOCUSED = """() => {
  let at = document.activeElement;
  while (at.shadowRoot?.activeElement) at = at.shadowRoot.activeElement;
  return at.id || at.className;
}"""


@pytest.fixture(scope="module")
def site(serve):
    return serve()


BAD = "<img src=x> bad"


def until(page, difference):
    """Wait until nothing differs any more."""
    for _ in range(3000):
        if not difference():
            return
        page.wait_for_timeout(20)
    pytest.fail(f"waited in vain: {difference()}")


def asked(table, choice, way, mode):
    """Return the paths of what a section asks for, with its alternatives given in a way."""
    found = set()
    for entry in describe_section(table, choice or None, mode).entries:
        several = isinstance(entry, Alternatives)
        fields = entry.ways[min(way, len(entry.ways) - 1)] if several else (entry,)
        found |= {f"{table}.{field.name}" for field in fields}
    return found


def rounds(mode):
    """Yield what to choose in each section, and the way, that every field be there in some round.

    What a tip, sample, surface and solver may be does not depend on the mode.
    """
    offered = {table: describe_section(table, None, mode).choices for table in list_tables(mode)}
    for table in ("tip", "sample", "surface", "solver") if mode != "force-distance" else ():
        offered[table] = offered[table][:1]
    for index in range(max(map(len, offered.values()))):
        chosen = {table: names[min(index, len(names) - 1)] for table, names in offered.items()}
        entries = [
            e for t, name in chosen.items() for e in describe_section(t, name or None, mode).entries
        ]
        for way in range(max([len(e.ways) for e in entries if isinstance(e, Alternatives)] + [1])):
            yield chosen, way


def paths(page):
    """Return the paths of all fields on the page, but for those of parts of a sum."""
    found = page.locator(".field").evaluate_all("rows => rows.map(row => row.dataset.path)")
    return {path for path in found if "[" not in path}


TAKE_WAY = """(selects, way) => {
  for (const select of selects) {
    const wanted = Math.min(way, select.options.length - 1);
    if (select.selectedIndex === wanted) continue;
    select.selectedIndex = wanted;
    select.dispatchEvent(new Event("change"));
  }
}"""


def choose(page, chosen, way, mode):
    """Choose, and wait for all fields that are to be there then."""
    for table, name in chosen.items():
        chooser = page.locator(f"select#choice-{table}")
        if chooser.count() and chooser.input_value() != name:
            chooser.select_option(name)
    wanted = set.union(*(asked(table, name, way, mode) for table, name in chosen.items()))

    def difference():
        page.locator("select.ways").evaluate_all(TAKE_WAY, way)
        return paths(page) ^ wanted

    until(page, difference)


@pytest.mark.parametrize("mode", MODES)
def test_a_bad_value_in_any_field_is_marked_with_its_reason_and_cannot_run(site, visit, mode):
    page = visit(f"{site.address}?mode={mode}&run.check=true")
    page.locator("summary").click()
    rows = page.locator(".field")

    def unmarked():
        return rows.evaluate_all(
            """rows => rows.filter(row => row.querySelector("input:not([type=checkbox])")
              && !(row.classList.contains("bad") && row.querySelector(".problem").offsetHeight
                   && row.querySelector(".problem").textContent.length > 8))
              .map(row => row.dataset.path)"""
        )

    for chosen, way in rounds(mode):
        choose(page, chosen, way, mode)
        for text in rows.locator("input[type=text]").all():
            text.fill(BAD)
        for file in rows.locator("input[type=file]").all():
            file.set_input_files({"name": "a.csv", "mimeType": "text/csv", "buffer": BAD.encode()})
        until(page, unmarked)
        assert page.locator("button.run").is_disabled()
        assert "to mend before it can run" in page.locator(".words").inner_text()
    assert page.locator("img").count() == 0


def test_the_keyboard_alone_fills_in_and_runs(site, visit):
    page = visit(site.address)
    while page.evaluate(FOCUSED) != "input-sample-E_inf":
        page.keyboard.press("Tab")
    page.keyboard.press("Control+A")
    page.keyboard.type("0.3 GPa")
    page.keyboard.press("Control+Enter")
    page.locator(".run-done").wait_for()
    page.wait_for_url("**E_inf=0.3+GPa**")
    assert page.locator("ul.runs .label").input_value() == "1 tapping-cycle"
    page.keyboard.press("Control+A")
    page.keyboard.type("0.3 GPaa")
    page.keyboard.press("Control+Enter")
    page.locator(".field-sample-E_inf.bad").wait_for()
    assert page.locator("ul.runs li").count() == 1


def test_colours_follow_the_system_until_chosen_and_then_are_kept(site, visit):
    ground = "() => getComputedStyle(document.body).backgroundColor"
    page = visit(site.address, color_scheme="dark")
    assert page.evaluate(ground) == "rgb(28, 30, 33)"
    page.locator("button.run").click()
    page.locator(".run-done").wait_for()
    axis = """() => [...Bokeh.index.all_views()].map(view => view.model)
                    .find(model => model.type === "LinearAxis")?.axis_label_text_color"""
    page.wait_for_function(f"({axis})() === '#d9dce1'", polling=50)
    page.get_by_role("button", name="switch to light colours").click()
    page.wait_for_function(f"({axis})() === '#33373d'", polling=50)
    assert page.evaluate(ground) == "rgb(255, 255, 255)"
    page.reload()
    page.locator("button.theme", has_text="dark").wait_for()
    assert page.evaluate(ground) == "rgb(255, 255, 255)"


def test_the_regime_follows_while_one_types(site, visit):
    page = visit(site.address)
    regime = page.locator("table", has_text="Before any run")
    radius = regime.locator("tr", has_text="tip radius").locator("td").nth(1)
    assert radius.inner_text() == "10 nm"
    page.locator(".field-tip-radius input").press_sequentially("0", delay=20)
    page.locator(".field-tip-radius input").fill("25 nm")
    until(page, lambda: radius.inner_text() != "25 nm")
    page.locator(".field-tip-radius input").fill("25 <b>")
    page.locator("td.problem", has_text="25 <b>").or_(page.locator("td.problem")).first.wait_for()
    assert page.locator("td b").count() == 0

"""The form in Python and in a browser."""

import base64
import socket
import time

import pytest

pn = pytest.importorskip("panel", reason="the page is not installed: pip install softafm[app]")

from softafm.app.form import read_presets  # noqa: E402
from softafm.app.marks import MISSING  # noqa: E402
from softafm.app.widgets import Form  # noqa: E402

TAP = read_presets()["ldpe-tapping"]
TIP = "radius (nm),height (nm)\n" + "\n".join(f"{r},{r * r / 20}" for r in range(0, 30, 3)) + "\n"


@pytest.fixture
def form(tmp_path):
    return Form(TAP, tmp_path)


def wait_until(true, *arguments):
    for _ in range(3000):
        if true(*arguments):
            return
        time.sleep(0.02)
    pytest.fail("waited a minute in vain")


def test_an_edit_changes_the_document_and_nothing_else(form):
    given = form.document
    form.edit("sample.E0", "3 GPa")
    assert form.document == {**TAP, "sample": {**TAP["sample"], "E0": "3 GPa"}}
    assert given == TAP
    assert form.problems == {}
    assert form.outlook.seconds > 0
    form.edit("sample.poisson", "0.30")
    assert form.document["sample"]["poisson"] == 0.3
    assert form._fields.state["texts"]["sample.poisson"] == "0.30"
    with pytest.raises(KeyError):
        form.edit("sample.radius", "1 nm")


def test_bad_values_are_problems_until_they_are_mended(form):
    form.edit("sample.E0", "3")
    assert "the unit is missing" in form.problems["sample.E0"]
    assert form.outlook.rows == ()
    assert form._fields.state["problems"] == form.problems
    form.show_problems = False
    assert form._fields.state["problems"] == {}
    form.edit("sample.E0", "")
    assert form.problems == {"sample.E0": MISSING}
    form.edit("sample.E0", "2 GPa")
    assert form.problems == {}
    assert form.document == TAP


def test_values_at_their_defaults_are_not_written(form):
    form.edit("run.check", "true")
    assert form.document["run"]["check"] is True
    form.edit("run.check", "false")
    assert "check" not in form.document["run"]
    form.choose("solver", "enhanced-attard")
    form.edit("solver.orthogonal", "false")
    form.edit("solver.basis", "bessel")
    assert form.document["solver"] == {
        "name": "enhanced-attard",
        "basis": "bessel",
        "orthogonal": False,
    }
    form.edit("solver.orthogonal", "true")
    form.edit("solver.basis", "cosine")
    form.choose("solver", "energy")
    assert "solver" not in form.document


def test_a_document_fills_all_fields(form):
    for name, document in read_presets().items():
        form.use_preset(name)
        assert form.document == document
        assert form._fields.state["preset"] == name
        assert form.problems == {}
        for table, written in document.items():
            for key, value in written.items() if isinstance(written, dict) else ():
                held = form._fields.state["texts"].get(f"{table}.{key}")
                assert held in (str(value), str(value).lower()) or key in ("shape", "model", "law")


def test_what_the_form_does_not_know_is_a_problem_and_can_be_removed(form):
    form.document = {**TAP, "odd.key": 1, "tip": {**TAP["tip"], "radus": "1 nm"}}
    assert set(form.problems) == {"odd.key", "tip.radus"}
    assert [path for path, _ in form._fields.state["elsewhere"]] == ["odd.key", "tip.radus"]
    form.remove("odd.key")
    form.remove("tip.radus")
    assert form.document == TAP
    assert form.problems == {}


def test_choices_and_ways_come_back_as_they_were(form):
    form.choose("tip", "cone")
    assert form.problems == {
        "tip.half_angle": "missing; must be an angle with its unit, such as '20 deg'",
        "tip.apex_radius": "missing; must be a length with its unit, such as '10 nm'",
    }
    form.choose("tip", "paraboloid")
    form.choose_way("sample", 0, 1)
    assert form.problems == {"sample.G0": MISSING, "sample.G_inf": MISSING}
    form.choose_way("sample", 0, 0)
    form.choose_mode("approach-curve")
    assert form.problems["cantilever.stiffness"].startswith("missing")
    form.choose_mode("tapping-cycle")
    assert form.document == TAP
    assert form.problems == {}


def test_laws_are_added_to_a_sum(form):
    form.choose("surface", "sum")
    form.add_part()
    form.choose("surface.parts[1]", "repulsion")
    form.edit("surface.parts[1].pressure_at_zero", "1 MPa")
    form.edit("surface.parts[1].decay", "1 nm")
    assert form.problems == {}
    assert form.document["surface"]["parts"][1]["decay"] == "1 nm"
    form.remove("surface.parts[0]")
    assert [part["law"] for part in form.document["surface"]["parts"]] == ["repulsion"]
    assert form._fields.state["texts"]["surface.parts[0].decay"] == "1 nm"


def settle(form):
    """Wait until the form knows what its files hold."""
    while form.reading:
        time.sleep(0.02)
        form.look()


def test_an_uploaded_file_is_named_in_the_document(form, tmp_path):
    form.choose("tip", "measured")
    form.upload("tip.file", "../../my tip.csv", TIP.encode())
    assert form.document["tip"] == {"shape": "measured", "file": "my_tip.csv"}
    assert (tmp_path / "my_tip.csv").read_text(encoding="utf-8") == TIP
    assert form.problems == {"tip.file": "is being read ..."}
    settle(form)
    assert form.problems == {}
    form.largest_upload = 10
    form.upload("tip.file", "tip.csv", b"x" * 11)
    assert "must have at most" in form.problems["tip.file"]
    form.edit("tip.file", "my_tip.csv")
    assert form.problems == {}


def test_a_form_without_a_folder_has_one_of_its_own():
    form = Form()
    assert form.folder.is_dir()
    assert form.problems["mode"].startswith("missing")
    assert Form().folder != form.folder


@pytest.mark.parametrize(
    "message",
    [
        None,
        [],
        "edit",
        {},
        {"edit": "sample.E0"},
        {"edit": "sample.E0", "text": 5},
        {"edit": "sample.E0", "text": "9" * 100_000},
        {"edit": "document", "text": "x"},
        {"edit": "tip.__class__", "text": "x"},
        {"choose": "tip", "choice": "build"},
        {"choose": "nothing", "choice": "cone"},
        {"choose": "mode", "choice": "odd"},
        {"choose": "preset", "choice": "../../etc/passwd"},
        {"alternatives": 9, "of": "sample", "way": 0},
        {"alternatives": 0, "of": "sample", "way": 9},
        {"add": "tip"},
        {"upload": "tip.file", "name": "a.csv", "content": base64.b64encode(b"a").decode()},
        {"upload": "sample.E0", "name": "a.csv", "content": "?"},
    ],
)
def test_messages_that_make_no_sense_change_nothing(form, tmp_path, message):
    form.answer(message)
    assert form.document == TAP
    assert form.problems == {}
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def served():
    """Serve a page of a new form; return its address and the forms that were opened."""
    forms = []

    def page():
        forms.append(Form(TAP))
        pn.state.add_periodic_callback(forms[-1].look, 100)  # as the page does
        return pn.Column(forms[-1], width=380)

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = pn.serve(
        page, port=port, address="127.0.0.1", show=False, threaded=True, verbose=False
    )
    yield f"http://127.0.0.1:{port}/", forms
    server.stop()


@pytest.fixture
def opened(browser, served):
    """Return a browser's page and its form; fail if the browser complained."""
    address, forms = served
    page = browser.new_page(viewport={"width": 420, "height": 768})
    page.set_default_timeout(60_000)
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    for _ in range(100):
        try:
            page.goto(address)
            break
        except Exception:
            time.sleep(0.05)
    page.wait_for_selector(".field-motion-cycles")
    yield page, forms[-1]
    page.close()
    assert errors == []


def test_typing_in_the_browser(opened):
    page, form = opened
    field = page.locator(".field-sample-E0")
    box = field.locator("input")
    assert box.input_value() == "2 GPa"
    box.fill("")
    box.press_sequentially("3 GP", delay=20)
    field.locator(".problem", has_text="'GP' does not measure a modulus").wait_for()
    assert box.get_attribute("aria-invalid") == "true"
    assert "bad" in field.get_attribute("class")
    box.press_sequentially("a", delay=20)
    page.wait_for_selector(".field-sample-E0:not(.bad)")
    assert box.input_value() == "3 GPa"
    assert box.get_attribute("aria-invalid") == "false"
    wait_until(lambda: form.document["sample"]["E0"] == "3 GPa")
    assert page.locator(".choice-preset").input_value() == ""


def test_a_text_is_not_lost_when_the_field_is_left_at_once(opened):
    page, form = opened
    page.locator(".field-tip-radius input").fill("20 nm")
    page.locator(".field-motion-frequency input").fill("300 kHz")
    page.keyboard.press("Tab")
    wait_until(lambda: form.document["motion"]["frequency"] == "300 kHz")
    assert form.document["tip"]["radius"] == "20 nm"


def test_bad_values_in_every_field_are_marked(opened):
    page, form = opened
    page.locator("summary").click()
    boxes = page.locator(".field input[type=text]")
    for index in range(boxes.count()):
        boxes.nth(index).fill("<b>bad</b>")
    count = boxes.count()
    wait_until(lambda: page.locator(".field.bad").count() == count)
    assert len(form.problems) == count
    assert page.locator(".problem b").count() == 0


def test_choosing_in_the_browser(opened):
    page, form = opened
    page.locator(".choice-tip").select_option("cone")
    page.wait_for_selector(".field-tip-half_angle.bad")
    assert page.locator(".field-tip-half_angle input").get_attribute("placeholder") == (
        "missing, such as 20 deg"
    )
    focused = "() => { let at = document.activeElement; while (at.shadowRoot) "
    focused += "at = at.shadowRoot.activeElement; return at.id; }"
    page.locator(".choice-sample").focus()
    page.locator(".choice-sample").select_option("maxwell")
    page.wait_for_selector(".way-sample-0")
    assert page.evaluate(focused) == "choice-sample"
    page.keyboard.press("Tab")
    assert page.evaluate(focused) == "way-sample-0"
    page.locator(".way-sample-0 select").select_option("1")
    page.wait_for_selector(".field-sample-viscosity")
    page.locator("#way-surface-hamaker").select_option("1")
    page.wait_for_selector(".field-surface-work_of_adhesion")
    page.locator(".choice-preset").select_option("pdms-sphere")
    page.wait_for_selector(".field-cantilever-stiffness")
    assert page.locator(".field-tip-radius input").input_value() == "5 um"
    assert page.locator(".field.bad").count() == 0
    wait_until(lambda: form.document == read_presets()["pdms-sphere"])


def test_a_sum_a_flag_and_a_file_in_the_browser(opened, tmp_path):
    page, form = opened
    page.locator(".choice-surface").select_option("sum")
    page.wait_for_selector(".field-surface-parts-0-z0")
    page.locator(".add").click()
    page.wait_for_selector(".choice-surface-parts-1")
    page.locator(".section-surface-parts-1 .remove").click()
    page.locator(".section-surface-parts-1").wait_for(state="detached")
    page.locator("summary").click()
    page.locator(".field-run-profiles input").check()
    page.locator(".told", has_text="profiles").wait_for()
    page.locator(".choice-tip").select_option("measured")
    (tmp_path / "tip.csv").write_text(TIP, encoding="utf-8")
    page.locator(".field-tip-file input").set_input_files(tmp_path / "tip.csv")
    page.locator(".file-name", has_text="tip.csv").wait_for()
    wait_until(lambda: form.problems == {})
    assert form.document["run"]["profiles"] is True
    assert (form.folder / "tip.csv").read_text(encoding="utf-8") == TIP


def test_help_is_shown_for_the_field_in_use(opened):
    page, _ = opened
    page.locator(".field-surface-z0 input").focus()
    page.locator(".help-strip", has_text="Equilibrium gap, where the pressure vanishes").wait_for()


def test_a_document_set_in_python_shows_at_once_even_where_one_types(opened):
    page, form = opened
    box = page.locator(".field-sample-E0 input")
    box.press("End")
    box.press_sequentially("0", delay=10)
    wait_until(lambda: form.document["sample"]["E0"] == "2 GPa0")
    page.locator(".choice-preset").select_option("ps-approach-curve")
    page.wait_for_selector(".field-cantilever-stiffness")
    assert box.input_value() == "4.25 GPa"


def test_sessions_have_forms_of_their_own(opened, browser, served):
    page, form = opened
    other = browser.new_page()
    other.goto(served[0])
    other.wait_for_selector(".field-tip-radius")
    other.locator(".field-tip-radius input").fill("77 nm")
    wait_until(lambda: served[1][-1].document["tip"]["radius"] == "77 nm")
    other.close()
    assert form.document == TAP
    assert page.locator(".field-tip-radius input").input_value() == "10 nm"

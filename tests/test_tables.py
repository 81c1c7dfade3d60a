"""Tables in text files: what is read, and what is refused because it could mean two things."""

import os
import time

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import softafm as sa
from softafm.checks.refusals import ConfigError
from softafm.experiment.config import load_document
from softafm.files.measured import read_columns, read_trajectory
from softafm.files.tables import Table
from softafm.units.quantities import FREQUENCY, LENGTH, MODULUS, TIME

EXAMPLE = "time (us),height (nm)"
COLUMNS = {"time": TIME, "height": LENGTH}


@pytest.fixture
def write(tmp_path):
    def write(content, name="table.csv"):
        path = tmp_path / name
        path.write_text(content, encoding="utf-8")
        return path

    return write


@pytest.fixture
def read(write):
    return lambda content: read_columns(write(content), COLUMNS, EXAMPLE)


def refusal(call, *arguments):
    with pytest.raises(ValueError, match=r"\w") as caught:
        call(*arguments)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize(
    "content",
    [
        "time (us),height (nm)\n0,0.5\n1,-2\n2.5,1e1\n",
        "time (us);height (nm)\n0;0.5\n1;-2\n2.5;1e1\n",
        "time (us);height (nm)\n0;0,5\n1;-2\n2,5;1e1\n",
        "time (us)\theight (nm)\n0\t0,5\n1\t-2\n2,5\t1e1\n",
        'time (us),height (nm)\n"0","0,5"\n"1","-2"\n"2,5","1e1"\n',
        '"time (us)","height (nm)"\n0,"0.5"\n 1, -2 \n2.5,+10.\n',
        "time (us) height (nm)\n0 0.5\n 1  -2\n2.5\t10\n",
        "# time (us) height (nm)\n0 0.5\n1 -2\n2.5 10\n",
        "# Monday; at noon\n#\n\ntime [us] , height [nm]\n0,.5\n# gap\n1,-2\n\n2.5,10\n",
        "time / us;height / nm\n0;,5\n1;-2\n2,5;10,\n",
        "time,height\nus,nm\n0,0.5\n1,-2\n2.5,10\n",
        "time\theight\tforce\n[us]\t[nm]\t[V]\n0\t0.5\t1\n1\t-2\t1\n2.5\t10\t1\n",
        "time (us),height\n,nm\n0,0.5\n1,-2\n2.5,10\n",
        "height (nm),note,Time (us),\n0.5,a,0,\n-2,\"b, c\",1,\n10,,2.5,,\n",
        "sep=;\ntime (us);height (nm)\n0;0,5\n1;-2\n2,5;1e1\n",
        "SEP=,\r\ntime (us),height (nm)\r\n0,0.5\r\n1,-2\r\n2.5,10",
        "time (us),height (nm)\r\n0,0.5\r\n1,-2\r\n2.5,10",
    ],
)  # fmt: skip
def test_what_can_be_read_in_one_way_only_is_read(read, content):
    time, height = read(content)
    np.testing.assert_allclose(time, [0, 1e-6, 2.5e-6], rtol=1e-14)
    np.testing.assert_allclose(height, [0.5e-9, -2e-9, 10e-9], rtol=1e-14)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("time (us),height (nm)\n0,0,2\n", "line 2 ('0,0,2') has 3 fields, but the header, line 1, "
         "names 2: columns are separated by ',', so decimals need points"),
        ("# one\n\ntime (us);height (nm)\n0;1\n# two\n1;2;3\n", "line 6 ('1;2;3') has 3 fields, "
         "but the header, line 3, names 2: columns are separated by ';'"),
        ("time (us),height (nm)\n0;1\n", "line 2 ('0;1'): 'time' must be a finite number, such as "
         "0.5 or 5e-9; found '0;1'"),
        ("time (us);height (nm)\n0,1\n", "line 2 ('0,1') has no 'height'; columns are separated "
         "by ';'"),
        ("time (us);height (nm)\n0;1,250\n1;2,500\n", "line 2: the comma of 1,250 may be a decimal "
         "one or separate thousands"),
        ("time (us);height (nm)\n0;1,2\n1;2.5\n", "line 3 has a decimal point, in '2.5', and "
         "line 2 a comma, in '1,2'"),
        ("time (us);height (nm)\n0;1,234.5\n", "line 2 ('0;1,234.5'): 'height' must be a finite"),
        ("time (us);\theight (nm)\n0;\t1\n", "has ';' and tabs in its header"),
        ("time,height\n0,1\n", "column 'time' has no unit: it must be that of a time, as in 'time"),
        ("time (nm),height (nm)\n0,1\n", "column 'time (nm)' must name a unit of a time, not 'nm'"),
        ("time,height\nnm,nm\n0,1\n", "column 'time' must name a unit of a time, not 'nm'"),
        ("time (us),height\nms,nm\n0,1\n", "column 'time' has the unit 'us' in the header and 'ms' "
         "in line 2"),
        ("Zeit (us);height (nm)\n0;1\n", "has no column 'time'; its header, line 1, reads "
         "'Zeit (us);height (nm)', with columns separated by ';'; it must read, for example, "
         f"'{EXAMPLE}'"),
        ("time (us),height (nm),Height (um)\n0,1,2\n", "has more than one column 'height': 'height "
         "(nm)' and 'Height (um)'; keep only one"),
        ("time (us),height (nm)\n0,1\n1_0,2\n", "line 3 ('1_0,2'): 'time' must be a finite number"),
        ("time (us),height (nm)\n0,\uff11\n", "'height' must be a finite number"),
        ("time (us),height (nm)\n0,nan\n", "'height' must be a finite number"),
        ("time (us),height (nm)\n0,-inf\n", "'height' must be a finite number"),
        ("time (us),height (nm)\n0,1e400\n", "'height' must be a finite number"),
        ("time (us),height (nm)\n0,1e40\n", "must be a number below 1e+40 in magnitude"),
        ("time (us),height (nm)\n0,0x10\n", "'height' must be a finite number"),
        ("time (us),height (nm)\n0,\n", "line 2 ('0,') has no 'height'"),
        ("time (us),height (nm)\n0,1 # first\n", "'height' must be a finite number"),
        ("time (us),height (nm)\n\"0,1\n1,2\n", "is not a CSV file: "),
        ("time (us),height (nm)\n0,\"1\n\"\n", "is not a CSV file: a quoted field spans sev"),
        ("time (us)   height (nm)   force (nN)\n0 1 2\n5            3.0\n", "line 3 ('5            "
         "3.0') has 2 fields, but the header, line 1, names 3: columns are separated by blanks, so "
         "no field may be empty or hold a blank"),
        ("time (us) height (nm) force (nN) note\n1 000 1\n", "line 2 ('1 000 1') has 3 fields"),
        ("time (us) height (nm)\n1 000 1\n", "line 2 ('1 000 1') has 3 fields"),
        ("time height force\nus nm\n0 1 2\n", "line 2 ('us nm') has 2 fields"),
        ('time (us),height (nm),drive (V)\n0,"1,250","1,5"\n1,"980","2"\n2,"1,100","3"\n',
         "line 2: the comma of 1,250 may be a decimal one or separate thousands, 1.250 or 1250, as "
         "everywhere in column 'height (nm)': write decimals with points"),
        ("\n# nothing\n\n", f"is empty; its header must read, for example, '{EXAMPLE}'"),
    ],
)  # fmt: skip
def test_what_could_be_read_in_two_ways_is_refused(read, content, reason):
    assert refusal(read, content).startswith(reason) or reason in refusal(read, content)


def test_a_tab_before_the_first_title_is_an_empty_title(read):
    time, height = read("\ttime (us)\theight (nm)\n7\t0\t1\n8\t1\t2\n")
    np.testing.assert_allclose([time, height], [[0, 1e-6], [1e-9, 2e-9]], rtol=1e-14)


@pytest.mark.parametrize(
    "rows", ["1,1,approach\n2,6,approach\n", "1,1,m\n2,6,s\n", "1,1,\n2,6,nm\n"]
)
def test_a_first_row_of_ones_and_words_is_data(read, rows):
    time, height = read(f"time (ms),height (nm),segment\n{rows}")
    np.testing.assert_allclose([time, height], [[1e-3, 2e-3], [1e-9, 6e-9]], rtol=1e-14)


def test_a_first_frequency_of_1_hz_beside_a_remark_is_kept(write):
    rows = "1,1,1,low torque\n10,2,1,\n100,3,1,\n"
    path = write(f"frequency (Hz),storage (MPa),loss (MPa),remark\n{rows}")
    assert sa.read_dma(path)[0].tolist() == [1.0, 10.0, 100.0]


@pytest.mark.parametrize("row", [",,approach", "-,-,m", "1,nm,"])
def test_a_row_without_numbers_is_no_row_of_units_where_the_header_has_them(read, row):
    message = refusal(read, f"time (ms),height (nm),segment\n{row}\n1,1,a\n")
    assert message.startswith(f"line 2 ({row!r})")


def test_a_one_is_no_unit_of_what_has_a_dimension(read):
    message = refusal(read, "time,height,note\n1,nm,m\n2,6,\n")
    assert message == "column 'time' must name a unit of a time, not '1'"


def test_one_clear_decimal_comma_settles_what_the_others_are(read):
    _, height = read("time (us);height (nm)\n0;1,250\n1;0,500\n")
    np.testing.assert_allclose(height, [1.25e-9, 0.5e-9], rtol=1e-14)


@pytest.mark.parametrize(
    ("header", "names"),
    [
        ("f (Hz),E' (MPa)", ("storage modulus", "E'")),
        ("f (Hz),E\u2032 [MPa]", ("storage", "E'")),
        ("f (Hz),Storage modulus (MPa)", ("storage", "storage modulus")),
        ("f (Hz),STORAGE_MODULUS / MPa", ("storage modulus",)),
        ("f / Hz,|G*| / (MPa)", ("|G*|",)),
    ],
)
def test_a_column_has_any_of_several_names(write, header, names):
    table = Table(write(f"{header}\n1,2\n"), "frequency (Hz),storage (MPa)")
    assert table.in_si(table.column("frequency", "f"), FREQUENCY) == pytest.approx([1.0])
    assert table.in_si(table.column(*names), MODULUS) == pytest.approx([2e6])
    assert table.find("loss", "E''") is None


def test_a_name_with_brackets_of_its_own_and_a_plain_number(write):
    table = Table(write("f,tan(\u03b4),D (raw) (nm)\nHz,1,\n1,0.5,3\n"), "f (Hz)")
    assert table.numbers(table.column("tan(\u03b4)")) == pytest.approx([0.5])
    assert table.column("tan(\u03b4)").unit == "1" or table.column("tan").unit == "\u03b4"
    assert table.in_si(table.column("D (raw)"), LENGTH) == pytest.approx([3e-9])


def test_decimal_commas_make_no_other_tip(write):
    text = "radius (nm){0}height (nm)\n0{0}0,2\n2{0}0,4\n4{0}1,1\n6{0}2,2\n"
    reference = sa.read_tip_profile(write("r (nm),height (nm)\n0,0.2\n2,0.4\n4,1.1\n6,2.2\n"))
    assert sa.read_tip_profile(write(text.format(";"))) == reference
    message = refusal(sa.read_tip_profile, write(text.format(",")))
    assert message.startswith("line 2 ('0,0,2') has 3 fields")


def test_times_that_do_not_rise_are_refused_by_their_line(write):
    path = write("# a record\n\ntime (us),height (nm)\n0,1\n# a gap\n2,1\n2,3\n")
    message = refusal(read_trajectory, path)
    assert message == "line 7 ('2,3'): 'time' must be later than in line 6 ('2,1')"


def test_an_angle_is_asked_for_by_an_angle_and_refused_by_its_line(write):
    header = "frequency (Hz),storage (MPa),delta"
    message = refusal(sa.read_dma, write(f"{header}\n1,1,5\n10,2,6\n"))
    assert message == "column 'delta' has no unit: it must be that of an angle, as in 'delta (deg)'"
    message = refusal(sa.read_dma, write(f"{header} (deg)\n1,1,5\n10,2,95\n"))
    assert message == "line 3 ('10,2,95'): delta = 95 deg: must be above 0 and below 90"


def test_what_is_there_but_no_file_is_said_to_be_none(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert refusal(read_columns, pipe, COLUMNS, EXAMPLE) == "is not a regular file"
    assert refusal(read_columns, tmp_path / "none", COLUMNS, EXAMPLE) == "no such file"
    with pytest.raises(ConfigError, match=r"pipe: is not a regular file$"):
        load_document(pipe)


def test_any_encoding_but_utf_8_is_refused(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(EXAMPLE, encoding="utf-16")
    assert refusal(read_columns, path, COLUMNS, EXAMPLE) == "is not text in UTF-8; save it as UTF-8"


@given(rows=st.lists(st.tuples(st.floats(-1e30, 1e30), st.floats(-1e30, 1e30)), max_size=5))
@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_number_is_read_to_the_last_digit(read, rows):
    lines = "".join(f"{a!r};{str(b).replace('.', ',')};x\n" for a, b in rows)
    points = "".join(f"{a!r},{b!r}\n" for a, b in rows)
    expected = np.array(rows, float).reshape(-1, 2).T
    found = read(f"time (s),height (m)\n{points}")
    np.testing.assert_array_equal(found, expected)
    commas = "".join(f"{a!r};{b!r}\n".replace(".", ",") for a, b in rows)
    found = read(f"time (s);height (m)\n0,5;0,5\n{commas}")
    np.testing.assert_array_equal(np.array(found)[:, 1:], expected)
    assert lines.count("\n") == len(rows)


@pytest.mark.parametrize(
    "header",
    ["a (" + " " * 100_000 + "x", "a ( " * 30_000, "(" * 100_000, "a /" * 40_000, '",' * 50_000],
)
def test_no_header_takes_long(write, header):
    path = write(f"{header}\n1,2\n")
    began = time.perf_counter()
    assert refusal(read_columns, path, COLUMNS, EXAMPLE)
    assert time.perf_counter() - began < 5.0

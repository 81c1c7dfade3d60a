"""Old names work as before and say what to use instead, in the line that uses them."""

import inspect
import warnings

import pytest

from softafm.checks.deprecated import Renamed, warn_of_removal

SINCE, UNTIL = "0.2.0 of 2026-11-30", "0.4.0"


class Chain:
    def __init__(self, count):
        self.count = count

    @property
    def element_count(self):
        return self.count

    @classmethod
    def of(cls, count):
        return cls(count)

    mode_count = Renamed("element_count", SINCE, UNTIL)
    make = Renamed("of", SINCE, UNTIL)


class Special(Chain):
    element_count = 7


def line_here():
    return inspect.currentframe().f_back.f_lineno


def test_an_old_attribute_is_the_new_one_and_warns_where_it_is_read():
    with pytest.warns(DeprecationWarning, match="mode_count") as found:
        count, line = Chain(3).mode_count, line_here()
    assert count == 3
    said = found[0]
    assert (said.filename, said.lineno) == (__file__, line)
    assert str(said.message) == (
        "Chain.mode_count is deprecated since softafm 0.2.0 of 2026-11-30 and removed in 0.4.0: "
        "use Chain.element_count"
    )


def test_an_old_constructor_and_a_subclass_work_too():
    with pytest.warns(DeprecationWarning, match="use Chain.of"):
        assert Chain.make(4).count == 4
    with pytest.warns(DeprecationWarning, match="use Chain.element_count"):
        assert Special(1).mode_count == 7


def test_the_new_names_and_the_class_itself_do_not_warn():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Chain(2).element_count == 2
        dir(Chain)


def test_an_old_function_warns_where_it_is_called():
    def old():
        warn_of_removal("old", "new", SINCE, UNTIL)

    with pytest.warns(DeprecationWarning, match="old is deprecated .*: use new") as found:
        old(), (line := line_here())
    assert (found[0].filename, found[0].lineno) == (__file__, line)

#!/usr/bin/env bash
# latex2mathml 3.81.1 writes MathML 3, of which browsers keep only MathML Core. On valid LaTeX:
# - \mathrm{d} (the upright d of dt) becomes <mi>d</mi> without mathvariant="normal". An <mi> of one letter
#   is drawn in italics, so the command has no effect where it is used most. \text{d} stays upright.
# - \bm{x} and \boldsymbol{x} become mathvariant="bold-italic". MathML Core knows no value of that attribute
#   but "normal", so the letter is drawn as if it were not bold; \mathbf{x} becomes a bold code point and is.
# - commands of packages, such as siunitx, are no error: \qty{1}{\nano\metre} is set as the names of its
#   commands, backslashes and all. A build has to look at the result to know.
#
# Output with 3.81.1 on Python 3.11:
#   \mathrm{d}            d {}
#   \text{d}              mtext d
#   \bm{x}                x {'mathvariant': 'bold-italic'}
#   \boldsymbol{x}        x {'mathvariant': 'bold-italic'}
#   \mathbf{x}            U+1D431 {}
#   \qty{1}{\nano\metre}  \qty \nano \metre
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check latex2mathml==3.81.1

"$folder/venv/bin/python" - <<'PYTHON'
from xml.etree import ElementTree

from latex2mathml.converter import convert


def letters(latex, tag="mi"):
    return ElementTree.fromstring(convert(latex)).findall(f".//{{*}}{tag}")


(upright,) = letters(r"\mathrm{d}")
print(r"\mathrm{d}           ", upright.text, upright.attrib)
assert (upright.text, upright.attrib) == ("d", {})

(text,) = letters(r"\text{d}", "mtext")
print(r"\text{d}              mtext", text.text)

for latex in (r"\bm{x}", r"\boldsymbol{x}"):
    (bold,) = letters(latex)
    print(f"{latex:21}", bold.text, bold.attrib)
    assert (bold.text, bold.attrib) == ("x", {"mathvariant": "bold-italic"})

(bold,) = letters(r"\mathbf{x}")
print(r"\mathbf{x}           ", f"U+{ord(bold.text):X}", bold.attrib)
assert (bold.text, bold.attrib) == ("\N{MATHEMATICAL BOLD SMALL X}", {})

names = [each.text for each in letters(r"\qty{1}{\nano\metre}")]
print(r"\qty{1}{\nano\metre} ", *names)
assert names == [r"\qty", r"\nano", r"\metre"]
PYTHON

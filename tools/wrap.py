"""Wrap the prose of Markdown files at 100 characters: python tools/wrap.py FILE ...

Code, tables, headings and images on a line of their own stay as they are, and so do formulas and
code within a line.
"""

import re
import sys
from pathlib import Path

WIDTH = 100
_UNBROKEN = re.compile(r"(?:`[^`]*`|\$[^$\s][^$]*\$|\S)+")
_MARKS = re.compile(r"[-+*#>=]+|\d+[.)]")
"""Words that begin a list, a heading or a quotation where they begin a line."""
_ITEM = re.compile(r"(\s*(?:[-*]|\d+\.) +)(.*)")
_AS_IT_IS = re.compile(r"\s*$|[#|<]|!\[.*\)\s*$")


def wrap(text: str) -> str:
    """Return a document with its paragraphs and list items filled."""
    found: list[str] = []
    words, indent, fenced = [], "", False

    def end() -> None:
        found.extend(_fill(words, indent))
        words.clear()

    for line in text.splitlines():
        item = _ITEM.match(line)
        fence = line.lstrip().startswith("```")
        if fence or fenced or _AS_IT_IS.match(line):
            end()
            found.append(line)
            fenced ^= fence
        elif item:
            end()
            indent, words = item[1], [item[2]]
        else:
            indent = indent if words else line[: len(line) - len(line.lstrip())]
            words.append(line.strip())
    end()
    return "\n".join(found) + "\n"


def _fill(lines: list[str], indent: str) -> list[str]:
    """Return a paragraph whose first line begins with ``indent``, and others as far right."""
    found: list[str] = []
    current = indent
    for word in _join_marks(_UNBROKEN.findall(" ".join(lines))):
        if current.strip() and current != indent and len(current) + 1 + len(word) > WIDTH:
            found.append(current)
            current = " " * len(indent) + word
        else:
            current += word if current == indent else f" {word}"
    return [*found, current] if lines else []


def _join_marks(words: list[str]) -> list[str]:
    """Return words, with those that must not begin a line joined to the one before."""
    found: list[str] = []
    for word in words:
        if found and _MARKS.fullmatch(word):
            found[-1] += f" {word}"
        else:
            found.append(word)
    return found


if __name__ == "__main__":
    for name in sys.argv[1:]:
        page = Path(name)
        page.write_text(wrap(page.read_text(encoding="utf-8")), encoding="utf-8")

"""Formulas of the documents as MathML, made while mkdocs builds them: pages load no script.

A formula is LaTeX between dollar signs, or in a block that begins with ```math, as on code hosts.
"""

import re
from xml.etree import ElementTree

from latex2mathml.converter import convert
from markdown import Extension, Markdown
from markdown.inlinepatterns import InlineProcessor
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError

_INLINE = r"(?<![\\$\w])\$(?=[^\s$])([^$\n]*[^\s$])\$(?![\w$])"
_PARTS = {"mfrac": 2, "msub": 2, "msup": 2, "msubsup": 3, "munder": 2, "munderover": 3}
_BEFORE_ESCAPES = 185
"""Priority between those of code, which may hold dollar signs, and of backslashes."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Teach Markdown both ways to write a formula."""
    fence = {"name": "math", "class": "math", "format": _block}
    config.mdx_configs.setdefault("pymdownx.superfences", {})["custom_fences"] = [fence]
    config.markdown_extensions.append(_Inline())
    return config


def mathml(latex: str, display: str) -> str:
    """Return LaTeX as MathML; PluginError, which ends the build, if a part is not understood."""
    try:
        found = convert(latex, display=display)
    except Exception as error:  # of a dozen classes that have nothing in common
        raise PluginError(f"formula {latex!r}: {type(error).__name__} {error}") from error
    tree = ElementTree.fromstring(found)
    # The converter sets what it does not know as text, and lets parts of a fraction be missing.
    unknown = re.search(r"\\[A-Za-z]*", "".join(tree.itertext()))
    if unknown:
        raise PluginError(f"formula {latex!r}: {unknown[0]} is not known")
    for each in tree.iter():
        if len(each) != _PARTS.get(each.tag.rpartition("}")[2], len(each)):
            raise PluginError(f"formula {latex!r}: a part of a fraction or an index is missing")
    return found


def _block(source: str, *_: object, **__: object) -> str:
    return f'<div class="math">{mathml(" ".join(source.split()), "block")}</div>'


class _Formula(InlineProcessor):
    def handleMatch(self, match, data):
        placeholder = self.md.htmlStash.store(mathml(match[1], "inline"))
        return placeholder, match.start(0), match.end(0)


class _Inline(Extension):
    def extendMarkdown(self, md: Markdown) -> None:
        md.inlinePatterns.register(_Formula(_INLINE, md), "formula", _BEFORE_ESCAPES)

"""The pages of the documents, which are installed with the package."""

from pathlib import Path

from softafm.checks.refusals import show, suggest

_INSTALLED = Path(__file__).parents[1] / "docs"
_IN_THE_REPOSITORY = Path(__file__).parents[3] / "docs"


def folder() -> Path:
    """Return the folder of the pages: that of the package, or of the repository it is run from."""
    return _INSTALLED if _INSTALLED.is_dir() else _IN_THE_REPOSITORY


def page_titles() -> dict[str, str]:
    """Return the title of every page by its name, such as ``"soft"``."""
    pages = sorted(folder().glob("*.md"))
    return {page.stem: page.read_text(encoding="utf-8").split("\n", 1)[0][2:] for page in pages}


def page_text(name: str) -> str:
    """Return a page in Markdown.

    Raises
    ------
    ValueError
        If there is no page of that name.
    """
    known = list(page_titles())
    if name not in known:
        raise ValueError(f"page {show(name)}: unknown; {suggest(name, known)}")
    return (folder() / f"{name}.md").read_text(encoding="utf-8")

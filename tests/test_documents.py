"""Pages of the documents where a user of the package finds them."""

import re
import tomllib
from pathlib import Path

import softafm as sa
from softafm.files import documents

DOCS = Path(__file__).parents[1] / "docs"


def test_docs_lists_every_page_and_shows_one(softafm):
    pages = {page.stem: page for page in DOCS.glob("*.md")}
    code, out, err = softafm("docs")
    *listed, last = out.splitlines()
    assert (code, err) == (0, "")
    assert {line.split()[0] for line in listed} == set(pages)
    assert "soft                 Soft contacts" in listed
    assert last == f"show one with: softafm docs NAME; all are in {DOCS}"
    code, out, err = softafm("docs", "soft")
    assert (code, out, err) == (0, pages["soft"].read_text(encoding="utf-8"), "")


def test_docs_refuses_an_unknown_page(softafm):
    code, out, err = softafm("docs", "sofft")
    assert (code, out) == (2, "")
    assert err.startswith("softafm: page 'sofft': unknown; did you mean 'soft'?")
    assert softafm("docs", "../README")[0] == 2


def test_docstrings_name_pages_that_are_installed():
    package = Path(sa.__file__).parent
    named = set()
    for path in package.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"docs/\w+\.md", text), path
        named |= set(re.findall(r"``softafm docs ([\w-]+)``", text))
    assert "soft" in named
    assert named <= {page.stem for page in DOCS.glob("*.md")}
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))
    included = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    assert included == {"docs": documents._INSTALLED.relative_to(package.parent).as_posix()}


def test_version_changelog_and_citation_agree():
    texts = {
        name: (DOCS.parent / name).read_text(encoding="utf-8")
        for name in ("CHANGELOG.md", "CITATION.cff")
    }
    releases = re.findall(
        r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)$", texts["CHANGELOG.md"], re.M
    )
    cited = re.findall(r"^(?:version|date-released): (.*)$", texts["CITATION.cff"], re.M)
    assert list(releases[0]) == [sa.__version__, cited[1]]
    assert cited[0] == sa.__version__
    assert releases == sorted(releases, reverse=True)

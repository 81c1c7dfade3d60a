"""Compiled code belongs to its sources, whatever is edited, installed, damaged or shared."""

import ast
import os
import shutil
import subprocess
import sys
import venv
import zipfile
from importlib import import_module
from pathlib import Path
from types import FunctionType

import pytest

from softafm.compiled import store as code_store

PACKAGE = code_store.PACKAGE
PROBE = '''
"""A loop that calls one in another file."""
from numba import float64, types
from softafm.compiled.functions import compile_for
from softafm.compiled.dense import multiply

@compile_for((types.Array(float64, 2, "C", readonly=True), float64[::1], float64[::1]))
def product(matrix, x, out):
    multiply(matrix, x, out)
'''
ASK = """
import numpy as np
import softafm
from softafm.solvers.probe import product
out = np.empty(2)
product(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([10.0, 1.0]), out)
print(softafm.__version__, *out)
"""
RIGHT, CHANGED = "12.0 34.0", "18.0 51.0"


def with_probe(folder: Path) -> Path:
    """Copy the package into a folder, with a loop more."""
    package = folder / "softafm"
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(PACKAGE, package, ignore=ignored)
    (package / "solvers" / "probe.py").write_text(PROBE)
    return package


def edit(package: Path, file: str, old: str, new: str) -> None:
    text = (package / file).read_text()
    assert text.count(old) == 1
    (package / file).write_text(text.replace(old, new))


def multiply_by_more(package: Path) -> None:
    edit(
        package,
        "compiled/dense.py",
        "total += matrix[i, j] * x[j]",
        "total += matrix[i, j] * x[j] * 1.5",
    )


def ask(*path: Path, python=sys.executable, **environment: str) -> tuple[str, str]:
    """Return what a process computes with the package found along a path, and its complaints."""
    kept = {name: os.environ[name] for name in ("PATH", "LANG") if name in os.environ}
    known = {"PYTHONPATH": os.pathsep.join(map(str, path)), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [python, "-c", ASK], env=kept | known | environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split(maxsplit=1)[1].strip(), done.stderr


@pytest.fixture(scope="module")
def probed(tmp_path_factory) -> Path:
    """The folder of a package with a loop more, and of its compiled code."""
    folder = tmp_path_factory.mktemp("probed")
    with_probe(folder)
    assert ask(folder, NUMBA_CACHE_DIR=str(folder / "kept")) == (RIGHT, "")
    return folder


def kept_files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("softafm.*") if path.is_file())


def test_code_is_kept_outside_of_the_package_and_found_again(probed):
    before = {path: path.stat().st_mtime_ns for path in kept_files(probed / "kept")}
    names = [path.name for path in before]
    assert any(name.startswith("softafm.solvers.probe.product-") for name in names)
    assert any(name.startswith("softafm.compiled.dense.multiply-") for name in names)
    assert ask(probed, NUMBA_CACHE_DIR=str(probed / "kept")) == (RIGHT, "")
    assert {path: path.stat().st_mtime_ns for path in kept_files(probed / "kept")} == before
    assert not list((probed / "softafm").rglob("__pycache__"))


def test_an_edit_of_another_file_than_the_loops_own_changes_the_result(probed, tmp_path):
    shutil.copytree(probed, tmp_path, dirs_exist_ok=True)
    multiply_by_more(tmp_path / "softafm")
    assert ask(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "kept")) == (CHANGED, "")


def test_a_version_installed_over_another_computes_its_own_results(tmp_path):
    """By pip, which leaves files that it did not install where they are."""
    venv.create(tmp_path / "venv", with_pip=False)
    python = next(p for p in (tmp_path / "venv").glob("*/python*") if p.stem == "python")
    site = next((tmp_path / "venv").rglob("site-packages"))
    (site / "others.pth").write_text(str(Path(import_module("numpy").__file__).parents[1]))
    package = with_probe(tmp_path / "source")
    found = []
    for version, change in (("0.1.0", lambda package: None), ("0.2.0", multiply_by_more)):
        text = (package / "version.py").read_text().splitlines(keepends=True)
        text = [
            f'__version__ = "{version}"\n' if "__version__ =" in line else line for line in text
        ]
        (package / "version.py").write_text("".join(text))
        change(package)
        wheel = write_wheel(package, version, tmp_path)
        pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
        options = ["--python", python, "install", "--upgrade", "--no-deps", "--no-index"]
        subprocess.run([*pip, *options, wheel], check=True)
        found.append(ask(python=python, NUMBA_CACHE_DIR=str(tmp_path / "kept"))[0])
        assert any(path.name.endswith(f"{version}.dist-info") for path in site.iterdir())
    assert found == [RIGHT, CHANGED]


def write_wheel(package: Path, version: str, folder: Path) -> Path:
    """Pack a package as a wheel."""
    wheel, about = folder / f"softafm-{version}-py3-none-any.whl", f"softafm-{version}.dist-info"
    with zipfile.ZipFile(wheel, "w") as packed:
        for path in package.rglob("*"):
            packed.write(path, path.relative_to(package.parent))
        packed.writestr(
            f"{about}/METADATA", f"Metadata-Version: 2.1\nName: softafm\nVersion: {version}\n"
        )
        packed.writestr(
            f"{about}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        )
        names = "".join(f"{name},,\n" for name in packed.namelist())
        packed.writestr(f"{about}/RECORD", f"{names}{about}/RECORD,,\n")
    return wheel


@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: content[:1000],
        lambda content: content[:-1],
        lambda content: content[:500] + bytes([content[500] ^ 1]) + content[501:],
        lambda content: b"another format" + content[14:],
    ],
    ids=["empty", "cut", "a byte short", "a bit flipped", "of another kind"],
)
def test_damaged_content_is_not_found(monkeypatch, tmp_path, damage):
    monkeypatch.setattr(code_store, "find_folder", lambda: tmp_path)
    content = bytes(range(256)) * 10
    code_store.write("loop", content)
    assert code_store.read("loop") == content
    whole = (tmp_path / "loop").read_bytes()
    (tmp_path / "loop").write_bytes(damage(whole))
    assert code_store.read("loop") is None
    assert [path.name for path in tmp_path.iterdir()] == ["loop"]


def test_damaged_code_is_compiled_anew(probed, tmp_path):
    shutil.copytree(probed, tmp_path, dirs_exist_ok=True)
    product = next(p for p in kept_files(tmp_path / "kept") if ".probe.product-" in p.name)
    product.write_bytes(product.read_bytes()[:-1])
    assert ask(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "kept")) == (RIGHT, "")
    mended = product.stat().st_mtime_ns
    assert ask(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "kept")) == (RIGHT, "")
    assert product.stat().st_mtime_ns == mended


def test_without_a_home_code_is_kept_among_temporary_files(probed, tmp_path):
    shelf = tmp_path / f"softafm-{os.getuid()}"
    shutil.copytree(probed / "kept" / shelf.name, shelf)
    shelf.chmod(0o700)
    before = len(kept_files(shelf))
    assert before > 0
    assert ask(probed, HOME=os.devnull, TMPDIR=str(tmp_path)) == (RIGHT, "")
    assert len(kept_files(shelf)) == before


def test_where_nothing_can_be_kept_a_run_works_and_says_what_to_do(probed, tmp_path):
    (tmp_path / f"softafm-{os.getuid()}").write_text("a file is in the way")
    found, said = ask(probed, HOME=os.devnull, TMPDIR=str(tmp_path))
    assert found == RIGHT
    assert said == (
        "softafm: compiled code cannot be kept: there is no folder that only you can write to; "
        "set NUMBA_CACHE_DIR to a folder that can be written\n"
    )


def test_a_folder_that_others_may_write_to_is_never_used(monkeypatch, tmp_path):
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.setattr(code_store.tempfile, "gettempdir", lambda: str(tmp_path))
    user = f"softafm-{os.getuid()}"
    shelves = [tmp_path / "NUMBA_CACHE_DIR" / user, tmp_path / "XDG_CACHE_HOME" / "softafm"]
    for shelf in [*shelves, tmp_path / user]:
        assert found_now().parent == shelf
        assert shelf.stat().st_mode & 0o777 == 0o700
        shelf.chmod(0o770)
    assert found_now() is None


def test_a_folder_of_another_user_is_never_used(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    ours = found_now()
    another = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: another)
    (tmp_path / f"softafm-{os.getuid()}").mkdir(mode=0o700)  # by the user we were
    theirs = found_now()
    assert ours.parent.parent == tmp_path
    assert theirs is None or tmp_path not in theirs.parents


def found_now() -> Path | None:
    code_store.find_folder.cache_clear()
    try:
        return code_store.find_folder()
    finally:
        code_store.find_folder.cache_clear()


def test_code_of_builds_that_nobody_uses_is_removed(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    shelf = tmp_path / f"softafm-{os.getuid()}"
    old, recent, other = shelf / ("a" * 64), shelf / ("b" * 64), shelf / "not ours"
    for place in (old, recent, other):
        place.mkdir(parents=True, mode=0o700)
        (place / "code").write_bytes(b"")
    shelf.chmod(0o700)
    for place in (old, other):
        os.utime(place, (0, 0))
    found_now()
    assert not old.exists()
    assert recent.exists()
    assert other.exists()


def test_the_name_of_a_build_follows_its_options(probed):
    builds = set()
    for level in ("1", "2"):
        code = "from softafm.compiled import store as code_store; print(code_store.name_build())"
        environment = os.environ | {"NUMBA_OPT": level}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True)
        builds.add(done.stdout)
    assert len(builds) == 2


def test_without_a_compiler_one_line_says_what_to_unset(tmp_path):
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    file = PACKAGE / "examples" / "pdms-sphere.toml"
    command = [sys.executable, "-m", "softafm", "run", file, "--out", tmp_path / "out.nc"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (1, "")
    assert len(done.stderr.splitlines()) == 1
    assert "NUMBA_DISABLE_JIT is set" in done.stderr
    assert done.stderr.endswith("softafm needs compiled code; unset it\n")
    assert list(tmp_path.iterdir()) == []


def test_what_loops_are_made_of_stands_where_the_build_is_named_after():
    """Their functions, and whatever they import from other files of the package."""
    from softafm.compiled.functions import CompiledFunction

    files = [path for path in code_store._list_sources() if path.name != "__init__.py"]
    found = 0
    for path in files:
        name = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        module = import_module(name)
        functions = [thing for thing in vars(module).values() if hasattr(thing, "py_func")]
        pythons = [function.py_func for function in functions]
        pythons += [t._python for t in vars(module).values() if isinstance(t, CompiledFunction)]
        for function in pythons:
            found += 1
            assert code_store.is_ours(function.__code__.co_filename)
            for origin in origins(function, path):
                assert code_store.is_ours(origin), f"{name} takes a name from {origin}"
    assert found > 40


def origins(function: FunctionType, path: Path) -> list[str]:
    """Files of the package that names in a function come from."""
    used = set(function.__code__.co_names)
    return [
        str(Path(import_module(line.module).__file__))
        for line in ast.walk(ast.parse(path.read_text()))
        if isinstance(line, ast.ImportFrom) and (line.module or "").startswith("softafm")
        for alias in line.names
        if (alias.asname or alias.name) in used
    ]

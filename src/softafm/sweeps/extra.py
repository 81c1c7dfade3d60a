"""Packages that only sweeps need."""

from importlib.util import find_spec


def require(*packages: str) -> None:
    """Raise ModuleNotFoundError, with what to install, if one is missing."""
    for name in packages:
        if find_spec(name) is None:
            raise ModuleNotFoundError(
                f"sweeps need the package '{name}': pip install 'softafm[sweep]'", name=name
            )

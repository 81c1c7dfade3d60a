"""Patterns of a sample: where which material lies, made from a few numbers and a seed."""

from math import pi

import numpy as np

from softafm.checks.validate import check_finite, check_positive

_WAVES = 200
_SIGMAS = 4
"""Standard deviations of the smoothing in the width of an interphase."""


def make_blend(
    shape: tuple[int, int],
    size: tuple[float, float],
    *,
    feature: float,
    share: float,
    interphase: float = 0.0,
    seed: int = 0,
) -> np.ndarray:
    """Return the share of the second of two phases that parted, such as two polymers.

    Waves of random directions, with lengths of about two features, are summed, and the highest
    part of the sum is the second phase. The domains do not depend on how fine the pixels are.

    Parameters
    ----------
    shape
        Numbers of pixels along y and x.
    size
        Extent along x and y, m.
    feature
        Width of a domain, m.
    share
        Part of the area that the second phase covers, between 0 and 1.
    interphase
        Width over which one phase goes over into the other, m; 0 parts them sharply.
    seed
        Another one gives other domains.

    Returns
    -------
    numpy.ndarray
        0 to 1, shape (ny, nx); both are reached.

    Raises
    ------
    ValueError
        If a length or the share is out of range, or a pixel or an interphase wider than a feature.
    """
    from scipy.ndimage import gaussian_filter

    feature, interphase = (
        check_positive("feature", feature, "m"),
        check_finite("interphase", interphase, "m"),
    )
    if interphase < 0:
        raise ValueError(f"interphase = {interphase:g} m: must be at least 0")
    if not 0 < check_finite("share", share, "") < 1:
        raise ValueError(f"share = {share:g}: must be above 0 and below 1")
    width, depth = (check_positive(f"size[{i}]", each, "m") for i, each in enumerate(size))
    ny, nx = shape
    pixel = (depth / ny, width / nx)
    if feature < max(pixel):
        raise ValueError(
            f"feature = {feature:g} m: must be at least a pixel, {max(pixel):g} m; take more pixels"
        )
    if interphase > feature:
        raise ValueError(
            f"interphase = {interphase:g} m: must be at most the feature, {feature:g} m"
        )
    random, field = np.random.default_rng(seed), np.zeros(shape)
    x, y = (np.arange(nx) + 0.5) * pixel[1], (np.arange(ny)[:, None] + 0.5) * pixel[0]
    for _ in range(_WAVES):
        angle, phase = 2 * pi * random.random(2)
        k = pi / feature * random.uniform(0.5, 1.3)
        field += np.cos(k * (np.cos(angle) * x + np.sin(angle) * y) + phase)
    second = (field > np.quantile(field, 1 - share)).astype(float)
    if interphase == 0:
        return second
    smooth = gaussian_filter(second, [interphase / _SIGMAS / p for p in pixel], mode="nearest")
    # The ends of a Gaussian are cut off, so that pure phases are pure.
    return np.clip(1.1 * smooth - 0.05, 0, 1)

"""Named samples, each with the published source of its values.

Every function returns a sample of ``softafm.rheology``; what a source does not give is a parameter.
"""

from collections.abc import Callable

from softafm.checks.validate import check_finite
from softafm.rheology import Elastic, GeneralizedMaxwell, Solid, StandardLinearSolid


def ldpe() -> StandardLinearSolid:
    """Low-density polyethylene, as tapped in Rajabifar et al. 2021, Table 1.

    They use it with a Lennard-Jones law of 1e-19 J and z0 = 0.25 nm.

    References
    ----------
    B. Rajabifar, R. Wagner and A. Raman, Mater. Res. Express 8, 095304 (2021).
    """
    return StandardLinearSolid(E0=2e9, E_inf=0.1e9, creep_time=1e-7, poisson=0.49)


def polystyrene() -> StandardLinearSolid:
    """Polystyrene, as tapped in Rajabifar et al. 2021, Table 3.

    They use it with a Lennard-Jones law of 2e-20 J and z0 = 0.15 nm.

    References
    ----------
    B. Rajabifar, R. Wagner and A. Raman, Mater. Res. Express 8, 095304 (2021).
    """
    return StandardLinearSolid(E0=4.25e9, E_inf=1.89e9, creep_time=1e-7, poisson=0.35)


def pdms(mixing_ratio: float = 10.0) -> Elastic:
    """Cross-linked silicone (PDMS), elastic, of a base to curing agent ratio from 5 to 33.

    E = 20 MPa/ratio, as Wang et al. 2014 found in compression. For a ratio of 10 that is 2 MPa;
    Johnston et al. 2014 report 1.32 to 2.97 MPa in tension, rising with the curing temperature from
    25 to 200 °C. Rubber is incompressible.

    Parameters
    ----------
    mixing_ratio
        Mass of base to that of curing agent, 5 to 33.

    Raises
    ------
    ValueError
        If the ratio was not measured.

    References
    ----------
    Z. Wang, A. A. Volinsky and N. D. Gallant, J. Appl. Polym. Sci. 131, 41050 (2014).
    I. D. Johnston et al., J. Micromech. Microeng. 24, 035017 (2014).
    """
    ratio = check_finite("mixing_ratio", mixing_ratio, "")
    if not 5 <= ratio <= 33:
        raise ValueError(f"mixing_ratio = {ratio:g}: must be from 5 to 33, as was measured")
    return Elastic(E=20e6 / ratio, poisson=0.5)


def polyisobutylene() -> GeneralizedMaxwell:
    """Polyisobutylene at 25 °C, a melt: from glass at 0.1 ns over rubber at 1 s to flow in days.

    28 terms, read from Fig. 7.19 of Brinson and Brinson, who fitted them to the tensile relaxation
    measured by Catsiff and Tobolsky (two more of 0.1 Pa are left out). Incompressible.

    References
    ----------
    H. F. Brinson and L. C. Brinson, Polymer Engineering Science and Viscoelasticity, Springer
    (2008), Figs. 7.18 and 7.19; read off by E. A. López-Guerra, github.com/ealopez/
    TappingMode_Simulations. E. Catsiff and A. V. Tobolsky, J. Colloid Sci. 10, 375 (1955).
    """
    times, moduli = zip(*_POLYISOBUTYLENE, strict=True)
    return GeneralizedMaxwell(E_inf=0.0, moduli=moduli, relaxation_times=times, poisson=0.5)


def epoxy(poisson: float = 0.35) -> GeneralizedMaxwell:
    """Cured epoxy, from a glass of 0.9 GPa (shear modulus) to a rubber of 4.9 MPa.

    24 terms for the shear modulus at half decades from 0.1 µs. The source gives no Poisson's ratio.

    Parameters
    ----------
    poisson
        Poisson's ratio, in (-1, 0.5].

    References
    ----------
    S. L. Simon, G. B. McKenna and O. Sindt, J. Appl. Polym. Sci. 76, 495 (2000).
    """
    glass, rubber = 891e6, 4.9e6
    moduli = tuple((glass - rubber) * share for share in _EPOXY)
    times = (*(10 ** (-7 + k / 2) for k in range(23)), 1e5)
    return GeneralizedMaxwell.from_shear(rubber, moduli, times, poisson)


NAMED: dict[str, Callable[..., Solid]] = {
    "ldpe": ldpe,
    "polystyrene": polystyrene,
    "pdms": pdms,
    "polyisobutylene": polyisobutylene,
    "epoxy": epoxy,
}
"""The samples by the name that experiment files call them."""

# Relaxation time, s, and modulus, Pa.
_POLYISOBUTYLENE = (
    (3.22e-12, 1.86e06),
    (1.36e-11, 5.62e07),
    (5.65e-11, 1.29e08),
    (2.34e-10, 3.21e08),
    (1.17e-09, 4.13e08),
    (4.85e-09, 8.23e08),
    (2.25e-08, 6.31e08),
    (9.65e-08, 3.61e08),
    (3.83e-07, 1.53e08),
    (1.67e-06, 4.52e07),
    (7.2e-06, 2.23e07),
    (2.89e-05, 6.1e06),
    (0.000148, 2.61e06),
    (0.000587, 1.11e06),
    (0.00236, 2.82e05),
    (0.00936, 1.29e05),
    (0.0403, 6.35e04),
    (0.18, 7.21e03),
    (0.816, 1.34e04),
    (3.29, 9.28e04),
    (13.0, 4.57e04),
    (58.5, 1.31e05),
    (297.0, 8.11e04),
    (1050.0, 1.39e05),
    (5280.0, 1.07e05),
    (26400.0, 1.28e05),
    (88000.0, 6.26e04),
    (412000.0, 3.09e04),
)

_EPOXY = (
    0.0215, 0.0215, 0.0215, 0.0215, 0.0267, 0.0267, 0.0375, 0.0405, 0.0630, 0.0630, 0.1054, 0.1160,
    0.1160, 0.1653, 0.0561, 0.0561, 0.0199, 0.0119, 0.0055, 0.0028, 0.0008, 0.0002, 0.0003, 0.0003,
)  # fmt: skip

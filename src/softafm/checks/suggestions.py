"""Which known name is probably meant by one that is not known."""

from collections.abc import Sequence
from difflib import get_close_matches

_MOST = 3
_OTHER_WORDS = {
    # tables
    "cantilever": "lever spring beam",
    "tip": "probe indenter",
    "sample": "material specimen substrate polymer",
    "surface": "law force forces adhesion interaction potential",
    "motion": "drive oscillation ramp approach path excitation protocol",
    "run": "settings options accuracy",
    "map": "image scan",
    # how a table chooses
    "shape": "type kind geometry form profile",
    "model": "type kind material rheology",
    "law": "type kind potential model",
    "name": "type kind solver",
    # keys
    "stiffness": "k springconstant spring kc",
    "quality_factor": "q quality qfactor",
    "frequency": "f f0 freq resonance resonancefrequency",
    "drive_frequency": "f frequency drive",
    "E": "modulus young youngmodulus youngsmodulus e0 elasticmodulus",
    "E0": "e modulus young youngmodulus youngsmodulus glassymodulus instantaneousmodulus",
    "E_inf": "relaxedmodulus rubberymodulus einfinity eequilibrium",
    "G0": "g shearmodulus",
    "poisson": "nu ν poissonratio poissonsratio",
    "creep_time": "tau τ time retardationtime",
    "relaxation_time": "tau τ time",
    "viscosity": "eta η damping",
    "moduli": "prony pronyseries weights",
    "radius": "r tipradius radiusofcurvature",
    "half_angle": "angle openingangle halfopeningangle alpha",
    "hamaker": "a h ah hamakerconstant",
    "work_of_adhesion": "w gamma adhesion adhesionenergy surfaceenergy",
    "z0": "r0 d0 a0 equilibriumdistance distance sigma",
    "amplitude": "a amp",
    "free_amplitude": "a a0 amp amplitude freeamp",
    "mean_height": "z zc height meanposition",
    "speed": "v velocity rate rampspeed",
    "start": "z zstart from",
    "turn": "depth zmin indentation to end stop lowest",
    "setpoint_force": "setpoint trigger triggerforce maxforce force",
    "setpoint": "amplituderatio ratio",
    "dwell": "hold holdtime wait pause",
    "tolerance": "tol accuracy error",
    # modes of maps
    "tapping-map": "tapping am amplitudemodulation",
    "force-volume": "forcemap",
    # choices
    "iterative": "implicit",
    "sphere": "ball bead colloid colloidalprobe",
    "cone": "pyramid conical",
    "flat-punch": "cylinder",
    "measured": "file profile",
    "standard-linear-solid": "sls zener standardsolid",
    "kelvin-voigt": "kv voigt",
    "generalized-maxwell": "prony pronyseries wiechert maxwellwiechert",
    "measured-moduli": "dma mastercurve file",
    "power-law": "springpot sgr",
    "fractional-standard-linear-solid": "fractional fractionalzener",
    "elastic": "hertz linearelastic",
    "ldpe": "pe polyethylene",
    "polystyrene": "ps",
    "polyisobutylene": "pib polyisobutene",
    "pdms": "silicone sylgard",
    "lennard-jones": "lj 126",
    "van-der-waals": "vdw",
    "dugdale": "maugis maugisdugdale",
    "dlvo": "electrostatic doublelayer",
    "repulsion": "steric brush",
    "tabulated": "table file",
}
"""What else a name is called, without case, spaces, hyphens and underscores."""
_LIMITS = {
    **dict.fromkeys(("jkr", "dmtjkr", "jkrdmt"), ("JKR", "a law with adhesion on a soft sample")),
    **dict.fromkeys(("hertz", "hertzian"), ("Hertz", "a law without adhesion, 'repulsion'")),
}
"""Theories of contact that are taken for laws, and of what they are the limit."""


def call_also(name: str, words: str) -> None:
    """Add other words for a name, in small letters without hyphens, separated by spaces."""
    _OTHER_WORDS[name] = words


def explain_limit(given: str) -> str:
    """Say of a theory of contact given as a surface law what it is instead; else return ""."""
    name, what = _LIMITS.get(_simplify(given), ("", ""))
    return name and (
        f"{name} is no law but the limit of {what}; its closed form is in softafm.indentation; "
    )


def guess(given: str, valid: Sequence[str]) -> list[str]:
    """Return the valid names that are probably meant by ``given``, or none.

    In this order: the same but for case, hyphens and underscores; another word for it; a slip of
    the keyboard; a part of it; and at last what is similar.
    """
    plain = {name: _simplify(name) for name in valid}
    wanted = _simplify(given)
    if not wanted:
        return []
    slips = 1 if len(wanted) < 6 else 2
    readings = (
        [name for name in valid if plain[name] == wanted],
        [name for name in valid if wanted in _OTHER_WORDS.get(name, "").split()],
        [name for name in valid if len(wanted) > 2 and _count_slips(wanted, plain[name]) <= slips],
        [name for name in valid if len(wanted) > 2 and wanted in plain[name]],
    )
    similar = get_close_matches(wanted, plain.values(), n=1, cutoff=0.75)
    found = next(filter(None, readings), [name for name in valid if plain[name] in similar])
    return found[:_MOST]


def _simplify(name: str) -> str:
    return "".join(c for c in name.casefold() if c not in "-_ ")


def _count_slips(one: str, other: str) -> int:
    """Count letters left out, added, changed, or swapped with a neighbour between two words."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one):
        above, row = row, [i + 1]
        for j, wanted in enumerate(other):
            cost = min(above[j + 1] + 1, row[j] + 1, above[j] + (letter != wanted))
            if i and j and letter == other[j - 1] and one[i - 1] == wanted:
                cost = min(cost, before[j - 1] + 1)
            row.append(cost)
        before = above
    return row[-1]

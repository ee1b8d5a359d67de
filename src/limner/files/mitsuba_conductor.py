"""What metals reflect straight on, by the names that Mitsuba knows them by, and by their complex index of refraction.

    F0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)

The table holds F0 in linear Rec. 709: that formula at each wavelength from 380 to 780 nm, seen by the CIE 1931 observer under D65, over the
same of a white mirror, and limited to [0, 1].

**Source**: optical constants as published by E. D. Palik, *Handbook of Optical Constants of Solids* (1985), and in the SOPRA and LUXPOP
collections; the formula is Fresnel's at normal incidence.
"""

from __future__ import annotations

from ..color.metals import normal_reflectance

__all__ = ["CONDUCTORS", "IOR", "normal_reflectance", "reflectance_of"]

Triple = tuple[float, float, float]


def reflectance_of(name: str) -> Triple | None:
    """F0 of a metal by its name; None: there is no such metal."""
    return CONDUCTORS.get(name) or CONDUCTORS.get(name.removesuffix("_palik")) or CONDUCTORS.get(f"{name}_palik")


CONDUCTORS: dict[str, Triple] = {
    "Ag": (0.9715, 0.9599, 0.9153), "Al": (0.9132, 0.9215, 0.9245), "AlAs": (0.2864, 0.2606, 0.4782),
    "AlSb": (0.3507, 0.3850, 0.4776), "Au": (1.0, 0.7824, 0.3434), "Be": (0.5391, 0.5379, 0.5370), "Cr": (0.6347, 0.6622, 0.7046),
    "CsI": (0.0785, 0.0810, 0.0856), "Cu": (0.9554, 0.6376, 0.5382), "Cu2O": (0.2430, 0.2648, 0.2730),
    "CuO": (0.2209, 0.2169, 0.2157), "Cu_palik": (0.9533, 0.6391, 0.5370), "Hg": (0.7815, 0.7796, 0.7784),
    "HgTe": (0.4048, 0.3842, 0.3852), "Ir": (0.7008, 0.6931, 0.6565), "K": (0.9497, 0.9375, 0.9207), "Li": (0.9158, 0.8890, 0.8080),
    "MgO": (0.0720, 0.0731, 0.0749), "Mo": (0.5585, 0.5791, 0.5704), "Na_palik": (0.9770, 0.9612, 0.9362),
    "Nb": (0.5038, 0.5070, 0.5049), "Ni_palik": (0.6594, 0.6086, 0.5258), "Rh": (0.7970, 0.7646, 0.7425),
    "Se": (0.3158, 0.2697, 0.2756), "Se-e": (0.4393, 0.4217, 0.4556), "SiC": (0.2016, 0.2063, 0.2144),
    "SnTe": (0.3651, 0.1219, 0.0307), "Ta": (0.3891, 0.3603, 0.4122), "Te": (0.5723, 0.5932, 0.5842), "Te-e": (0.6565, 0.6859, 0.6721),
    "ThF4": (0.0425, 0.0427, 0.0433), "TiC": (0.4889, 0.4580, 0.4450), "TiN": (0.6138, 0.4615, 0.2327),
    "TiO2": (0.2322, 0.2447, 0.2727), "TiO2-e": (0.1936, 0.2046, 0.2286), "VC": (0.4695, 0.4364, 0.4141),
    "VN": (0.4695, 0.4101, 0.3451), "V_palik": (0.5110, 0.5278, 0.5651), "W": (0.5153, 0.4959, 0.4676), "a-C": (0.2117, 0.2120, 0.1999),
    "d-C": (0.1711, 0.1729, 0.1765),
}  # fmt: skip
"""F0 by name."""

IOR = {
    "vacuum": 1.0, "helium": 1.000036, "hydrogen": 1.000132, "air": 1.000277, "carbon dioxide": 1.00045, "water": 1.333, "acetone": 1.36,
    "ethanol": 1.361, "carbon tetrachloride": 1.461, "glycerol": 1.4729, "benzene": 1.501, "silicone oil": 1.52045, "bromine": 1.661,
    "water ice": 1.31, "fused quartz": 1.458, "pyrex": 1.47, "acrylic glass": 1.49, "polypropylene": 1.49, "bk7": 1.5046,
    "sodium chloride": 1.544, "amber": 1.55, "pet": 1.575, "diamond": 2.419,
}  # fmt: skip
"""Indices of refraction of what light goes through, by name."""

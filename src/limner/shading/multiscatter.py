"""What a rough surface loses because light that goes from facet to facet is not followed, given back.

A lobe of single reflections sends on less of an even sky than its reflectance says, at roughness 1 less than half. Scaled up by

    1 + F0 (1 - E) / E,

E the share that facets which reflect everything send on towards this eye, it sends on all of it where F0 is 1; where F0 is less, each
further reflection takes its toll.

**Source**: Turquin, *Practical multiple scattering compensation for microfacet models*, Industrial Light & Magic 2019, eq. 16. E is the
table that the blurred sky is weighed by (`albedo_table`). It depends on the eye alone, so the lobe is no longer the same both ways.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel, outlined
from ..kernel.vec import ONE, Color
from .prefilter import sent_on

__all__ = ["energy_gain", "facets_sent_on"]

f32 = np.float32


@kernel
def facets_sent_on(n_v: np.float32, roughness: np.float32) -> np.float32:
    """E: the share of an even sky that facets which reflect everything send towards the eye."""
    return sent_on(Color(ONE, ONE, ONE), n_v, roughness).r


@outlined
def energy_gain(f0: Color, n_v: np.float32, roughness: np.float32) -> Color:
    """What the lobe is multiplied by."""
    lost = ONE / facets_sent_on(n_v, roughness) - ONE
    return Color(ONE, ONE, ONE) + f0 * lost

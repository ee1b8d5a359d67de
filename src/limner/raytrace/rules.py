"""What has been asked for, as kernels read it: the numbers that are the same for a whole picture."""

from __future__ import annotations

from typing import NamedTuple

from .._jit import kernel
from ..kernel.rng import pixel_word
from ..kernel.sampler import Sampler

__all__ = ["Rules", "rules_of", "sampler_of"]


class Rules(NamedTuple):
    """The numbers, in the order in which they stand in the array that a door takes."""

    has_alpha: int  # 1: some material is not opaque
    shadows: int
    max_depth: int
    tinted: int  # 1: light goes straight through dielectrics to the surfaces behind
    glossy: int  # 1: rough mirrors are followed by rays
    emitters: int  # 1: shining surfaces light others
    sampler: int  # kind
    seed: int
    n: int  # samples of a pixel in all
    columns: int  # of the grid of n


@kernel
def rules_of(numbers) -> Rules:
    """The rules that stand in an array."""
    return Rules(
        numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5], numbers[6], numbers[7], numbers[8], numbers[9]
    )


@kernel
def sampler_of(rules: Rules, i: int, j: int, sample: int) -> Sampler:
    """Who asks for a sample of pixel (i, j)."""
    return Sampler(rules.sampler, pixel_word(rules.seed, i, j), sample, rules.n, rules.columns)

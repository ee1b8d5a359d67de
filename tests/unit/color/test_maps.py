"""Colour maps: the published tables to the digit, the diverging one from its formula, and what numbers become."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

from limner.color.map_tables import TABLES
from limner.color.maps import COLOR_MAPS, encoded_map, mapped
from limner.color.transfer import linear_from_srgb, srgb_from_linear
from limner.errors import SceneError, UnsupportedError

# SHA-256 of the hexadecimal digits of each table as its authors published it, rounded to eight bits.
DIGESTS = {
    "viridis": "72942e7610408302", "magma": "88fc6c51a8dc24d5", "inferno": "c17f032e43927a99", "plasma": "807a3e692fe5e5c8",
    "cividis": "d4c8b1cb933d5ed8", "turbo": "b13497b0473a512b",
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(DIGESTS))
def test_tables_are_the_published_ones(name: str) -> None:
    """No digit of a table has changed since it was compared with its authors' own."""
    assert hashlib.sha256(TABLES[name].encode()).hexdigest().startswith(DIGESTS[name])
    assert encoded_map(name).shape == (256, 3)


def test_cool_warm_is_moreland_s() -> None:
    """The formula gives the table that its author published (33 colours), here its ends, middle and quarters."""
    published = {
        0: (0.2298057, 0.298717966, 0.753683153), 8: (0.5543118699, 0.6900970119, 0.9955155482), 16: (0.865395197, 0.86541021, 0.865395561),
        24: (0.956653, 0.598033, 0.477302), 32: (0.705673158, 0.01555616, 0.150232812),
    }  # fmt: skip
    for k, color in published.items():
        assert np.allclose(encoded_map("cool_warm")[8 * k], color, atol=0.006), k


@pytest.mark.parametrize("name", ["viridis", "magma", "inferno", "plasma", "cividis", "grey"])
def test_sequential_maps_get_lighter_all_the_way(name: str) -> None:
    """Luminance never falls: the order of the numbers is seen in grey, too, and by the colour-blind."""
    luminance = mapped(np.linspace(0.0, 1.0, 64), name, (0.0, 1.0)) @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(luminance) > 0.0).all()


@pytest.mark.parametrize("name", COLOR_MAPS)
def test_ends_and_what_lies_beyond_them(name: str) -> None:
    """Numbers outside the range, infinite ones too, have the colours of its ends; those are the table's own, decoded."""
    colors = mapped([-np.inf, -7.0, 2.0, 5.0, 9.0, np.inf], name, (2.0, 5.0))
    assert (colors[:3] == colors[0]).all()
    assert (colors[3:] == colors[5]).all()
    assert np.allclose(colors[[0, 5]], linear_from_srgb(encoded_map(name)[[0, -1]]), atol=1e-6)


def test_nan_and_constant_values() -> None:
    """What is no number has the colour that is kept for it; where all are the same, they have the middle one."""
    colors = mapped([np.nan, 1.0, 3.0], "grey", nan_color=(0.5, 0.0, 0.25))
    assert colors.tolist() == [[0.5, 0.0, 0.25], [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]
    assert np.allclose(srgb_from_linear(mapped([4.0, 4.0], "grey")), 0.5)
    assert np.isfinite(mapped([-1.7e308, 0.0, 1.7e308])).all()


def test_one_s_own_map_and_shapes() -> None:
    """Any row of linear colours is a map; the shape of the numbers is kept."""
    colors = mapped(np.zeros((2, 3, 1)), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], (0.0, 1.0))
    assert colors.shape == (2, 3, 1, 3)
    assert (colors == [1.0, 0.0, 0.0]).all()


def test_what_is_refused() -> None:
    """Unknown maps (with the known ones), ranges that are none, and values without any number."""
    with pytest.raises(UnsupportedError, match=r"viridis, magma.*got 'jet'"):
        mapped([1.0], "jet")
    with pytest.raises(SceneError, match="range must be finite"):
        mapped([1.0], range=(1.0, 0.0))
    with pytest.raises(SceneError, match="no finite number"):
        mapped([np.nan, np.nan])
    with pytest.raises(SceneError, match=r"\[0, 1\]"):
        mapped([1.0], [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    with pytest.raises(SceneError, match="values must be numbers"):
        mapped(["red"])

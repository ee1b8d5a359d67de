"""Pictures taken apart by ids: masks, boxes, run lengths; pycocotools reads them as they are meant."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from limner.errors import SceneError, UnsupportedError
from limner.image.image import Image
from limner.produce.masks import mask_from_counts, masks, regions

id_pictures = arrays.arrays(
    np.int32, st.tuples(st.integers(1, 12), st.integers(1, 12)), elements=st.integers(-1, 4)
)  # fmt: skip


def _image(ids: np.ndarray, names: tuple[str, ...], channel: str = "instance_id") -> Image:
    return Image(np.zeros((*ids.shape, 4), dtype=np.float32), aov={channel: ids}, id_names={channel: names})


def test_masks_by_name() -> None:
    """Those that are seen, in order; one name, one mask; nothing belongs to nobody."""
    ids = np.array([[-1, 0, 2], [3, 0, -1]], dtype=np.int32)
    found = masks(_image(ids, ("wall", "hidden", "leg", "wall")))
    assert list(found) == ["wall", "leg"]
    assert found["wall"].tolist() == [[False, True, False], [True, True, False]]
    assert found["leg"].tolist() == [[False, False, True], [False, False, False]]
    assert masks(_image(np.full((2, 2), -1, dtype=np.int32), ())) == {}
    by_material = masks(_image(ids, ("a", "b", "c", "d"), "material_id"), by="material")
    assert list(by_material) == ["a", "c", "d"]


def test_slips_are_told() -> None:
    """With the call that would have made it possible."""
    with pytest.raises(SceneError, match='render with aovs=\\("material_id",\\)'):
        masks(_image(np.zeros((2, 2), dtype=np.int32), ("a",)), by="material")
    with pytest.raises(UnsupportedError, match="by must be one of instance, material, got 'triangle'"):
        masks(_image(np.zeros((2, 2), dtype=np.int32), ("a",)), by="triangle")


@given(id_pictures)
def test_regions_describe_the_picture(ids: np.ndarray) -> None:
    """Decoded again, the run lengths are the mask of each id; area and box are those of that mask; ascending, none left out."""
    found = list(regions(ids))
    assert [region.id for region in found] == sorted({int(i) for i in np.unique(ids) if i >= 0})
    for region in found:
        mask = ids == region.id
        np.testing.assert_array_equal(mask_from_counts(region.counts, *ids.shape), mask)
        assert region.area == mask.sum()
        rows, columns = np.nonzero(mask)
        left, top, width, height = region.bbox
        assert (left, top) == (columns.min(), rows.min())
        assert (left + width - 1, top + height - 1) == (columns.max(), rows.max())
        assert all(count > 0 for count in region.counts[1:])


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # of pycocotools
@given(id_pictures)
def test_pycocotools_reads_them(ids: np.ndarray) -> None:
    """The library that the format is known by finds the same mask, area and box."""
    coco = pytest.importorskip("pycocotools.mask", reason="pycocotools belongs to the extra `test`")
    height, width = ids.shape
    for region in regions(ids):
        encoded = coco.frPyObjects({"size": [height, width], "counts": list(region.counts)}, height, width)
        np.testing.assert_array_equal(coco.decode(encoded), ids == region.id)
        assert coco.area(encoded) == region.area
        assert coco.toBbox(encoded).tolist() == list(region.bbox)


@pytest.mark.parametrize("counts", [[1, 2], [-1, 7], [[6]], [2.5, 3.5], [7]])
def test_bad_run_lengths_are_refused(counts: list) -> None:
    """They must be whole, not negative, and add up."""
    with pytest.raises(SceneError, match="add up to 2 x 3"):
        mask_from_counts(counts, 2, 3)

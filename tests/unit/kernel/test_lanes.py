"""Eight lanes are eight scalars: each operation against NumPy, lane by lane, with the numbers that go wrong."""

from __future__ import annotations

import numpy as np
from compiled import door_of

from limner._door import Array
from limner.kernel.lanes import (
    count_set,
    first_set,
    floor8,
    lane,
    load8,
    mask_equal,
    mask_greater,
    mask_greater_equal,
    mask_less,
    mask_less_equal,
    max8,
    min8,
    reduce_max8,
    reduce_min8,
    select8,
    splat8,
    splat8_int,
    sqrt8,
    store8,
    to_float8,
    to_int8,
)

_NASTY = np.array(
    [0, -0.0, 1, -1, np.inf, -np.inf, np.nan, 1e-45, 3e38, -3e38, 0.1, 2.5, -2.5, 1e10, -1e10, 2147483648.0], np.float32
)
FLOATS, MASKS = Array(np.float32, 1), Array(np.int32, 1)


def _pairs() -> tuple[np.ndarray, np.ndarray]:
    """All pairs of nasty numbers, then random ones: two columns whose length is a multiple of eight."""
    rng = np.random.default_rng(1)
    a, b = np.meshgrid(_NASTY, _NASTY)
    return np.r_[a.ravel(), rng.normal(size=256)].astype(np.float32), np.r_[b.ravel(), rng.normal(size=256)].astype(np.float32)


def _arithmetic(a, b, out):
    n = a.shape[0]
    for k in range(0, n, 8):
        x, y = load8(a, k), load8(b, k)
        store8(out, k, x + y)
        store8(out, n + k, x - y)
        store8(out, 2 * n + k, x * y)
        store8(out, 3 * n + k, x / y)
        store8(out, 4 * n + k, -x)
        store8(out, 5 * n + k, min8(x, y))
        store8(out, 6 * n + k, max8(x, y))
        store8(out, 7 * n + k, sqrt8(x))
        store8(out, 8 * n + k, floor8(x))
        store8(out, 9 * n + k, select8(mask_less(x, y), x, y))


def test_arithmetic_rounds_each_lane_like_a_scalar() -> None:
    """Every operation equals NumPy's on float32; minimum and maximum give the second operand where a comparison fails."""
    a, b = _pairs()
    out = np.zeros(10 * len(a), np.float32)
    door_of(_arithmetic, FLOATS, FLOATS, FLOATS)(a, b, out)
    with np.errstate(all="ignore"):
        least, most = np.where(a < b, a, b), np.where(a > b, a, b)
        expected = [a + b, a - b, a * b, a / b, -a, least, most, np.sqrt(a), np.floor(a), least]
    for row, (got, want) in enumerate(zip(out.reshape(10, -1), expected, strict=True)):
        np.testing.assert_array_equal(got, want, err_msg=str(row))
        zero = want == 0.0
        np.testing.assert_array_equal(np.signbit(got[zero]), np.signbit(want[zero]), err_msg=str(row))


def _masks(a, b, out):
    n = a.shape[0] // 8
    for k in range(n):
        x, y = load8(a, 8 * k), load8(b, 8 * k)
        out[k] = mask_less(x, y)
        out[n + k] = mask_less_equal(x, y)
        out[2 * n + k] = mask_greater(x, y)
        out[3 * n + k] = mask_greater_equal(x, y)
        out[4 * n + k] = mask_equal(x, y)


def test_masks_have_a_bit_for_each_lane_and_nan_compares_false() -> None:
    """Bit k of a mask is NumPy's comparison of lane k."""
    a, b = _pairs()
    out = np.zeros(5 * len(a) // 8, np.int32)
    door_of(_masks, FLOATS, FLOATS, MASKS)(a, b, out)
    expected = [np.packbits(truth, bitorder="little") for truth in (a < b, a <= b, a > b, a >= b, a == b)]
    np.testing.assert_array_equal(out.reshape(5, -1), expected)


def _counts(masks, out):
    n = masks.shape[0]
    for k in range(n):
        out[k] = first_set(masks[k])
        out[n + k] = count_set(masks[k])
        out[2 * n + k] = count_set(masks[k] & (masks[k] - 1))


def test_first_and_count_of_every_mask() -> None:
    """All 256 masks: the lowest bit (32 for none), the number of bits, and one fewer once the lowest is cleared."""
    masks = np.arange(256, dtype=np.int32)
    out = np.zeros(3 * 256, np.int32)
    door_of(_counts, MASKS, MASKS)(masks, out)
    bits = np.unpackbits(masks.astype(np.uint8)[:, None], axis=1, bitorder="little")
    first, count, rest = out.reshape(3, -1)
    np.testing.assert_array_equal(first, np.where(masks == 0, 32, np.argmax(bits, axis=1)))
    np.testing.assert_array_equal(count, bits.sum(1))
    np.testing.assert_array_equal(rest, np.maximum(count - 1, 0))


def _selections(a, b, masks, out):
    for k in range(masks.shape[0]):
        store8(out, 8 * k, select8(masks[k], load8(a, 0), load8(b, 0)))


def test_select_takes_each_lane_by_its_bit() -> None:
    """All 256 masks; bits above the eighth do not matter."""
    a, b = np.arange(8, dtype=np.float32), np.arange(8, 16).astype(np.float32)
    masks = np.arange(256, dtype=np.int32)
    out = np.zeros((2, 8 * 256), np.float32)
    for row, high in zip(out, (0, -256), strict=True):
        door_of(_selections, FLOATS, FLOATS, MASKS, FLOATS)(a, b, (masks | high).astype(np.int32), row)
    bits = np.unpackbits(masks.astype(np.uint8)[:, None], axis=1, bitorder="little").astype(bool)
    np.testing.assert_array_equal(out[0].reshape(256, 8), np.where(bits, a, b))
    np.testing.assert_array_equal(out[0], out[1])


def _reductions(a, out):
    n = a.shape[0] // 8
    for k in range(n):
        v = load8(a, 8 * k)
        out[k] = reduce_min8(v)
        out[n + k] = reduce_max8(v)
        out[2 * n + k] = lane(v, k % 8)
        out[3 * n + k] = lane(splat8(out[k]) + v, 7)


def test_reductions_and_single_lanes() -> None:
    """The least and the greatest lane, a lane by its number, and a splat that reaches every lane."""
    a = np.random.default_rng(2).normal(size=(64, 8)).astype(np.float32)
    a[3, 4], a[5, 0] = np.inf, -np.inf
    out = np.zeros(4 * 64, np.float32)
    door_of(_reductions, FLOATS, FLOATS)(a.ravel(), out)
    least, most, picked, splatted = out.reshape(4, -1)
    np.testing.assert_array_equal(least, a.min(1))
    np.testing.assert_array_equal(most, a.max(1))
    np.testing.assert_array_equal(picked, a[np.arange(64), np.arange(64) % 8])
    np.testing.assert_array_equal(splatted, a.min(1) + a[:, 7])


def _integers(a, b, out):
    n = a.shape[0]
    for k in range(0, n, 8):
        x, y = load8(a, k), load8(b, k)
        store8(out, k, x + y)
        store8(out, n + k, x - y)
        store8(out, 2 * n + k, x * y)
        store8(out, 3 * n + k, x & y)
        store8(out, 4 * n + k, x | y)
        store8(out, 5 * n + k, x ^ y)
        store8(out, 6 * n + k, -x)
        store8(out, 7 * n + k, min8(x, y))
        store8(out, 8 * n + k, max8(x, splat8_int(lane(y, 0))))
        out[9 * n + k] = mask_less(x, y)
        out[9 * n + k + 1] = reduce_min8(x)


def test_integer_lanes_wrap_like_int32() -> None:
    """The same for int32 lanes: arithmetic modulo 2^32, bitwise operations, signed comparison."""
    rng = np.random.default_rng(3)
    edges = np.array([0, 1, -1, 2**31 - 1, -(2**31), 65536, -65536, 7], np.int32)
    a = np.r_[edges, edges, rng.integers(-(2**31), 2**31, 48)].astype(np.int32)
    b = np.r_[edges[::-1], edges, rng.integers(-(2**31), 2**31, 48)].astype(np.int32)
    out = np.zeros(10 * len(a), np.int32)
    door_of(_integers, MASKS, MASKS, MASKS)(a, b, out)
    first = np.repeat(b[::8], 8)
    rows = out.reshape(10, -1)
    expected = [a + b, a - b, a * b, a & b, a | b, a ^ b, -a, np.minimum(a, b), np.maximum(a, first)]
    for row, (got, want) in enumerate(zip(rows, expected, strict=False)):
        np.testing.assert_array_equal(got, want, err_msg=str(row))
    np.testing.assert_array_equal(rows[9, ::8], np.packbits(a < b, bitorder="little"))
    np.testing.assert_array_equal(rows[9, 1::8], a.reshape(-1, 8).min(1))


def _conversions(a, integers, back):
    for k in range(0, a.shape[0], 8):
        n = to_int8(load8(a, k))
        store8(integers, k, n)
        store8(back, k, to_float8(n))


def test_conversions_truncate_and_what_does_not_fit_is_the_least_integer() -> None:
    """Towards zero where an int32 can hold it, -2^31 elsewhere and for NaN; back, the nearest float."""
    a = np.r_[_NASTY, np.float32([2147483520.0, -2147483648.0, 0.99, -0.99, 16777217, 1.5, -1.5, 7])].astype(np.float32)
    integers, back = np.zeros(len(a), np.int32), np.zeros(len(a), np.float32)
    door_of(_conversions, FLOATS, MASKS, FLOATS)(a, integers, back)
    expected = [int(x) if np.isfinite(x) and -(2.0**31) <= x < 2.0**31 else -(2**31) for x in a]
    np.testing.assert_array_equal(integers, expected)
    np.testing.assert_array_equal(back, np.float32(expected))


def _shifted(a, out):
    for k in range(a.shape[0] - 7):
        store8(out, 8 * k, load8(a, k))


def test_loads_need_no_alignment() -> None:
    """A window that slides by one element: every address modulo 32 is met."""
    a = np.random.default_rng(4).normal(size=41).astype(np.float32)[1:]
    out = np.zeros(33 * 8, np.float32)
    door_of(_shifted, FLOATS, FLOATS)(a, out)
    np.testing.assert_array_equal(out.reshape(33, 8), np.lib.stride_tricks.sliding_window_view(a, 8))


_NODE = np.dtype([("near", np.float32, 8), ("child", np.int32, 8)], align=True)


def _records(nodes, out):
    for k in range(nodes.shape[0]):
        node = nodes[k]
        x = load8(node["near"], 0) + to_float8(load8(node["child"], 0))
        store8(out[k], 0, x)


def test_loads_from_a_record_and_stores_to_a_row() -> None:
    """Eight-wide fields of a record table and rows of a 2D array are 1D arrays to load and store."""
    nodes = np.zeros(5, _NODE)
    nodes["near"] = np.arange(40).reshape(5, 8)
    nodes["child"] = np.arange(40)[::-1].reshape(5, 8) * 2
    out = np.zeros((5, 8), np.float32)
    door_of(_records, Array(_NODE, 1), Array(np.float32, 2))(nodes, out)
    np.testing.assert_array_equal(out, nodes["near"] + nodes["child"])

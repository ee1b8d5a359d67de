"""Eight lanes are eight scalars: each operation against NumPy, lane by lane, with the numbers that go wrong."""

from __future__ import annotations

import numpy as np
from compiled import door_of

from limner._door import Array
from limner._jit import kernel
from limner.kernel.elementary import atan2, cos, exp2, f32, floor, log2, power, sin, sqrt
from limner.kernel.lanes import (
    all_of,
    any_of,
    at,
    compressed,
    count_set,
    first_set,
    four_bytes,
    highest,
    lane,
    lanes_of,
    load8,
    long8,
    lowest,
    mask_of,
    max,
    min,
    put,
    splat8,
    splat8_int,
    spread,
    store8,
    to_float,
    to_int,
    where,
)
from limner.kernel.vec import ONE, ZERO, Color, Vec3, dot, max_component, normalize, reflect

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
        store8(out, 5 * n + k, min(x, y))
        store8(out, 6 * n + k, max(x, y))
        store8(out, 7 * n + k, sqrt(x))
        store8(out, 8 * n + k, floor(x))
        store8(out, 9 * n + k, where(x < y, x, y))


def test_arithmetic_rounds_each_lane_like_a_scalar() -> None:
    """Every operation equals NumPy's on float32; minimum and maximum give the first operand where a comparison fails, as Python's do."""
    a, b = _pairs()
    out = np.zeros(10 * len(a), np.float32)
    door_of(_arithmetic, FLOATS, FLOATS, FLOATS)(a, b, out)
    with np.errstate(all="ignore"):
        least, most = np.where(b < a, b, a), np.where(b > a, b, a)
        expected = [a + b, a - b, a * b, a / b, -a, least, most, np.sqrt(a), np.floor(a), np.where(a < b, a, b)]
    for row, (got, want) in enumerate(zip(out.reshape(10, -1), expected, strict=True)):
        np.testing.assert_array_equal(got, want, err_msg=str(row))
        zero = want == 0.0
        np.testing.assert_array_equal(np.signbit(got[zero]), np.signbit(want[zero]), err_msg=str(row))


def _masks(a, b, out):
    n = a.shape[0] // 8
    for k in range(n):
        x, y = load8(a, 8 * k), load8(b, 8 * k)
        out[k] = mask_of(x < y)
        out[n + k] = mask_of(x <= y)
        out[2 * n + k] = mask_of(x > y)
        out[3 * n + k] = mask_of(x >= y)
        out[4 * n + k] = mask_of(x == y)


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


def _compressions(a, masks, out):
    for k in range(masks.shape[0]):
        store8(out, 8 * k, compressed(load8(a, 0), lanes_of(masks[k])))


def test_what_is_compressed_keeps_its_order() -> None:
    """All 256 masks: the chosen lanes in front, as they stood."""
    a, masks, out = np.arange(8, dtype=np.float32), np.arange(256, dtype=np.int32), np.zeros(8 * 256, np.float32)
    door_of(_compressions, FLOATS, MASKS, FLOATS)(a, masks, out)
    for mask, row in zip(masks, out.reshape(256, 8), strict=True):
        chosen = a[(mask >> np.arange(8)) & 1 == 1]
        np.testing.assert_array_equal(row[: len(chosen)], chosen)


def _selections(a, b, masks, out):
    for k in range(masks.shape[0]):
        store8(out, 8 * k, where(lanes_of(masks[k]), load8(a, 0), load8(b, 0)))


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
        out[k] = lowest(v)
        out[n + k] = highest(v)
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
        store8(out, 7 * n + k, min(x, y))
        store8(out, 8 * n + k, max(x, splat8_int(lane(y, 0))))
        out[9 * n + k] = mask_of(x < y)
        out[9 * n + k + 1] = lowest(x)


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
        n = to_int(load8(a, k))
        store8(integers, k, n)
        store8(back, k, to_float(n))


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
        x = load8(node["near"], 0) + to_float(load8(node["child"], 0))
        store8(out[k], 0, x)


def test_loads_from_a_record_and_stores_to_a_row() -> None:
    """Eight-wide fields of a record table and rows of a 2D array are 1D arrays to load and store."""
    nodes = np.zeros(5, _NODE)
    nodes["near"] = np.arange(40).reshape(5, 8)
    nodes["child"] = np.arange(40)[::-1].reshape(5, 8) * 2
    out = np.zeros((5, 8), np.float32)
    door_of(_records, Array(_NODE, 1), Array(np.float32, 2))(nodes, out)
    np.testing.assert_array_equal(out, nodes["near"] + nodes["child"])


@kernel
def _formula(x, y, table, k):
    """What shading does: vectors, choices, elementary functions, tables."""
    n = normalize(Vec3(x, y, ONE))
    c = Color(x, y, ONE) * power(max(ZERO, dot(n, reflect(Vec3(y, ONE, x), n))), f32(3.5))
    turned = where((x > ZERO) & (y < x), sin(x), cos(y) + atan2(x, y))
    bright = spread(ZERO, x)
    if any_of(x > f32(0.5)):
        bright = where(x > f32(0.5), log2(abs(x)) * exp2(y), bright)
    if all_of(y > f32(10.0)):
        bright = -bright
    folded = x - floor(x) + to_float(min(to_int(y * f32(3.0)), 2))
    return max_component(where(x < y, c, Color(ONE, x, ZERO))) + turned + bright + folded * at(table, (k, 1))


def _one_and_eight(a, b, table, rows, one, eight):
    for k in range(a.shape[0]):
        one[k] = _formula(a[k], b[k], table, np.int64(rows[k]))
    for k in range(0, a.shape[0], 8):
        store8(eight, k, _formula(load8(a, k), load8(b, k), table, load8(rows, k)))


def test_a_formula_of_eight_is_the_formula_of_one() -> None:
    """The same kernel, called with numbers and with lanes: the same bits."""
    rng = np.random.default_rng(5)
    a, b = rng.normal(size=(2, 1024)).astype(np.float32)
    table, rows = rng.normal(size=(10, 3)).astype(np.float32), rng.integers(0, 10, 1024).astype(np.int32)
    one, eight = np.zeros(1024, np.float32), np.zeros(1024, np.float32)
    door_of(_one_and_eight, FLOATS, FLOATS, Array(np.float32, 2), MASKS, FLOATS, FLOATS)(a, b, table, rows, one, eight)
    assert np.ptp(one) > 1.0
    np.testing.assert_array_equal(one.view(np.int32), eight.view(np.int32))


def _memory(rows, data, out, scattered):
    index = load8(rows, 0)
    store8(out, 0, four_bytes(data, 4, index))
    store8(out, 8, at(data, index))
    out[16] = four_bytes(data, 4, 1)
    out[17] = at(data, 5)
    put(scattered, index, index * 10 + 1)
    put(scattered, 4, data[2])
    wide = long8(index + 65536) * long8(index + 65536)
    out[18] = mask_of(wide > 2**32 + 3 * 2**18)


def test_gathers_scatters_and_long_lanes() -> None:
    """Bytes as numbers and as words, the first one lowest; products beyond 32 bits."""
    rows = np.array([3, 0, 7, 1, 1, 6, 2, 5], np.int32)
    data = np.random.default_rng(6).integers(0, 256, 64).astype(np.uint8)
    out, scattered = np.zeros(24, np.int32), np.zeros(8, np.int32)
    door_of(_memory, MASKS, Array(np.uint8, 1), MASKS, MASKS)(rows, data, out, scattered)
    words = data[4:].view("<i4")
    np.testing.assert_array_equal(out[:8], words[rows])
    np.testing.assert_array_equal(out[8:16], data[rows])
    assert (out[16], out[17]) == (words[1], data[5])
    np.testing.assert_array_equal(scattered, [1, 11, 21, 31, data[2], 51, 61, 71])
    assert out[18] == np.packbits((rows.astype(np.int64) + 65536) ** 2 > 2**32 + 3 * 2**18, bitorder="little")[0]

"""Red, green and blue of one space as those of another: decode, mix, encode. The curves take eight numbers at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._jit import kernel
from ..kernel.elementary import power
from ..kernel.lanes import load8, store8, where

__all__ = ["convert_rgb"]

f32 = np.float32
_ZERO = f32(0.0)
_GREATEST = f32(3.0e38)
_BLOCK = 1536  # numbers: in the nearest cache from one step to the next


@kernel
def _decoded(stored: Any, gamma: Any, scale: Any, offset: Any, slope: Any, joint: Any) -> Any:
    """``((|s| + offset) / scale)^gamma`` from the joint on, ``slope |s|`` below; with the sign of s. What is not finite stays."""
    size = abs(stored)
    light = where(size < joint, size * slope, power((size + offset) * scale, gamma))
    return where(size <= _GREATEST, where(stored < _ZERO, -light, light), stored)


@kernel
def _encoded(light: Any, gamma: Any, scale: Any, offset: Any, slope: Any, joint: Any) -> Any:
    """``scale |x|^gamma - offset`` from the joint on, ``slope |x|`` below; with the sign of x. What is not finite stays."""
    size = abs(light)
    stored = where(size < joint, size * slope, scale * power(size, gamma) - offset)
    return where(size <= _GREATEST, where(light < _ZERO, -stored, stored), light)


@kernel
def _decode_block(source: Any, target: Any, start: Any, count: Any, curve: Any) -> None:
    gamma, scale, offset, slope, joint = curve[0], curve[1], curve[2], curve[3], curve[4]
    whole = count - count % 8
    for i in range(0, whole, 8):
        store8(target, start + i, _decoded(load8(source, start + i), gamma, scale, offset, slope, joint))
    for i in range(whole, count):
        target[start + i] = _decoded(source[start + i], gamma, scale, offset, slope, joint)


@kernel
def _encode_block(target: Any, start: Any, count: Any, curve: Any) -> None:
    gamma, scale, offset, slope, joint = curve[0], curve[1], curve[2], curve[3], curve[4]
    whole = count - count % 8
    for i in range(0, whole, 8):
        store8(target, start + i, _encoded(load8(target, start + i), gamma, scale, offset, slope, joint))
    for i in range(whole, count):
        target[start + i] = _encoded(target[start + i], gamma, scale, offset, slope, joint)


@kernel
def _copy_block(source: Any, target: Any, start: Any, count: Any) -> None:
    whole = count - count % 8
    for i in range(0, whole, 8):
        store8(target, start + i, load8(source, start + i))
    for i in range(whole, count):
        target[start + i] = source[start + i]


@kernel
def _mix_block(target: Any, start: Any, count: Any, matrix: Any) -> None:
    """Mix in place: where one array is read and another written, the compiler fears that they overlap, and takes numbers one by one."""
    m00, m01, m02 = matrix[0], matrix[1], matrix[2]
    m10, m11, m12 = matrix[3], matrix[4], matrix[5]
    m20, m21, m22 = matrix[6], matrix[7], matrix[8]
    for k in range(count // 3):
        i = start + 3 * k
        red, green, blue = target[i], target[i + 1], target[i + 2]
        target[i] = m00 * red + m01 * green + m02 * blue
        target[i + 1] = m10 * red + m11 * green + m12 * blue
        target[i + 2] = m20 * red + m21 * green + m22 * blue


@kernel
def convert_rgb(source: Any, target: Any, decode: Any, matrix: Any, encode: Any, is_curved: Any, is_mixed: Any, is_encoded: Any) -> None:
    """Convert (3 n,) numbers; curves are (gamma, scale, offset, slope, joint), the matrix is (9,), row by row."""
    total = source.shape[0]
    for start in range(0, total, _BLOCK):
        count = min(_BLOCK, total - start)
        if is_curved != 0:
            _decode_block(source, target, start, count, decode)
        else:
            _copy_block(source, target, start, count)
        if is_mixed != 0:
            _mix_block(target, start, count, matrix)
        if is_encoded != 0:
            _encode_block(target, start, count, encode)

"""The sRGB decoding curve at the 256 codes of eight bits, for kernels: texels stay bytes and are decoded by look-up."""

from __future__ import annotations

import numpy as np

from .transfer import linear_from_srgb

__all__ = ["SRGB_DECODE"]

SRGB_DECODE = linear_from_srgb(np.arange(256) / 255.0).astype(np.float32)
"""(256,) float32: linear value of each code. **Source**: IEC 61966-2-1."""

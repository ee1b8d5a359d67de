"""The graphics pipeline (FoCG 8): vertices, clipping, viewport, rasterisation, depth, fragments, resolve. `pipeline` is its diagram."""

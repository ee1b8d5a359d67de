"""A mesh becomes another: displaced, made finer or coarser, cut, combined with others."""

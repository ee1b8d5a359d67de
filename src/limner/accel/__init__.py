"""One ray, many shapes: `build`, `nearest` and `occluded`, by a tree of boxes or one after the other."""

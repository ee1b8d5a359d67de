"""One ray, one shape: where does it hit? `intersect_*` return the ray's parameter, infinity for a miss."""

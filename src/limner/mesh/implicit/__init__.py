"""Triangles of a surface that is given by a function: where f(p) = 0 (FoCG 22)."""

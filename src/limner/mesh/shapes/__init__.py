"""Meshes that are made: solids, surfaces and sheets by a few numbers, and what sweeps an outline or a profile into one (FoCG 12.1)."""

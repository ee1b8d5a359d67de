"""Flattening: a surface cut into charts, each laid into the plane with little distortion, all packed into one square (FoCG 11.1)."""

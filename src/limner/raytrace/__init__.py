"""Ray tracing (FoCG 4, 13): the camera's rays, what they meet, and where they go from there."""

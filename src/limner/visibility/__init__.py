"""What a ray reaches: the point that it hits, the light that comes from there, and where the next ray starts."""

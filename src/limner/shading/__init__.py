"""Light meets matter: what is at a point, what it is made of, what light does there. All renderers shade with these functions."""

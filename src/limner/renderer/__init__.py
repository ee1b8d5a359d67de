"""What stands behind the door: a Renderer, what it was told, what it keeps, what lies beside its pictures."""

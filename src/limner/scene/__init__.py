"""What a person writes: frozen descriptions of everything in a scene. Nothing here is compiled."""

"""Drawing in two dimensions onto a picture: pixel lines, antialiased shapes and strokes, text, SVG, lines behind surfaces."""

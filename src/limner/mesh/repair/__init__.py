"""Making a mesh sound: what is torn is joined, what is turned over is turned back, what is open is closed."""

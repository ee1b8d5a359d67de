"""What is known of a mesh without changing it: its topology, its size, how it bends, what may be wrong with it (FoCG 12.1.1)."""

"""Values that kernels compute with: vectors, colours, eight lanes, elementary functions, random numbers."""

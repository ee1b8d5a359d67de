"""What kernels read: flat record arrays made from a scene. The only room that sees both the scene and the arrays."""

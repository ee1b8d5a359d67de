"""Triangle meshes: what a mesh is stands here, what is done with it in rooms of its own.

    mesh, adjacency, components, weld, sizes      what all the rooms stand on
    normals, tangents, projection                 what lives on a mesh: directions and texture coordinates
    polygons                                      polygons become triangles
    shapes/      makes meshes                     examine/     says what they are like
    repair/      makes them sound                 reshape/     makes others of them
    subdivide/   makes them smooth                unwrap/      lays them flat, for textures
    implicit/    finds them where a function is zero
"""

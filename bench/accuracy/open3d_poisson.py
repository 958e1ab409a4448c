"""Screened Poisson (Kazhdan and Hoppe 2013) of Open3D: open3d_poisson.py CLOUD MESH VOXEL [--largest-part]

VOXEL is the width of the finest octree cells; a width takes precedence over the depth, and the octree's box is widened
until it holds a power of two of such cells. Everything else is Open3D's default.
"""
import sys

import numpy as np
import open3d


def keep_largest_part(mesh):
    """By area, as a user would who wants to be rid of specks."""
    parts, _, areas = mesh.cluster_connected_triangles()
    mesh.remove_triangles_by_mask(np.asarray(parts) != int(np.argmax(areas)))
    mesh.remove_unreferenced_vertices()


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    cloud = open3d.io.read_point_cloud(sys.argv[1])
    mesh, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, width=float(sys.argv[3]), n_threads=1)
    if "--largest-part" in sys.argv[4:]:
        keep_largest_part(mesh)
    if not open3d.io.write_triangle_mesh(sys.argv[2], mesh):
        sys.exit(f"{sys.argv[2]}: cannot be written")


if __name__ == "__main__":
    main()

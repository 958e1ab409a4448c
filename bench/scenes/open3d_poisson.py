"""Screened Poisson (Kazhdan and Hoppe 2013) of Open3D as a careful user runs it: open3d_poisson.py CLOUD.npz MESH.npz
VOXEL

Normals that the files have are used as they are; a sample without one, or a cloud without any, gets Open3D's own from
30 neighbors, turned to the scanner where the files say where it stood and else made consistent over a tangent-plane
graph. VOXEL is the width of the finest octree cells. Densities go with the vertices, for trimming.
"""
import sys

import numpy as np
import open3d

NEIGHBORS = 30


def normals_of(cloud, given, sensors):
    if given is not None and np.any(given):
        return given
    search = open3d.geometry.KDTreeSearchParamKNN(NEIGHBORS)
    cloud.estimate_normals(search)
    if sensors is None:
        cloud.orient_normals_consistent_tangent_plane(NEIGHBORS)
        return np.asarray(cloud.normals)
    normals = np.asarray(cloud.normals)
    inwards = (normals * (sensors - np.asarray(cloud.points))).sum(axis=1) < 0
    return np.where(inwards[:, None], -normals, normals)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    with np.load(sys.argv[1]) as file:
        arrays = dict(file)
    middle = arrays["positions"].mean(axis=0)  # its graph of tangent planes fails on large coordinates
    scale = np.ptp(arrays["positions"], axis=0).max()
    sensors = arrays.get("sensors")
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector((arrays["positions"] - middle) / scale))
    normals = normals_of(cloud, arrays.get("normals"), None if sensors is None else (sensors - middle) / scale)
    cloud.normals = open3d.utility.Vector3dVector(normals)
    mesh, densities = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(
        cloud, width=float(sys.argv[3]) / scale, n_threads=1)
    np.savez(sys.argv[2], vertices=np.asarray(mesh.vertices) * scale + middle, triangles=np.asarray(mesh.triangles),
             densities=np.asarray(densities))


if __name__ == "__main__":
    main()

"""From Open3D, trimesh and PyVista, and to them, whichever is installed."""
import importlib.util

import soapfilm

cloud = soapfilm.scan("torus", samples=20_000)
result = soapfilm.reconstruct(cloud, resolution=48, distance=True)
for package, convert in (("open3d", result.to_open3d), ("trimesh", result.to_trimesh), ("pyvista", result.to_pyvista)):
    if importlib.util.find_spec(package):
        print(f"{package}: {convert()!r}")
    else:
        print(f"{package}: not installed")

if importlib.util.find_spec("open3d"):
    theirs = cloud.to_open3d().voxel_down_sample(0.03)
    print("from Open3D:", soapfilm.reconstruct(theirs, resolution=48))  # with its normals and colors

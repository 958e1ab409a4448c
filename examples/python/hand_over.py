"""To Open3D, trimesh and PyVista, whichever is installed."""
import importlib.util

import soapfilm

result = soapfilm.reconstruct(soapfilm.scan("torus", samples=20_000), resolution=48, distance=True)
for package, convert in (("open3d", result.to_open3d), ("trimesh", result.to_trimesh), ("pyvista", result.to_pyvista)):
    if importlib.util.find_spec(package):
        print(f"{package}: {convert()!r}")
    else:
        print(f"{package}: not installed")

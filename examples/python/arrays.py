"""NumPy arrays in, NumPy arrays out: reconstruct, look at the proof, compare with the truth, save."""
import numpy as np

import soapfilm

# 20,000 noisy samples of a knot. Yours come from a file (soapfilm.read) or from any other package, as (N, 3) arrays.
cloud = soapfilm.scan("knot", samples=20_000, noise="0.1%")
points, normals = np.array(cloud.positions), np.array(cloud.normals)

result = soapfilm.reconstruct(points, normals, resolution=64)
print(result)
print(f"proved within {100 * result.certificate['relative_gap_binary']:.2f} % of the global optimum")
print("watertight:", result.topology()["watertight"], " genus:", result.topology()["genus"])

truth = soapfilm.evaluate(result, "knot", points=10_000)
print(f"mean distance to the truth: {truth['mesh_to_truth']['distance']['mean'] / result.voxel:.3f} voxels")

centered = result.vertices - result.vertices.mean(axis=0)  # views of the result: computing with them copies nothing
print("radius:", np.linalg.norm(centered, axis=1).max().round(3))
result.save("knot.ply")

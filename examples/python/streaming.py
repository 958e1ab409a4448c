"""Scans as they come from a scanner: each with its pose, a preview after each, the full surface at the end."""
import numpy as np

import soapfilm

scanner = soapfilm.Reconstructor(resolution=64)
whole = soapfilm.scan("part", views=5, image=(120, 120), noise="0.05%")

for scan in whole.scans:
    pose = np.eye(4)
    pose[:3, 3] = scan["sensor"]  # the scan's own frame: the scanner at its origin
    in_its_frame = whole.positions[scan["begin"]:scan["end"]] - pose[:3, 3]
    scanner.add(in_its_frame, pose=pose, name=scan["name"])
    preview = scanner.reconstruct(resolution=32)
    print(f"{scanner.scans} scans, {len(scanner)} samples: {100 * preview.report['self_check']['invented']:4.1f} % "
          "of the surface is far from all samples")

result = scanner.reconstruct()
print(result)
result.save("part.ply")

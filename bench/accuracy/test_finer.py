"""Triangles that are cut stay on the surface: python3 -B -m unittest discover -s bench/accuracy -p 'test_*.py'"""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent)]

try:
    import numpy as np

    import finer
except ImportError:
    np = None


@unittest.skipIf(np is None, "numpy is not there")
class Finer(unittest.TestCase):
    def setUp(self):
        self.vertices = np.array([[0, 0, 0], [4, 0, 0], [0, 1, 0], [0, 0, 0.5]], float)
        self.triangles = np.array([[0, 1, 2], [0, 2, 3]])

    def normals(self, vertices, triangles):
        """Twice the area each."""
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    def test_edges_are_short_and_area_and_sides_stay(self):
        vertices, triangles = finer.finer(self.vertices, self.triangles, 0.3)
        a, b = vertices[triangles], vertices[np.roll(triangles, -1, axis=1)]
        self.assertLessEqual(np.linalg.norm(a - b, axis=2).max(), 0.3)
        before, after = (self.normals(*mesh).sum(axis=0)
                         for mesh in ((self.vertices, self.triangles), (vertices, triangles)))
        np.testing.assert_allclose(after, before)
        self.assertAlmostEqual(np.linalg.norm(self.normals(vertices, triangles), axis=1).sum(), 4.5)

    def test_what_is_fine_stays(self):
        vertices, triangles = finer.finer(self.vertices, self.triangles, 5)
        np.testing.assert_array_equal(vertices, self.vertices)
        np.testing.assert_array_equal(triangles, self.triangles)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second = Path(folder) / "first.ply", Path(folder) / "second.ply"
            finer.write(first, self.vertices, self.triangles)
            finer.write_finer(first, second, 0.3)
            read, cut = finer.read_mesh(second), finer.finer(self.vertices, self.triangles, 0.3)
            np.testing.assert_array_equal(read[0], cut[0])
            np.testing.assert_array_equal(read[1], cut[1])

    def test_positions_in_float(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "float.ply"
            finer.write(path, self.vertices, self.triangles)
            head, end, body = path.read_bytes().partition(b"end_header\n")
            doubles = 8 * self.vertices.size
            path.write_bytes(head.replace(b"double", b"float") + end + self.vertices.astype("<f4").tobytes()
                             + body[doubles:])
            np.testing.assert_array_equal(finer.read_mesh(path)[0], self.vertices)


if __name__ == "__main__":
    unittest.main()

"""Soapfilm: watertight surfaces from 3D scans, with a proof of how near they are to the best ones.

::

    import soapfilm

    result = soapfilm.reconstruct(points, normals, voxel=0.002)   # NumPy arrays
    result.vertices, result.triangles                             # NumPy arrays
    result.certificate["relative_gap_binary"]                     # how far from the global optimum, at most
    result.save("mesh.ply")

    soapfilm.reconstruct(soapfilm.read("scans.conf"))             # files of any format
    soapfilm.reconstruct(pcd)                                     # clouds of Open3D, trimesh, PyVista

``help(soapfilm.reconstruct)`` has all arguments; docs/guide/python.md shows how they are used.
"""
from . import _core
from ._mesh import Mesh, Result, read_mesh
from ._points import Points, read
from ._run import Reconstructor, reconstruct
from ._simplify import simplify
from ._tools import compare, evaluate, measure, render, scan, view
from .errors import (EmptyResult, InputError, OutOfMemory, OutputError, ParameterError, SamplesError, SoapfilmError,
                     SoapfilmWarning)

__version__: str = _core.version

__all__ = [
    "EmptyResult", "InputError", "Mesh", "OutOfMemory", "OutputError", "ParameterError", "Points", "Reconstructor",
    "Result", "SamplesError", "SoapfilmError", "SoapfilmWarning", "compare", "evaluate", "measure", "read", "read_mesh",
    "reconstruct", "render", "scan", "simplify", "view",
]

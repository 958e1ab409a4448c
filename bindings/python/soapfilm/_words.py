"""The library's lines in the words of Python: they name options as the command line has them, and keys of its JSON."""
from __future__ import annotations

import re

#: Options of the program, in Python's spelling, and their keys in the report's `parameters`.
OPTIONS = {
    "voxel": "place.voxel", "resolution": "place.resolution", "padding": "place.padding", "anchor": "place.anchor",
    "adapt": "place.adapt",
    "outside": "border.outside", "directions": "orient.directions", "sensor": "orient.sensor", "up": "orient.up",
    "neighbors": "orient.neighbors", "radius": "orient.radius", "lambda": "energy.lambda",
    "weights": "energy.by_area", "norm": "energy.norm", "tolerance": "solve.tolerance",
    "max_iterations": "solve.max_iterations", "settle": "solve.settle", "method": "solve.method",
    "link_weights": "graph_cut.weights", "front": "vrip.front", "behind": "vrip.behind",
    "folds": "cross_validation.folds", "fold_source": "cross_validation.source", "threshold": "surface.threshold",
    "isovalue": "surface.isovalue", "refine": "surface.refine", "drop_components": "surface.drop_components",
    "min_support": "components.min_support", "smoothing": "refine.smoothing", "holes": "refine.holes",
    "split_tolerance": "surface.split_tolerance", "trim": "trim.distance", "trim_holes": "trim.holes",
    "fill_holes": "trim.fill_holes",
    "simplify": "simplify.tolerance", "triangles": "simplify.triangles",
    "attributes": "surface.attributes", "distance": "surface.distance", "support": "surface.support",
    "gap": "surface.gap", "volume_interval": "surface.volume_interval",
}

#: Flags, and options that take on or off.
SWITCHES = {"adapt", "settle", "refine", "drop_components", "trim_holes", "distance", "support", "gap"}

#: Arguments of soapfilm.read(), not of reconstruct().
READING = {"columns", "trajectory", "trust_viewpoint", "spacing"}
#: Of the context, not parameters.
CONTEXT = {"memory"}
_FLAGS = {"trim_holes", "distance", "support", "gap", "trust_viewpoint"}

#: What follows an option and is its value: a number, a place, names of columns, a word of an enumeration.
_VALUE = r"""(?P<value> [-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?[KMG]?(?!\w) | X,Y,Z | [\w-]+(?:,[\w-]+)+(?:,\.\.\.)?
    | (?:air|solid|open|auto|on|off|normals|estimate|scan|tv-sor|tv|poisson|graph-cut-6|graph-cut-26|vrip|area|all|none)
      (?![\w-]) )"""
_OPTION = re.compile(r"(?<![\w!-])--(?P<name>[a-z][a-z-]*)(?:[ =]" + _VALUE + ")?", re.VERBOSE)
_KEY = re.compile(r"^(?:parameters: )?(?P<key>[a-z_]+(?:\.[a-z_]+)?)(?= = )")
_WORDS_OF_KEYS = {"lambda": "lambda_", **{key: "lambda_" if option == "lambda" else option
                                          for option, key in OPTIONS.items() if option != "weights"}}


def in_python(line: str) -> str:
    """``line`` with ``voxel=0.01`` for ``--voxel 0.01``, and ``outside = 3`` for ``border.outside = 3``."""
    keyed = _KEY.sub(lambda found: _WORDS_OF_KEYS.get(found["key"], found[0]), line)
    if keyed != line:
        keyed = re.sub(r"must be true or false$", "must be True or False", keyed)
    return _OPTION.sub(_keyword, keyed)


def _keyword(found: re.Match[str]) -> str:
    name, value = found["name"].replace("-", "_"), found["value"]
    if name not in OPTIONS and name not in READING and name not in CONTEXT:
        return found[0]
    word = "lambda_" if name == "lambda" else name
    of = " of soapfilm.read" if name in READING else ""
    if value is None:
        return f"{word}={'True' if name in _FLAGS else ''}{of}"
    if name in SWITCHES and value in ("on", "off"):
        value = "True" if value == "on" else "False"
    elif value == "X,Y,Z":
        value = "(x, y, z)"
    elif not re.fullmatch(r"[-+\d.e]+", value):
        value = f"'{value}'"
    return f"{word}={value}{of}"

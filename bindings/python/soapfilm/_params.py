"""Parameters: the names of docs/reference/options.md, or the groups of the report, as the library's JSON."""
from __future__ import annotations

import functools
import inspect
import json
import math
import os
from collections.abc import Mapping
from typing import Any

from . import _core
from ._words import OPTIONS, SWITCHES
from .errors import ParameterError

#: Options of the program that are no parameters, and what takes their place.
ELSEWHERE = {
    "output": "result.save(path) writes the mesh", "ascii": "result.save(path, ascii=True) writes text",
    "report": "result.report has it", "check": "result.topology() and soapfilm.evaluate() check the mesh",
    "strict": "warnings.simplefilter('error', soapfilm.SoapfilmWarning) makes warnings errors",
    "preview": "a run with a voxel 4 times as large is a first look",
    "lod": "only the program writes coarser levels", "split": "only the program writes parts",
    "scratch": "only the program holds large arrays in files",
    "resume": "only the program keeps finished stages in files",
    "write_levels": "only the program writes levels", "quiet": "progress=False is quiet",
    "verbose": "progress=callable gets all details", "columns": "soapfilm.read(files, columns=...) has it",
    "trajectory": "soapfilm.read(files, trajectory=...) has it",
    "trust_viewpoint": "soapfilm.read(files, trust_viewpoint=True) has it",
    "format": "only the program reads and writes streams; a name says its format by how it ends",
}

@functools.lru_cache(maxsize=None)
def _known() -> dict[str, tuple[str, ...]]:
    """The groups and their keys, as the library has them."""
    return {group: tuple(values) for group, values in json.loads(_core.default_parameters()).items()}


def _unknown(name: str, known: list[str]) -> TypeError:
    import difflib

    near = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    hint = f"; the nearest is '{near[0]}'" if near else ""
    return TypeError(f"unknown parameter '{name}'{hint}")


def signature_with(function: Any, options: Any) -> inspect.Signature:
    """Of a function with ``**options``, for help() and completion: each option as an argument with its type."""
    signature = inspect.signature(function)
    named = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
    taken = {p.name for p in named}
    return signature.replace(parameters=[*named, *(
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None,
                          annotation=getattr(kind, "__forward_arg__", kind))
        for name, kind in options.__annotations__.items() if name not in taken)])


def parameters_json(flat: Mapping[str, Any], base: Any = None) -> str:
    """JSON for the library of keyword arguments; `base`: parameters or report of an earlier run, its result or file."""
    groups = _base(base)
    _replace_grid(groups, flat)
    for given, value in flat.items():
        if value is None:
            continue
        name = given[:-1] if given == "lambda_" else given
        if name == "memory":  # the limit is no parameter: memory_limit()
            value = {key: of for key, of in value.items() if key != "limit"} if isinstance(value, Mapping) else {}
        if name in _known() and isinstance(value, Mapping):
            _merge_group(groups, name, value)
        elif name in OPTIONS:
            _set_option(groups, name, value)
        elif name in ELSEWHERE:
            raise TypeError(f"'{name}' is no parameter here: {ELSEWHERE[name]}")
        elif name in _known():
            keys = ", ".join(_known()[name])
            raise TypeError(f"'{name}' is a group of parameters: give a dict with some of {keys}")
        else:
            options = ["lambda_" if option == "lambda" else option for option in OPTIONS]
            raise _unknown(given, [*options, *_known()])
    _refuse_unused(flat, groups)
    try:
        return json.dumps(groups, default=_plain, allow_nan=False)
    except ValueError as error:
        raise ParameterError(f"{_not_finite(groups)}, must be finite") from error


def _base(base: Any) -> dict[str, dict[str, Any]]:
    if base is None:
        return {}
    base = getattr(base, "report", base)
    if isinstance(base, (str, os.PathLike)):
        with open(base, encoding="utf-8") as file:
            try:
                base = json.load(file)
            except ValueError as error:
                raise ParameterError(f"{os.fspath(file.name)}: not JSON: {error}") from error
    if not isinstance(base, Mapping):
        raise TypeError("params: must be a result, a report, its 'parameters', or a file of one of them")
    groups = {group: dict(values) for group, values in base.get("parameters", base).items()}
    groups.get("memory", {}).pop("limit", None)  # of reports of earlier versions: it was that run's
    return groups


def _merge_group(groups: dict[str, dict[str, Any]], group: str, values: Mapping[str, Any]) -> None:
    for key, value in values.items():
        key = "lambda" if key == "lambda_" else key
        if key not in _known()[group]:
            raise _unknown(f"{group}.{key}", [f"{group}.{known}" for known in _known()[group]])
        groups.setdefault(group, {})[key] = value


def _replace_grid(groups: dict[str, dict[str, Any]], flat: Mapping[str, Any]) -> None:
    """Voxel and resolution both determine the grid: one given here replaces the other one of earlier parameters."""
    place = flat.get("place")
    given = {name for name in ("voxel", "resolution")
             if flat.get(name) is not None or isinstance(place, Mapping) and place.get(name) is not None}
    if given and "place" in groups:
        for name in ("voxel", "resolution"):
            groups["place"].pop(name, None)


def _set_option(groups: dict[str, dict[str, Any]], name: str, value: Any) -> None:
    group, key = OPTIONS[name].split(".")
    into = groups.setdefault(group, {})
    if name in SWITCHES:
        value = {"on": True, "off": False}.get(value, value) if isinstance(value, str) else value
    if name == "lambda":
        into["cross_validate"] = value == "auto" if isinstance(value, str) else False
        value = None if isinstance(value, str) and value == "auto" else value
    elif name == "weights":
        if value not in ("area", "samples"):
            raise ParameterError(f"weights = {value!r}, must be an array, 'area' or 'samples'")
        value = value == "area"
    elif name == "isovalue" and isinstance(value, str) and value == "auto":
        value = None
    elif name == "trim":
        into["on"] = not (value is False or isinstance(value, str) and value == "off")
        value = None if isinstance(value, (bool, str)) and value in (True, False, "auto", "off") else value
        if isinstance(value, str):
            raise ParameterError(f"trim = {value!r}, must be a distance, 'auto' or 'off'")
    elif name == "simplify":
        if value is True or isinstance(value, str) and value == "auto":
            into["automatic"], value = True, None
        elif value is False or isinstance(value, str) and value == "off":
            value = None
        elif isinstance(value, str) and value.endswith("vox"):
            into["tolerance_vox"], value = _number("simplify", value[:-3]), None
        elif isinstance(value, str):
            value = _number("simplify", value)
    elif name == "attributes" and isinstance(value, str):
        value = [] if value == "none" else value.split(",")
    into[key] = value


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ParameterError(f"{name} = {text!r}, must be a distance, such as '0.05vox', 'auto' or 'off'") from None


def memory_limit(value: Any) -> int | None:
    """What a run may take: a whole number of bytes, text such as 2G or 1.5G, or None."""
    if isinstance(value, Mapping):
        value = value.get("limit")
    if value is None:
        return None
    if isinstance(value, str):
        factor = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30}.get(value[-1:].upper())
        try:
            value = float(value[:-1]) * factor if factor else float(value)
        except ValueError:
            raise ParameterError(f"memory = {value!r}, must be bytes, or text such as '2G'") from None
    if not value > 0 or not math.isfinite(value):
        raise ParameterError(f"memory = {value!r}, must be > 0")
    return int(value)


def _refuse_unused(flat: Mapping[str, Any], groups: Mapping[str, Mapping[str, Any]]) -> None:
    """As the program does: an option that the chosen method does not use is an error."""
    method = groups.get("solve", {}).get("method", "tv")
    chooses = bool(groups.get("energy", {}).get("cross_validate"))

    def only(names: tuple[str, ...], used: bool, of: str) -> None:
        for name in names:
            if not used and flat.get(name) is not None and not isinstance(flat[name], Mapping):
                raise ParameterError(f"{name}: only {of} has it")

    only(("tolerance", "max_iterations", "settle"), method == "tv" or chooses, "method tv")
    only(("link_weights",), method == "graph-cut-26", "method graph-cut-26")
    only(("front", "behind"), method == "vrip", "method vrip")
    only(("folds", "fold_source"), chooses, "lambda_='auto'")
    only(("weights",), method != "vrip", "a method with a data term")
    only(("weights",), groups.get("energy", {}).get("lambda") is None, "a lambda that follows the samples")


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy, paths and tuples as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"parameters: {value!r} of type {type(value).__name__} cannot be used")


def _not_finite(groups: Mapping[str, Mapping[str, Any]]) -> str:
    for group, values in groups.items():
        for key, value in values.items():
            if isinstance(value, float) and not math.isfinite(value):
                return f"{group}.{key} = {value}"
    return "parameters: a value is not a number"

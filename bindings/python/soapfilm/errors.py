"""What soapfilm raises and warns of. Every message is one line: what, its value, its constraint; in Python's words,
also where the library speaks of options of its program."""
from __future__ import annotations

import warnings

from ._words import in_python


class SoapfilmWarning(UserWarning):
    """A warning of the library: also in ``result.warnings``. Given with ``progress=False``, too."""

    def __init__(self, message: str = "") -> None:
        super().__init__(in_python(message))


def warn(line: str, stacklevel: int) -> None:
    """`stacklevel`: as of warnings.warn(), from the one who calls this."""
    warnings.warn(SoapfilmWarning(line), stacklevel=stacklevel + 1)


class SoapfilmError(Exception):
    """Any error of this package."""

    def __init__(self, message: str = "") -> None:
        super().__init__(in_python(message))


class ParameterError(SoapfilmError, ValueError):
    """A value that the caller gave is refused."""


class SamplesError(ParameterError):
    """The samples are refused: too few, not finite, without a volume, too large or too small."""


class InputError(SoapfilmError, ValueError):
    """A file or its contents are refused: file, place (line or byte), value, constraint."""


class EmptyResult(SoapfilmError, ValueError):
    """The optimum is the empty surface: a result, not a fault of the input.

    ``largest_lambda`` is the largest ``lambda_`` that keeps a surface; 0 when there is none.
    """

    def __init__(self, message: str, largest_lambda: float = 0.0) -> None:
        super().__init__(message)
        self.largest_lambda = largest_lambda


class OutputError(SoapfilmError, OSError):
    """A file could not be written; nothing half-written stays behind."""


class OutOfMemory(SoapfilmError, MemoryError):
    """The run would not fit into memory; nothing large was allocated. The message names the resolution that fits."""

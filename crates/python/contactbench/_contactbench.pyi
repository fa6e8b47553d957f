"""Native functions. The package checks and completes their arguments."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Doubles: TypeAlias = npt.NDArray[np.float64]
Edges: TypeAlias = tuple[list[list[float]], list[bool], list[float]]
Answer: TypeAlias = tuple[npt.NDArray[np.uint32], npt.NDArray[np.int32] | None]

DEFAULT: str
DETECTORS: list[str]
__version__: str

class Refused(ValueError): ...

def limit_for(particles: int) -> int: ...

class Search:
    def __init__(
        self, text: str, tracks: bool, arithmetic: str, threads: int, memory_limit: int | None
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def arithmetic(self) -> str: ...
    @property
    def threads(self) -> int: ...
    @property
    def memory_limit(self) -> int: ...
    @property
    def done(self) -> tuple[int, int, int, int, bool]: ...
    def contacts(self, x: Doubles, r: Doubles, edges: Edges | None) -> Answer: ...
    def count(self, x: Doubles, r: Doubles, edges: Edges | None) -> dict[str, int]: ...
    def forget(self) -> None: ...

def neighbours(
    search: Search, x: Doubles, r: Doubles, edges: Edges | None, wanted: dict[str, bool]
) -> tuple[Any, ...]: ...
def verify(
    x: Doubles,
    r: Doubles,
    pairs: npt.NDArray[np.int64],
    images: npt.NDArray[np.int32] | None,
    edges: Edges | None,
    arithmetic: str,
    base: int,
    both_sides: bool,
    skin: float,
    most: int,
    threads: int,
    memory_limit: int | None,
) -> dict[str, Any]: ...
def recommend(
    x: Doubles,
    r: Doubles,
    edges: Edges | None,
    arithmetic: str,
    threads: int,
    seconds: float,
    memory_limit: int | None,
    program: list[str],
) -> str: ...
def serve(detector: str, arithmetic: str, threads: int, memory_limit: int) -> None: ...
def check(
    function: Callable[[Doubles, Doubles], npt.NDArray[np.int64]],
    name: str,
    arithmetic: str,
    seconds: float,
) -> dict[str, Any]: ...
def load(path: str | Path) -> tuple[list[tuple[str, str, list[Any]]], list[str], list[str]]: ...
def scene(text: str) -> tuple[tuple[Doubles, Doubles, float | None], Edges | None]: ...

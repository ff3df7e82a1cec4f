"""Types of the package. The options of `clean` are those of the command line; tests/python compares them with the module."""
from os import PathLike
from typing import Any, Callable, NamedTuple, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Path = Union[str, bytes, "PathLike[str]", "PathLike[bytes]"]
Length = Union[float, str]
ProgressCall = Callable[[str, float], Any]


class Group(NamedTuple):
    name: str
    first: int
    count: int


class Mesh:
    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    groups: list[Group]
    colors: Optional[NDArray[np.uint8]]
    file: str
    format: str
    warnings: list[str]
    unit: Optional[str]
    def __init__(self, vertices: ArrayLike, faces: ArrayLike, groups: Sequence[Group] = ..., colors: Optional[NDArray[np.uint8]] = ..., file: str = ..., format: str = ...,
                 warnings: list[str] = ..., unit: Optional[str] = ...) -> None: ...
    @property
    def names(self) -> list[str]: ...


class Check:
    valid_solid: bool
    defects: dict[str, Any]
    locations: list[dict[str, Any]]
    locations_total: dict[str, int]
    warnings: list[str]
    thickness: Optional[dict[str, Any]]
    @property
    def too_thin(self) -> bool: ...
    def __bool__(self) -> bool: ...


class CleanResult:
    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    groups: list[Group]
    colors: Optional[NDArray[np.uint8]]
    report: dict[str, Any]
    warnings: list[str]
    failure: Optional[Error]
    @property
    def unit(self) -> Optional[str]: ...
    @property
    def verified(self) -> bool: ...


class Comparison:
    a_to_b: dict[str, Any]
    b_to_a: dict[str, Any]
    max: float
    diagonal: float
    vertices_a: Optional[NDArray[np.float64]]
    vertices_b: Optional[NDArray[np.float64]]
    report: dict[str, Any]
    alignment: Optional[dict[str, Any]]


class Error(Exception):
    code: str
    hint: str
    result: Optional[CleanResult]


class UsageError(Error, ValueError): ...
class UnreadableInputError(Error, OSError): ...
class UnwritableOutputError(Error, OSError): ...
class GuaranteeError(Error): ...
class MemoryLimitError(Error, MemoryError): ...
class TimeLimitError(Error, TimeoutError): ...
class BugError(Error, RuntimeError): ...


Surface = Union[Path, Mesh, CleanResult, tuple[ArrayLike, ArrayLike], Any]


def read(path: Path, salvage: bool = ..., weld: bool = ...) -> Mesh: ...
def write(path: Path, vertices: Any, faces: Optional[ArrayLike] = ..., overwrite: bool = ..., unit: Optional[str] = ...) -> None: ...
def check(vertices: Any, faces: Optional[ArrayLike] = ..., *, salvage: bool = ..., thickness: bool = ..., min_thickness: Optional[Length] = ...,
          threads: Optional[int] = ..., progress: Optional[ProgressCall] = ..., time_limit: Optional[float] = ...) -> Check: ...
def compare(a: Surface, b: Surface, *, samples: int = ..., exact: bool = ..., vertices: bool = ..., align: bool = ..., threads: Optional[int] = ...,
            progress: Optional[ProgressCall] = ..., time_limit: Optional[float] = ...) -> Comparison: ...
def signed_distance(vertices: Any, faces: ArrayLike, points: Optional[ArrayLike] = ..., *, exact: bool = ..., threads: Optional[int] = ...,
                    progress: Optional[ProgressCall] = ..., time_limit: Optional[float] = ...) -> NDArray[np.float64]: ...
def clean(
    vertices: Any,
    faces: Optional[ArrayLike] = ...,
    *,
    float32: bool = ...,
    salvage: bool = ...,
    allow_invalid: bool = ...,
    threads: Optional[int] = ...,
    progress: Optional[ProgressCall] = ...,
    time_limit: Optional[float] = ...,
    from_field: Optional[bool] = ...,
    iso: Optional[Union[float, str]] = ...,
    below: Optional[bool] = ...,
    array: Optional[str] = ...,
    units: Optional[str] = ...,
    method: Optional[str] = ...,
    nested: Optional[str] = ...,
    gap: Optional[Length] = ...,
    recentre: Optional[bool] = ...,
    max_hole: Optional[Length] = ...,
    keep_openings: Optional[bool] = ...,
    thicken: Optional[Length] = ...,
    keep_largest: Optional[bool] = ...,
    min_component: Optional[Union[float, str]] = ...,
    cell: Optional[Length] = ...,
    resolution: Optional[int] = ...,
    adapt: Optional[Length] = ...,
    cell_max: Optional[Length] = ...,
    smooth: Optional[Length] = ...,
    mode: Optional[str] = ...,
    keep_volume: Optional[bool] = ...,
    free_volume: Optional[bool] = ...,
    crease: Optional[float] = ...,
    region: Optional[Path] = ...,
    curvature_radius: Optional[Length] = ...,
    deviation: Optional[Length] = ...,
    redistance: Optional[str] = ...,
    offset: Optional[Length] = ...,
    hollow: Optional[Length] = ...,
    surface: Optional[str] = ...,
    edge: Optional[Length] = ...,
    edge_tolerance: Optional[Length] = ...,
    min_angle: Optional[float] = ...,
    facets: Optional[int] = ...,
    simplify: Optional[Length] = ...,
    memory: Optional[Union[int, str]] = ...,
) -> CleanResult: ...

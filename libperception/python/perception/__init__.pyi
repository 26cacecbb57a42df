from os import PathLike
from typing import Any, Callable, Iterator, Mapping, Optional, Sequence, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

# [s] since 1970 as float, [ns] since 1970 as int, or numpy.datetime64
Stamp = Union[float, int, np.datetime64]
Path = Union[str, "PathLike[str]"]
# A pandas.DataFrame where pandas is installed, else a structured array
Table = Any

class Error(RuntimeError):
    # Exit code of the programs: 64 usage, 65 bad input, 66 no input, 78 bad configuration, ...
    code: int

class Scene:
    # One record an object; world frame, SI units, radians:
    #   id, class, class_id, classified (probability at least .95), class_probability (classes,),
    #   existence, position (3,) of the footprint's center and the base, yaw, has_yaw (False: yaw is
    #   the direction of motion or 0), p_front (probability that yaw points to the front and not to
    #   the back; .5: only the axis is known), velocity (2,), speed (along yaw), size (3,): length, width,
    #   height, position_sd (2,), yaw_sd, speed_sd (standard deviations), covariance (4, 4) of
    #   (x, y, vx, vy) in [m, m/s], world frame: [:2, :2] of the position [m^2], [2:, 2:] of the
    #   velocity [m^2/s^2], the spread between the classes is part of it; yaw_variance [rad^2], pi^2:
    #   nothing is known of yaw; last_hit (modalities,): [s] since 1970 of the last measurement by
    #   camera, lidar, radar; NaN: none
    @property
    def objects(self) -> NDArray[np.void]: ...
    @property
    def classes(self) -> list[str]: ...
    @property
    def stamp(self) -> float: ...
    @property
    def stamp_ns(self) -> int: ...
    @property
    def frame(self) -> int: ...
    @property
    def pose(self) -> NDArray[np.float64]: ...
    @property
    def free_distance(self) -> Optional[float]: ...
    @property
    def stop(self) -> Optional[bool]: ...
    @property
    def safe_speed(self) -> Optional[float]: ...
    @property
    def too_fast(self) -> Optional[bool]: ...
    def __len__(self) -> int: ...

class Observation:
    @property
    def kind(self) -> str: ...
    @property
    def sensor(self) -> str: ...
    @property
    def stamp(self) -> float: ...
    @property
    def stamp_ns(self) -> int: ...
    @property
    def sensor_pose(self) -> NDArray[np.float64]: ...
    @property
    def data(self) -> dict[str, Any]: ...

class Frame:
    # What a front end written in Python gets
    @property
    def kind(self) -> str: ...
    @property
    def sensor(self) -> str: ...
    @property
    def stamp(self) -> float: ...
    @property
    def stamp_ns(self) -> int: ...
    @property
    def pose(self) -> NDArray[np.float64]: ...
    @property
    def sensor_pose(self) -> NDArray[np.float64]: ...
    @property
    def ground(self) -> tuple[float, float, float]: ...
    @property
    def data(self) -> dict[str, Any]: ...

class Tracker:
    def __init__(
        self,
        ini: Path,
        sensors: str = "",
        overrides: Optional[Mapping[str, object]] = None,
        output: Path = "",
    ) -> None: ...
    def pose(
        self,
        stamp: Stamp,
        T: Optional[ArrayLike] = None,
        *,
        latitude: Optional[float] = None,
        longitude: Optional[float] = None,
        height: Optional[float] = None,
        yaw: Optional[float] = None,
        pitch: float = 0.0,
        roll: float = 0.0,
        antenna: Sequence[float] = (0.0, 0.0, 0.0),
        sigma_xy: float = 0.0,
        sigma_yaw: float = 0.0,
        sigma_pitch: float = 0.0,
    ) -> None: ...
    def frame(self, stamp: Stamp, number: int) -> None: ...
    def scan(
        self,
        sensor: str,
        stamp: Stamp,
        xyz: ArrayLike,
        intensity: Optional[ArrayLike] = None,
        ring: Optional[ArrayLike] = None,
        time: Optional[ArrayLike] = None,
        *,
        sensor_pose: Optional[ArrayLike] = None,
        max_range: float = 0.0,
        echo: Optional[ArrayLike] = None,
        pulse_width: Optional[ArrayLike] = None,
        label: Optional[ArrayLike] = None,
    ) -> Optional[Scene]: ...
    def boxes(
        self,
        sensor: str,
        stamp: Stamp,
        boxes: ArrayLike,
        scores: ArrayLike,
        labels: Sequence[str],
        *,
        z: str,
        sensor_pose: Optional[ArrayLike] = None,
    ) -> Optional[Scene]: ...
    def image_boxes(
        self,
        sensor: str,
        stamp: Stamp,
        boxes: ArrayLike,
        scores: ArrayLike,
        labels: Sequence[str],
        camera: tuple[int, int, float, float, float, float],
        *,
        headings: Optional[ArrayLike] = None,
        sensor_pose: Optional[ArrayLike] = None,
    ) -> Optional[Scene]: ...
    def radar(
        self,
        sensor: str,
        stamp: Stamp,
        range: ArrayLike,
        bearing: ArrayLike,
        range_rate: Optional[ArrayLike] = None,
        *,
        amplitude: Optional[ArrayLike] = None,
        elevation: Optional[ArrayLike] = None,
        sensor_pose: Optional[ArrayLike] = None,
        max_range: float = 0.0,
    ) -> Optional[Scene]: ...
    def add(self, observation: Observation) -> Optional[Scene]: ...
    def pending(self) -> list[Scene]: ...
    def finish(self) -> list[Scene]: ...
    def events(self) -> list[dict[str, Any]]: ...
    def learned(self) -> list[str]: ...
    @property
    def classes(self) -> list[str]: ...
    @property
    def sensors(self) -> list[str]: ...

class Run:
    folder: str
    tracks: Table
    scenes: Table
    classes: list[str]
    record: dict[str, Any]
    def __init__(self, folder: Path) -> None: ...

class Simulation:
    log: str
    truth_file: str
    truth: Table

# Boxes (n, 7) or points (n, 2), (n, 3); alone, with scores (n,), or with scores and labels
Found = Union[
    None, ArrayLike, tuple[ArrayLike, ArrayLike], tuple[ArrayLike, ArrayLike, Sequence[str]]
]
Detect = Callable[[Frame], Found]
# x (4,), dt [s], psd [m^2/s^3] to x, F (4, 4), Q (4, 4)
Predict = Callable[[NDArray[np.float64], float, float], tuple[ArrayLike, ArrayLike, ArrayLike]]
_D = TypeVar("_D", bound=Detect)
_P = TypeVar("_P", bound=Predict)

@overload
def front_end(kind: str, function: None = None) -> Callable[[_D], _D]: ...
@overload
def front_end(kind: str, function: _D) -> _D: ...
@overload
def motion_model(
    name: str, function: None = None, has_heading: bool = False
) -> Callable[[_P], _P]: ...
@overload
def motion_model(name: str, function: _P, has_heading: bool = False) -> _P: ...
def open(log: Path) -> Iterator[Observation]: ...
def track(
    log: Path,
    ini: Path,
    output: Optional[Path] = None,
    sensors: str = "",
    overrides: Optional[Mapping[str, object]] = None,
    **options: Any,
) -> Run: ...
def evaluate(
    run: Union[Run, Path],
    truth: Path,
    output: Optional[Path] = None,
    *,
    plots: bool = False,
    **options: Any,
) -> dict[str, Any]: ...
def simulate(
    scenario: Path,
    output: Optional[Path] = None,
    seed: int = 1,
    overrides: Optional[Mapping[str, object]] = None,
    **options: Any,
) -> Simulation: ...

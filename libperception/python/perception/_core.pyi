from typing import Any

from perception import Error as Error
from perception import Frame as Frame
from perception import Observation as Observation
from perception import Scene as Scene
from perception import Tracker as Tracker

def run_program(name: str, arguments: list[str]) -> int: ...
def add_front_end(kind: str, function: Any) -> None: ...
def add_motion_model(name: str, function: Any, has_heading: bool) -> None: ...

from perception import Error as Error
from perception import Observation as Observation
from perception import Scene as Scene
from perception import Tracker as Tracker

def run_program(name: str, arguments: list[str]) -> int: ...

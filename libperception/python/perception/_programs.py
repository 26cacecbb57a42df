"""The programs perception-track, -evaluate and -simulate, whose results come as tables."""
import contextlib
import json
import os
import shutil
import tempfile
import weakref

import numpy as np

from . import _core
from .perception_run import Run as _Folder


def _table(array):
    """A data frame where pandas is installed, else the structured array."""
    try:
        import pandas  # type: ignore
    except ImportError:
        return array
    return pandas.DataFrame(array)


def _text(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


@contextlib.contextmanager
def ini_file(ini):
    """The path of an INI; text of more than one line is a file for the while."""
    text = str(ini)
    if "\n" not in text:
        yield text
        return
    with tempfile.NamedTemporaryFile("w", suffix=".ini", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        yield file.name


def settings_of(overrides):
    """{"section.key": value} as section.key=value."""
    return [f"{key}={_text(value)}" for key, value in (overrides or {}).items()]


_END_EARLY = ("help", "help_all", "version", "info", "print_config", "coverage", "contact_sheet")
_HERE = ("config", "input", "set")


def _refused(text):
    error = _core.Error(text)
    error.code = 64
    return error


def _options(program, options):
    """{"min_points": 3, "strict": True} as arguments of a command line."""
    arguments = []
    for name, value in options.items():
        name = name.replace("-", "_").strip("_")
        if name in _END_EARLY:
            raise _refused(f"{program}: {name} ends the program before it has results; run "
                           f"perception-{program} --{name.replace('_', '-')} for it")
        if name in _HERE:
            raise _refused(f"{program}: {name} is said by an argument of perception.{program}()")
        flag = "--" + name.replace("_", "-")
        if value is True:
            arguments.append(flag)
        elif isinstance(value, (list, tuple)):
            for one in value:
                arguments += [flag, str(one)]
        elif value is not None and value is not False:
            arguments += [flag, str(value)]
    return arguments


class _Temporary:
    """A folder that is removed with the last object that refers to it."""

    def __init__(self):
        self.path = tempfile.mkdtemp(prefix="perception-")
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


def _folder(output):
    """The folder of results, and what keeps a temporary one."""
    if output:
        return str(output), None
    keeper = _Temporary()
    return os.path.join(keeper.path, "run"), keeper


def _overrides(overrides):
    return [word for setting in settings_of(overrides) for word in ("--set", setting)]


class Run:
    """Results of perception-track: `tracks` and `scenes` are tracks.csv and scenes.csv as tables."""

    def __init__(self, folder, _keeper=None):
        self._keeper = _keeper
        self.folder = str(folder)
        arrays = _Folder(self.folder)
        self.tracks = _table(arrays.tracks)
        self.scenes = _table(arrays.scenes)
        self.classes = arrays.classes
        record = os.path.join(self.folder, "done.json")
        self.record = {}
        if os.path.exists(record):
            with open(record, encoding="utf-8") as file:
                self.record = json.load(file)


def track(log, ini, output=None, sensors="", overrides=None, **options):
    """Tracks a rawlog as perception-track does; returns a Run.

    ini: a path, the name of an INI that is installed, or the text of one (as of Tracker).
    output: folder of the results; without, a temporary one that lives as long as the Run.
    options: those of perception-track, as threads=1, overwrite=True, export="kitti:0000.txt".
    """
    folder, keeper = _folder(output)
    arguments = ["-i", str(log), "-o", folder] + _overrides(overrides) + _options("track", options)
    if sensors:
        arguments += ["--sensors", sensors]
    with ini_file(ini) as file:
        _core.run_program("track", ["-c", file] + arguments)
    return Run(folder, keeper)


def evaluate(run, truth, output=None, **options):
    """Compares a run with the truth of its log as perception-evaluate does; returns report.json.

    run: a Run or its folder. options: those of the program, as range=20, complete_fov_deg=80; there
    are no plots unless plots=True.
    """
    folder = run.folder if isinstance(run, Run) else str(run)
    out, keeper = _folder(output)
    plots = options.pop("plots", False)
    arguments = ["-r", folder, "-t", str(truth), "-o", out] + ([] if plots else ["--no-plots"])
    _core.run_program("evaluate", arguments + _options("evaluate", options))
    with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
        report = json.load(file)
    del keeper  # not before the report is read
    return report


class Simulation:
    """A simulated log: `log` and `truth_file` are paths, `truth` is the truth as a table."""

    def __init__(self, log, _keeper=None):
        self._keeper = _keeper
        self.log = log
        self.truth_file = os.path.splitext(log)[0] + ".truth.csv"
        self.truth = _table(np.genfromtxt(self.truth_file, delimiter=",", names=True, dtype=None,
                                          encoding="utf-8"))


def simulate(scenario, output=None, seed=1, overrides=None, **options):
    """Makes a rawlog with truth of a scenario INI as perception-simulate does; returns a Simulation.

    scenario: a path, a name or the text of an INI.
    output: the rawlog; without, a temporary one that lives as long as the Simulation.
    """
    folder, keeper = _folder(None) if not output else (None, None)
    if keeper is not None:
        os.makedirs(folder)
    log = str(output) if output else os.path.join(folder, "simulated.rawlog")
    arguments = ["-o", log, "--seed", str(seed)] + _overrides(overrides) + _options("simulate", options)
    with ini_file(scenario) as file:
        _core.run_program("simulate", ["-c", file] + arguments)
    return Simulation(log, keeper)

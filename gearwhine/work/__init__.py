"""What each command does: stages, then files, then the document that it prints."""

from gearwhine.work.case import copy_example, list_examples, report_case
from gearwhine.work.housing import compare_case, mesh_case, modes_case, render_case, survey_case, update_case
from gearwhine.work.machine import gears_case, rotors_case, steady_case, sweep_case, system_case
from gearwhine.work.run import run_case

__all__ = [
    "compare_case",
    "copy_example",
    "gears_case",
    "list_examples",
    "mesh_case",
    "modes_case",
    "render_case",
    "report_case",
    "rotors_case",
    "run_case",
    "steady_case",
    "survey_case",
    "sweep_case",
    "system_case",
    "update_case",
]

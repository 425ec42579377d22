"""What a person sees on the terminal: a function for each command, given the document that its JSON holds."""

from gearwhine.screen.case import show_check, show_examples, show_mesh
from gearwhine.screen.housing import show_comparison, show_files, show_modes, show_modes_in_detail, show_survey
from gearwhine.screen.machine import show_run
from gearwhine.screen.updating import show_update

__all__ = [
    "show_check",
    "show_comparison",
    "show_examples",
    "show_files",
    "show_mesh",
    "show_modes",
    "show_modes_in_detail",
    "show_run",
    "show_survey",
    "show_update",
]

"""The command line: ``gearwhine COMMAND CASE [-o OUT] [--json] [--set key.path=value ...] [-q]``.

Each command reads the case, calls the analysis of its name and shows the result. Heavy modules are imported where they
are used, so that ``--help`` answers at once.
"""

from gearwhine.cli.command_line import run_command

__all__ = ["run_command"]

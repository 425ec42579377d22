"""The command line: ``gearwhine COMMAND CASE [-o OUT] [--json] [--set key.path=value ...] [-q]``.

Every command is a few lines: read the case, run the stages, hand the result on. What takes long to import is
imported where it is used, so that ``--help`` answers at once.
"""

from gearwhine.cli.command_line import run_command

__all__ = ["run_command"]

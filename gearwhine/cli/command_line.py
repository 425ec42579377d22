"""Command-line application: commands by name, exit codes, error messages."""

import io
import sys
import warnings
from collections.abc import Sequence
from contextlib import ExitStack

from cyclopts import App, CycloptsError, MissingArgumentError, UnusedCliTokensError

from gearwhine import __version__
from gearwhine.cli import folder_commands, import_command
from gearwhine.cli.study_commands import made_command
from gearwhine.commands import STUDY_COMMANDS
from gearwhine.failures import explain
from gearwhine.interruption import INTERRUPTED, ended_when_deaf, interruptible, was_interrupted

app = App(
    name="gearwhine",
    version=__version__,
    help="Gearbox vibration: from the geometry of housing, rotors and gears to spectra and sound.",
    help_epilogue="Try: gearwhine examples, then gearwhine run small-gearbox",
    help_format="plaintext",
    # An interruption unwinds to run_command, which has a sentence for it.
    suppress_keyboard_interrupt=False,
)
for _entry in STUDY_COMMANDS:
    app.command(made_command(_entry))
for _command in (folder_commands.examples, folder_commands.report, folder_commands.export):
    app.command(_command)
app.command(import_command.import_, name="import")


def run_command(arguments: list[str], *, is_process: bool = False) -> int:
    """Run the command line; 0 when done, 2 where the user's input is wrong, 1 for anything else, 130 if interrupted.

    Only an unexpected exception leaves a traceback.

    Parameters
    ----------
    arguments : list of str
    is_process : bool
        Whether the process is that of the command alone: it is then ended where compiled code delays an interruption.
    """
    with ExitStack() as stack:
        if is_process:
            stack.enter_context(ended_when_deaf(_say_interrupted))
        stack.enter_context(interruptible())
        stack.enter_context(warnings.catch_warnings())
        warnings.showwarning = _show_warning
        return _run_command(arguments)


def _show_warning(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Show a warning of a library as a sentence, without the line of its source."""
    if issubclass(category, (DeprecationWarning, PendingDeprecationWarning, ResourceWarning)):
        return
    lost = "a number left the range of the arithmetic, so that results near it may be doubtful: "
    sys.stderr.write(f"warning: {lost if issubclass(category, RuntimeWarning) else ''}{message}\n")


def _run_command(arguments: list[str]) -> int:
    try:
        for stream in (sys.stdout, sys.stderr):
            # A character that the terminal's encoding lacks, such as µ in ASCII, is shown as ?.
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="replace")
        app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        command = " ".join(("gearwhine", *(error.command_chain or ())))
        sys.stderr.write(f"gearwhine: {_usage(error)}\nTry '{command} --help'.\n")
        return 2
    except KeyboardInterrupt as stop:
        return _interrupted(stop)
    except Exception as error:
        if was_interrupted():
            # A library may answer an interruption with an error of its own, or fail as it is unwound.
            return _interrupted(error)
        if isinstance(error, BrokenPipeError):
            return 1
        code, message = explain(error)
        if message is None:
            raise
        for note in getattr(error, "__notes__", ()):
            sys.stderr.write(f"{note}\n")
        sys.stderr.write(f"gearwhine: {message}\n")
        return code
    return 0


def _usage(error: CycloptsError) -> str:
    """Say what is wrong with the arguments of a command."""
    if isinstance(error, UnusedCliTokensError):
        extra = " ".join(error.unused_tokens or ())
        return f"{' '.join(error.command_chain or ())}: expected no further argument, got {extra!r}"
    if isinstance(error, MissingArgumentError) and error.argument is not None and not error.argument.tokens:
        argument = error.argument
        name = argument.name if argument.field_info.is_keyword_only else argument.name.removeprefix("--").upper()
        return f"{' '.join(error.command_chain or ())}: expected {name}: {argument.parameter.help}"
    return str(error)


def _interrupted(error: BaseException) -> int:
    """Say that the command was interrupted, with the notes of the error that ended it; return the exit code."""
    _say_interrupted(getattr(error, "__notes__", ()))
    return INTERRUPTED


def _say_interrupted(notes: Sequence[str]) -> None:
    lines = ("interrupted; the output folder holds no half-written file", *notes)
    sys.stderr.write("".join(f"gearwhine: {line}\n" for line in lines))
    sys.stderr.flush()

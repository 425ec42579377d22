"""Failures of a command: exit codes and messages of wrong input, failed proofs and missing libraries."""

from gearwhine.numerics.findings import RefusedPartError, WorkFailedError


class PartlyFailedError(WorkFailedError):
    """Some of the work failed; finished parts are on file, and the message gives the number of missing ones."""


class DamagedResultsError(ValueError):
    """A file of a results folder is not as a run wrote it; the message names it."""


class ForeignFileError(ValueError):
    """A file that no run made, or that the case reads, would be replaced; the message names it."""


class WorkersError(WorkFailedError):
    """The workers of a sweep did not start, or are gone for good."""


class MissingExtraError(WorkFailedError):
    """A package of an extra is not installed; the message names both."""


def explain(error: Exception) -> tuple[int, str | None]:
    """Return exit code and message of a failure; an unexpected one has no message and needs a traceback.

    Wrong input is 2. A missing system library, or a result that failed its own proof, is 1 with its advice.
    """
    from gearwhine.case import CaseError

    if isinstance(error, CaseError):
        count = len(error.problems)
        by_option = all(problem.key.startswith(("--", "report")) for problem in error.problems)
        subject = "what is asked for" if by_option else "the case"
        head = f"{subject} cannot be used as it stands" if count == 1 else f"{count} problems in {subject}"
        return 2, head + ":\n" + "\n".join(f"  {problem}" for problem in error.problems)
    if isinstance(error, RefusedPartError | DamagedResultsError | ForeignFileError):
        return 2, str(error)
    if isinstance(error, WorkFailedError):
        return 1, str(error)
    if isinstance(error, MemoryError):
        advice = "a larger mesh_size or a lower frequency_limit needs less"
        cause = str(error)  # of an array, numpy says how much; of a factor, check_memory says what to do as well
        if "mesh_size" in cause:
            return 1, f"out of memory: {cause}"
        return 1, f"out of memory{': ' if cause else ''}{cause}; {advice}"
    if isinstance(error, OSError):
        return 1, f"{error.strerror or error}: {error.filename}" if error.filename else str(error)
    return 1, None

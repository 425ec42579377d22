"""Memory that this process can still allocate, and the refusal of work that would exceed it."""

import os
from pathlib import Path


def available_memory(*, system: Path = Path("/")) -> float:
    """Memory that this process can still allocate: the least of the machine's, its control group's and its own limit.

    The machine's is MemAvailable and SwapFree of ``/proc/meminfo``; the group's, of a container or a batch job, is the
    limit of the control group less its use without files that can be dropped; its own is RLIMIT_AS less the address
    space in use. A limit that the system does not report is infinite.

    Parameters
    ----------
    system : path
        Root of the file system that has ``proc`` and ``sys``.

    Returns
    -------
    float
        Memory [bytes], not negative.
    """
    return max(min(_machine(system), _group(system), _own_limit(system)), 0.0)


def check_memory(needed: float, task: str) -> None:
    """Refuse work that needs more memory than is available.

    Parameters
    ----------
    needed : float
        Memory needed [bytes].
    task : str
        Subject of the message's sentence.

    Raises
    ------
    MemoryError
        Where less than that is available; the message says both and what to do.
    """
    available = available_memory()
    if needed > available:
        raise MemoryError(
            f"{task} needs {needed / 1e9:.2g} GB of memory, and {available / 1e9:.2g} GB are available; "
            "a larger mesh_size needs less"
        )


def _machine(system: Path) -> float:
    entries = _entries(system / "proc" / "meminfo")
    return 1024.0 * (entries.get("MemAvailable:", float("inf")) + entries.get("SwapFree:", 0.0))


def _group(system: Path) -> float:
    """Memory left to the nearest control group and those around it, in version 1 or 2 of the kernel's files."""
    least = float("inf")
    for line in _lines(system / "proc" / "self" / "cgroup"):
        number, controllers, name = line.strip().split(":", 2)
        if number == "0":
            top, limit, use, cache = system / "sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"
        elif "memory" in controllers.split(","):
            top, limit, use = system / "sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"
            cache = "total_inactive_file"
        else:
            continue
        place = top / name.lstrip("/")
        for folder in (place, *place.parents):
            most, usage = _number(folder / limit), _number(folder / use)
            if most is not None and usage is not None:
                least = min(least, most - usage + _entries(folder / "memory.stat").get(cache, 0.0))
            if folder == top:
                break
    return least


def _own_limit(system: Path) -> float:
    try:
        import resource
    except ImportError:  # no such limits on this system
        return float("inf")
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return float("inf")
    pages = next(iter(_lines(system / "proc" / "self" / "statm")), "0").split()[0]
    return float(limit - int(pages) * os.sysconf("SC_PAGE_SIZE"))


def _entries(path: Path) -> dict[str, float]:
    """Name and number of each line."""
    pairs = (line.split() for line in _lines(path))
    return {pair[0]: float(pair[1]) for pair in pairs if len(pair) > 1 and pair[1].isdigit()}


def _number(path: Path) -> float | None:
    text = "".join(_lines(path)).strip()
    return float(text) if text.isdigit() else None


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return []

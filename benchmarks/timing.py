"""What all benchmarks share: a clock, a command line, and what the machine is."""

import argparse
import os
import platform
import time
from collections.abc import Callable
from typing import TypeVar

Result = TypeVar("Result")


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """What some work gives, and the seconds it took."""
    start = time.perf_counter()
    result = work()
    return result, time.perf_counter() - start


def arguments(description: str, **defaults: tuple[type, object, str]) -> argparse.Namespace:
    """The command line: each option by name with its type, default and meaning."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    for name, (kind, default, meaning) in defaults.items():
        option = f"--{name.replace('_', '-')}"
        if kind is bool:
            parser.add_argument(option, action="store_true", help=meaning)
        else:
            parser.add_argument(option, type=kind, default=default, help=meaning)
    return parser.parse_args()


def machine() -> str:
    """What the numbers were measured on."""
    cores, load = os.cpu_count(), os.getloadavg()[0]
    return f"{platform.machine()}, {cores} cores, Python {platform.python_version()}, load {load:.1f} at the start"

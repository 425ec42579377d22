"""Results by analysis: each module declares the quantities of one, and the sections that terminal and report show."""

from gearwhine.results.housing import write_shapes

__all__ = ["write_shapes"]

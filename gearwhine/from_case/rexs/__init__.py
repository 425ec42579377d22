"""A case's gear unit as a REXS model, the way back of :mod:`gearwhine.exchange.rexs.importing`."""

from gearwhine.from_case.rexs.exporting import ExportedUnit, rexs_of

__all__ = ["ExportedUnit", "rexs_of"]

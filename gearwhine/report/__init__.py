"""The results folder as one HTML page that needs nothing else: figures, tables and pictures that a run left there."""

from gearwhine.report.page import report_page
from gearwhine.report.sections import Section, sections_of
from gearwhine.report.tables import Column, Table

__all__ = ["Column", "Section", "Table", "report_page", "sections_of"]

"""Report of a results folder: one HTML page with its pictures inside.

* :mod:`~gearwhine.output.report.page`: the document: first page, contents, and the results of each command.
* :mod:`~gearwhine.output.report.elements`: sections, tables and links as HTML.
* :mod:`~gearwhine.output.report.pictures`: pictures with their captions.
* :mod:`~gearwhine.output.report.interactive`: shapes that move, and curves to zoom, by the libraries of
  :mod:`gearwhine.output.viewers`.
* :mod:`~gearwhine.output.report.freshness`: whether results fit the case of now.
"""

from gearwhine.output.report.interactive import MovingShape
from gearwhine.output.report.page import Contents, report_page

__all__ = ["Contents", "MovingShape", "report_page"]

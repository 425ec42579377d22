"""Output of results: declared quantities, and the files, the terminal and the report that are made from them.

* :mod:`~gearwhine.output.quantity`: a quantity of a result, declared once; the JSON document.
* :mod:`~gearwhine.output.dataset`: labelled arrays, in memory and as NetCDF.
* :mod:`~gearwhine.output.sections`: sentences and tables over a document, for terminal and report alike.
* :mod:`~gearwhine.output.terminal`, :mod:`~gearwhine.output.report`: these on the terminal, and as a page.
* :mod:`~gearwhine.output.files`: files that appear whole or not at all.
"""

from gearwhine.output.files import SUMMARY, file_stems, finite, json_text, listed_files, read_summary, staging

__all__ = [
    "SUMMARY",
    "file_stems",
    "finite",
    "json_text",
    "listed_files",
    "read_summary",
    "staging",
]

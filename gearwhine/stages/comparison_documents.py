from gearwhine.results.comparison import comparison_document

__all__ = ["comparison_document"]

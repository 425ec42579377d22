from gearwhine.results.housing import modes_document, origin_document

__all__ = ["modes_document", "origin_document"]

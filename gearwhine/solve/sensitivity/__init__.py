"""Sensitivity of a loaded case: parameters of its housing, as changes of the housing's model."""

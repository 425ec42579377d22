"""Checks of a case beyond single keys: by table, and across tables."""

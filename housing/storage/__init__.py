"""Labelled arrays and solved housings on file."""

"""Tooth stiffness: tooth models and their choice, gear body, Hertzian contact, ISO 6336."""

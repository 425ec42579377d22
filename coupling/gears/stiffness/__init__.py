"""Tooth stiffness: tooth models, gear body, Hertzian contact, ISO 6336."""

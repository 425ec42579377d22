"""Figures of gear pairs: teeth, flanks, contact, mesh stiffness, transmission error."""

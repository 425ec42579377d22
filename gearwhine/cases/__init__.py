"""Bundled cases: small ones for each command, and the published gearboxes."""

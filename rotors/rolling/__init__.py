"""Rolling."""

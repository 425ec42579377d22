"""Linear dynamics about the operating point: complex modes, stability, Campbell diagram, frequency response."""

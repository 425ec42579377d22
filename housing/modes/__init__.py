"""Natural modes of a housing: eigensolver, certificate, residual modes, and quantities derived from modes."""

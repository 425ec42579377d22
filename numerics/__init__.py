"""Ground floor of all rooms: array types, kernels, banded matrices, trust region, branches of modes, findings."""

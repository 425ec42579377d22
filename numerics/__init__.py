"""Ground floor of all rooms: compiled kernels, banded matrices, trust region, branches of modes; findings, copies."""

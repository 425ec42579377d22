"""Description of a machine: its parts, train, arrangement and excitation; and what of them cannot be."""

"""Sound of a case: its lines and modes, at microphones, of mesh harmonics, and the proofs of all."""

"""Pictures, films and 3D models of mode shapes."""

"""Mesh files: Abaqus and CalculiX, Nastran, and the formats that meshio knows."""

"""The mesh under a steady load: transmission error, mesh stiffness, Harris map, optimal relief, pressure, friction."""

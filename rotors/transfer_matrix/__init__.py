"""Transfer matrices of shafts: Timoshenko elements, the Wittrick-Williams root count, mode shapes."""

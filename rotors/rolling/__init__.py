"""Rating life of rolling bearings under their loads."""

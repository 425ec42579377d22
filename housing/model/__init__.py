"""The description of a housing: material, supports and other fixtures, seats and sensors."""

"""Ground floor of all rooms: findings of parts that check themselves, names that look alike, plausible materials."""

"""Gear geometry: basic rack, involute teeth, gear pair, path of contact, flank modifications, deviations and faults."""

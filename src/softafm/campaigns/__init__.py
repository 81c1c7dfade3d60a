"""Sweeps and maps: many runs of one kind, kept in a store."""

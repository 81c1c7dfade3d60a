"""Results: datasets with names, units and provenance, and the files that hold them."""

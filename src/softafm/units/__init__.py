"""Units at the edge of the program: text with a unit in, SI floats inside."""

"""Compiled code: how functions are compiled, kept between processes, and what all loops share."""

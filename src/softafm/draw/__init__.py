"""Figures, movies and tables for people."""

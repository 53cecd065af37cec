"""Sweeps kept in a folder: pieces, what they are of, and who writes them."""

"""Meshes and decks that stand beside matrices, or are parts by themselves: nodes with labels, sets, surfaces."""

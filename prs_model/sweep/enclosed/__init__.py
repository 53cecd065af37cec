"""Frequencies at any poses in one basis, bounded from both sides."""

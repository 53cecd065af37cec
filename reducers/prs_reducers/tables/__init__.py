"""Numbers in text files: matrices, tables, what rows are."""

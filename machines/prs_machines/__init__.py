"""Machines that ship with prs-model, one folder each."""

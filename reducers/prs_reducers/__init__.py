"""Reducer plug-ins that ship with prs-model: one format or method per file."""

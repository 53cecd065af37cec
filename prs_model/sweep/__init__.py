"""Maps of the workspace: frequencies and what comes with them at many poses at once."""

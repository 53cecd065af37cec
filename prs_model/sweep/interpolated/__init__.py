"""Maps by interpolation: smooth matrices at nodes, and modes counted in between."""

"""Elements that are assembled here: tetrahedra, beams, springs, point masses."""

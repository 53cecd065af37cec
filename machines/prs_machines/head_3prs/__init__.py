"""3-PRS power head, a reconstruction of the machine of the paper (see README.md)."""

"""Why a faster way of working out a sweep does not serve."""

from ..errors import PrsError


class NotSmoothError(PrsError):
    """In words for the certificate; another way is taken."""

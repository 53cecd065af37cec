"""``python -m prs_model`` is ``prs-model``."""

import sys

from .cli import main

sys.exit(main())

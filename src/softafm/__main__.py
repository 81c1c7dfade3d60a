"""``python -m softafm``: the command line."""

import sys

from softafm.cli import main

sys.exit(main())

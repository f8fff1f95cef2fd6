"""`python -m stiction.design` is `stiction design`."""

import sys

from .command import main

sys.exit(main())

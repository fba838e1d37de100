"""``python -m hpf``: the program."""

import sys

from hpf._program import main

sys.exit(main())

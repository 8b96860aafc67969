"""Studies recordings from a shell: ``python -m reality_sim.studies RECORDING... --settings FILE --out FOLDER``."""

import sys

from .program import main

if __name__ == "__main__":
    sys.exit(main())

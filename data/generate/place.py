"""Where the generators write: the data folder, or the folder given on the command line."""
import os
import sys


def path(*parts):
    here = os.path.dirname(os.path.abspath(__file__))
    made = os.path.join(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(here), *parts)
    os.makedirs(os.path.dirname(made), exist_ok=True)
    return made

"""`python -m periph_sim` is `periph-sim`."""

from .cli import main

main()

"""Runs the program mpmstab and returns what it finds.

    import mpmstab
    limit = mpmstab.critical(formulation="musl", basis="quadratic", ppc=2)
    limit.critical.critical_courant

The functions are the tasks of the program. Keyword arguments are its options, as 'mpmstab list options' prints them.
mpmstab.dt finds the largest stable step of your own particles, without the program.
"""
from .errors import BadInput, Failed, NotBuilt
from .tasks import critical, ensemble, map, run, spectrum, symbol

__all__ = ["BadInput", "Failed", "NotBuilt", "critical", "ensemble", "map", "run", "spectrum", "symbol"]

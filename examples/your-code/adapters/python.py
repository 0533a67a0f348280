"""An adapter for your code. Fill in the five places, then: mpmstab spectrum -program 'python3 mine.py'

The module mpmstab.adapter is mpmstab's: set PYTHONPATH to its folder scripts/python, or run pip install ./scripts/python.
"""
from mpmstab.adapter import serve  # import it before your code: what is printed from here on goes to standard error
import numpy

# FILL 1: the state: all that a step changes and a later step reads. The first index is the particle.
state = {"x": numpy.zeros((8, 2)), "v": numpy.zeros((8, 2)), "stress": numpy.zeros((8, 3))}

# FILL 2: the width of a cell, and the period of each direction (None: it has no period).
cell_width, periodic = 0.1, [None, None]

# FILL 3: the parameters that mpmstab may set, with the values of your code.
parameters = {"dt": 1e-4}

# FILL 4: the field that is the place. Where you know it, the size of a usual change of another field: {"v": {"scale": 20}}.
fields = {"x": {"place": True}}


# FILL 5: one step. It changes the arrays of the state, or returns a dictionary of new ones, and keeps nothing else.
def step(state, dt):
    raise NotImplementedError("FILL 5: one step of your code")


serve(step, state, cell_width=cell_width, periodic=periodic, parameters=parameters, fields=fields, name="mine")

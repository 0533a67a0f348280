"""An adapter for your code. Fill in the five places, then: mpmstab spectrum -program 'python3 mine.py'

mpmstab chooses the particles: 10 cells each way with 2 particles each way, or those of -program_scene.
The module mpmstab.adapter is mpmstab's: set PYTHONPATH to its folder scripts/python, or run pip install ./scripts/python.
"""
from mpmstab.adapter import serve  # import it before your code: what is printed from here on goes to standard error
import numpy

# FILL 1: one particle at rest: the names and values of all that a step changes and a later step reads, and what else differs
# from particle to particle. The first index is the particle.
state = {"x": numpy.zeros((1, 2)), "v": numpy.zeros((1, 2)), "stress": numpy.zeros((1, 3)), "volume": numpy.ones(1), "mass": numpy.ones(1)}

# FILL 2: the width of a cell. The grid has the periods that mpmstab asks for, or yours: periodic=[1.0, None] in serve below.
cell_width = 0.1

# FILL 3: the parameters that mpmstab may set, with the values of your code.
parameters = {"dt": 1e-4}

# FILL 4: which of the names above is the place, and which are the volume and the mass, if they are there.
fields = {"x": {"place": True}, "volume": {"volume": True}, "mass": {"mass": True}}

grid = {}  # mpmstab fills in: cell_width and periodic, which has the period of each direction, or None


# FILL 5: one step. It changes the arrays of the state, or returns a dictionary of new ones, and keeps nothing else.
def step(state, dt):
    raise NotImplementedError("FILL 5: one step of your code")


serve(step, state, cell_width=cell_width, scenes=grid, parameters=parameters, fields=fields, name="mine")

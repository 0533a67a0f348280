"""Lets mpmstab analyse the step of your code.

probe: one call in your own time loop writes the matrix of your step.
serve: your code answers 'mpmstab spectrum -program "python3 mine.py"' and other tasks.

A state is a dictionary of your own arrays, first index the particle: numpy, Taichi fields, Warp arrays, torch tensors.
"""
import json
import os

import numpy

from .hook import gather, numbers, probe, scatter

__all__ = ["probe", "serve"]


def take_output():
    """Standard input and output for the answers alone. What else is printed goes to standard error."""
    asked, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return asked, answers


# mpmstab says that it has started this program. Libraries that are imported later may then print what they like.
TAKEN = take_output() if os.environ.pop("MPMSTAB_ASKS", None) else None


def arrange(message, given, rest, fields, scenes):
    """The state of a scene: of a function, or particles like the one at rest but for place, volume and mass."""
    about = {name: value for name, value in message.items() if name not in ("do", "particles")}
    if callable(scenes):
        return scenes(about, given[:, :-2], given[:, -2], given[:, -1])
    scenes.update(about)
    state = {of: numpy.repeat(numbers(array)[:1], len(given), 0) for of, array in rest.items()}
    for field in fields:
        for role, columns in (("place", given[:, :-2]), ("volume", given[:, -2]), ("mass", given[:, -1])):
            if field.get(role):
                state[field["name"]] = columns.reshape(state[field["name"]].shape)
    return state


def serve(step, state, *, cell_width, periodic=None, fields=None, parameters=None, name="mine", steps=1, any_count=False,
          scenes=None, reset=None, batch=64):
    """Answers mpmstab until it has no more questions. What is printed after the import of this module goes to standard error.

    step(state, **parameters) does one step: it changes the arrays of the state, or returns a dictionary of new ones.
    cell_width, periodic: of the grid; a period or None for each direction.
    fields: what is to be said of a field, {"x": {"place": True}, "v": {"scale": 20}}. Exactly one is the place.
        mpmstab finds the scales that are not said.
    parameters: their values, {"dt": 1e-4}. mpmstab sets them.
    steps: after so many steps the state can be compared with the one before.
    any_count: the step takes any number of particles; it then gets numpy arrays made for it.
    scenes: a dictionary: mpmstab chooses the particles. The state is that of one particle at rest, which each of them gets, with its
        own place, and its volume and mass in the fields that are {"volume": True} and {"mass": True}. cell_width, periodic (if it is not
        given here) and, if mpmstab says one, material of the grid are then put into the dictionary. Or a function: it gets
        such a dictionary, places, volumes and masses, and returns the state.
    reset: called before the steps of each state. It forgets all that the code keeps besides the state.
    batch: so many states may come in one request. They are stepped one after another.
    """
    asked, answer = TAKEN or take_output()
    base, values = gather(state), dict(parameters or {})
    kinds = {of: numbers(array) for of, array in state.items()}
    described = [{"name": of, "size": a.size // len(a), **(fields or {}).get(of, {})} for of, a in kinds.items()]
    place = [of["size"] for of in described if of.get("place")]
    dim = place[0] if place else len(periodic or [0])
    described = {"protocol": 1, "name": name, "dim": dim, "cell_width": cell_width, "fields": described, "parameters": values, "steps": steps,
                 "any_count": any_count, "scenes": scenes is not None, "reset": reset is not None, "batch": batch}
    if scenes is None:
        described.update(particles=len(base), periodic=periodic or [None] * dim)
    elif periodic:
        described.update(periodic=periodic)
    any_count = any_count or scenes is not None
    for line in asked:
        message, head, tail = json.loads(line), {}, b""
        try:
            if message["do"] == "quit":
                return
            if message["do"] == "describe":
                head, tail = described, b"" if scenes is not None else base.tobytes()
            elif message["do"] == "set":
                values.update({of: value for of, value in message.items() if of in values})
            elif message["do"] == "scene":
                given = numpy.frombuffer(asked.read(8 * message["particles"] * (dim + 2))).reshape(-1, dim + 2)
                base = gather(arrange(message, given, state, described["fields"], scenes))
                tail = base.tobytes()
            else:
                count = message.get("particles", len(base))
                given = numpy.frombuffer(asked.read(8 * count * base.shape[1] * message.get("states", 1)))
                for one in given.reshape(-1, count, base.shape[1]):
                    now = {of: numpy.empty((count, *a.shape[1:]), a.dtype) for of, a in kinds.items()} if any_count else state
                    scatter(now, one)
                    if message.get("reset"):
                        reset()
                    for _ in range(message["steps"]):
                        now = step(now, **values) or now
                    tail += gather(now).tobytes()
        except Exception as wrong:  # whatever goes wrong in the code is its answer
            head, tail = {"error": f"{type(wrong).__name__}: {wrong}"}, b""
        answer.write(json.dumps(head).encode() + b"\n" + tail)
        answer.flush()

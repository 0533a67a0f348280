#!/usr/bin/python3
"""A step of our own for -program, from blocks that 'symbol -write_blocks' wrote: program_blocks.py BLOCKS.npz FORM.

The cells fill a period. FORM is JSON: cells (in each direction), ppc (in each direction), fields as [name, [[register,
factor]...]], which say for each number of the code what register of ours it is and by which factor, and wrong: a number
that is added to one entry of a block, as [block, row, column, number].
"""
import itertools
import json
import sys

import numpy


def lattice(form, dim):
    """The places of particles, cell by cell and x fastest, in cells."""
    cells = [c[::-1] for c in itertools.product(range(form["cells"]), repeat=dim)]
    sites = [s[::-1] for s in itertools.product(*(range(count) for count in form["ppc"][::-1]))]
    return numpy.array([[c[a] + (s[a] + 0.5) / form["ppc"][a] for a in range(dim)] for c in cells for s in sites])


def main():
    with numpy.load(sys.argv[1]) as file:
        d, A = file["d"].reshape(len(file["A"]), -1).astype(int), file["A"].copy()
    form = json.loads(sys.argv[2])
    if "wrong" in form:
        A[tuple(form["wrong"][:3])] += form["wrong"][3]
    dim, n = d.shape[1], form["cells"]
    order = [register for _, numbers in form["fields"] for register, _ in numbers]
    factors = numpy.array([factor for _, numbers in form["fields"] for _, factor in numbers])
    places = lattice(form, dim)
    base = numpy.hstack([places, numpy.zeros((len(places), len(order)))])
    shape = (n,) * dim + (-1,)  # the first axis is the last direction
    fields = [{"name": "x", "size": dim, "place": True}]
    fields += [{"name": name, "size": len(numbers), "scale": abs(numbers[0][1])} for name, numbers in form["fields"]]
    read, write = sys.stdin.buffer, sys.stdout.buffer
    for line in read:
        ask = json.loads(line)
        answer, data = {}, b""
        if ask["do"] == "describe":
            answer = {"protocol": 1, "name": "blocks", "dim": dim, "cell_width": 1.0, "periodic": [float(n)] * dim,
                      "particles": len(base), "fields": fields, "parameters": {"dt": 0.5}}
            data = base.tobytes()
        elif ask["do"] == "step":
            state = numpy.frombuffer(read.read(base.nbytes)).reshape(base.shape).copy()
            for _ in range(ask["steps"]):
                own = numpy.zeros((len(base), len(order)))
                own[:, order] = state[:, dim:] / factors
                own = own.reshape(shape)
                new = sum(numpy.roll(own, tuple(one[::-1]), tuple(range(dim))) @ block.T for one, block in zip(d, A))
                state[:, dim:] = new.reshape(len(base), -1)[:, order] * factors
            data = state.tobytes()
        else:
            break
        write.write(json.dumps(answer).encode() + b"\n" + data)
        write.flush()


if __name__ == "__main__":
    main()

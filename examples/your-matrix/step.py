"""Writes the operator of a step that you have as A.npz, and its blocks as blocks.npz: here masses on a ring of springs."""
import numpy
import scipy.sparse

n, dt = 50, 1.01  # in units of sqrt(mass / stiffness), where the step is stable up to dt = 1


def step(q):
    u, v = q[::2], q[1::2]  # displacement and velocity, mass by mass
    v = v + dt * (numpy.roll(u, 1) - 2 * u + numpy.roll(u, -1))
    return numpy.column_stack([u + dt * v, v]).ravel()


A = numpy.column_stack([step(unit) for unit in numpy.eye(2 * n)])
scipy.sparse.save_npz("A.npz", scipy.sparse.csr_matrix(A))
numpy.savez("blocks.npz", d=[0, 1, -1], A=[A[2 * i % (2 * n):, :2][:2] for i in (0, 1, n - 1)], steps=1)

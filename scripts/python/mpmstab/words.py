"""Turns keyword arguments into words of the command line, and arrays and texts into files that the program reads."""
import os

import numpy

from .errors import BadInput


def text_of(name, value):
    """Returns a value as the program reads it: tuples with commas, True as true, fractions as 1/8."""
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, numpy.ndarray):
        value = value.tolist()
    if isinstance(value, numpy.generic):
        value = value.item()
    if isinstance(value, (list, tuple)):
        return ",".join(text_of(name, one) for one in value)
    if isinstance(value, dict) or value is None:
        raise BadInput(f"-{name} {value}: allowed: a number, a text, True, False, or several of them in a tuple")
    return str(value)


def words_of(options):
    return [word for name, value in options.items() for word in (f"-{name}", text_of(name, value))]


def file_of(text, folder, name):
    """Returns the path of a file. A text of more than one line is its content, which is written to the folder."""
    if not isinstance(text, str) or "\n" not in text:
        return os.fspath(text)
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def is_path(value):
    return isinstance(value, (str, os.PathLike))


def numbers_of(name, value):
    """Returns an array of real numbers. Whole numbers stay whole."""
    try:
        array = numpy.asarray(value)
    except ValueError as error:
        raise BadInput(f"{name}: its parts differ in shape; allowed: an array of numbers") from error
    if array.dtype.kind not in "biuf":
        raise BadInput(f"{name}: numbers of the type {array.dtype}; allowed: whole or real numbers")
    return array


def matrix_file(matrix, folder):
    """Writes a matrix of numpy or scipy as scipy's save_npz does, in rows. Returns its path; a path stays as it is."""
    if is_path(matrix):
        return os.fspath(matrix)
    if hasattr(matrix, "tocsr"):
        rows = matrix.tocsr()
        data, indices, indptr, shape = rows.data, rows.indices, rows.indptr, rows.shape
    else:
        matrix = numbers_of("matrix", matrix)
        if matrix.ndim != 2:
            raise BadInput(f"matrix of the shape {matrix.shape}: allowed: an array with rows and columns, or a file")
        at, indices = numpy.nonzero(matrix)
        data, shape = matrix[at, indices], matrix.shape
        indptr = numpy.concatenate(([0], numpy.cumsum(numpy.bincount(at, minlength=shape[0]))))
    path = os.path.join(folder, "matrix.npz")
    numpy.savez(path, data=data, indices=indices, indptr=indptr, shape=shape, format=b"csr")
    return path


def blocks_file(blocks, folder):
    """Writes blocks {d: A_d} as the program reads them, arrays d and A. Returns their path; a path stays as it is."""
    if is_path(blocks):
        return os.fspath(blocks)
    if not isinstance(blocks, dict) or not blocks:
        raise BadInput("matrix_blocks: allowed: a file, or a dictionary such as {0: A0, 1: A1} or {(0, 0): A00, ...}")
    path = os.path.join(folder, "blocks.npz")
    offsets = numbers_of("keys of matrix_blocks", list(blocks))
    numpy.savez(path, d=offsets.reshape(len(blocks), -1), A=numbers_of("matrix_blocks", list(blocks.values())))
    return path

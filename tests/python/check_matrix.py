#!/usr/bin/python3
"""Checks matrices and blocks from files: spectrum -matrix, symbol -matrix_blocks, -write_matrix and -write_blocks.

check_matrix.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import os
import struct
import subprocess
import sys

import h5py
import numpy
import scipy.io
import scipy.sparse

from checks import ROOT, check, check_one_line, loaded, on_ranks, text_of

MPMSTAB = sys.argv[-1]
DRIFT = "-formulation usl -cells 6 -courant 0.5 -drift 1/4 -jitter 0.2".split()
SPACE = "-dim 2 -cells 6,4 -formulation musl -courant 0.7 -jitter 0.3".split()
MOVES = "-formulation gas2 -cells 8 -courant 0.5 -drift 1/4".split()
PLANE = "-dim 2 -cells 8,6 -formulation usl -courant 0.6 -drift 1/2,0".split()
AT_REST = "-dim 3 -cells 4 -ppc 1 -formulation musl -courant 0.4".split()


def run(*words, ranks=1):
    """Runs mpmstab and returns its JSON."""
    done = on_ranks(ranks, MPMSTAB, *map(str, words), "-json", "out.json")
    check(done.returncode == 0 and done.stderr == "", f"{words}, {ranks} ranks: {done.stderr}")
    check(not [f for f in os.listdir(".") if f.endswith(".part")], f"{words}: an unfinished file is left")
    return loaded("out.json")


def refuse(says, *words, ranks=1):
    done = on_ranks(ranks, MPMSTAB, *words, timeout=60)
    check_one_line(done, words, says)


def near(found, expected, tolerance, what):
    apart = numpy.max(numpy.abs(numpy.asarray(found) - numpy.asarray(expected)))
    check(apart <= tolerance, f"{what}: apart by {apart:.2g}, allowed {tolerance:.2g}")


def apart(found, expected):
    """The largest distance of a found eigenvalue from the expected ones, and the other way round."""
    distance = numpy.abs(numpy.subtract.outer(found, expected))
    return max(distance.min(axis=0).max(), distance.min(axis=1).max())


def content(path):
    with open(path, "rb") as file:
        return file.read()


def eigenvalues(path="out.h5"):
    with h5py.File(path) as file:
        pairs = file["spectrum/eigenvalues"][:]
    return pairs[:, 0] + 1j * pairs[:, 1]


def check_round(scene, ranks, verdict):
    """A scene's operator goes through every format and comes back with the same bits. A matrix has no nodes, so a scene at
    rest is solved without them, too."""
    particles = [] if "-drift" in scene else ["-nodal", "false"]
    whole = run("spectrum", *scene, "-measure", "false", *particles, "-write_matrix", "a.mtx", "-output", "out.h5",
                ranks=ranks)
    steps, of_scene = whole["spectrum"]["period_steps"], eigenvalues()
    check(whole["verdict"] == verdict, f"{scene}: {whole['verdict']}")
    for source, target in [("a.mtx", "b.npz"), ("b.npz", "c.h5"), ("c.h5", "d.petsc"), ("d.petsc", "e.mtx")]:
        said = ["-matrix_steps", steps] if source == "d.petsc" else []
        result = run("spectrum", "-matrix", source, *said, "-write_matrix", target, "-output", "out.h5", ranks=ranks)
        check(result["growth"] == whole["growth"] and result["verdict"] == verdict and
              result["spectrum"]["period_steps"] == steps, f"{scene}, {source}, {ranks} ranks: {result['growth']!r}")
        check(numpy.array_equal(eigenvalues(), of_scene), f"{source}: other eigenvalues than the scene's")
        check(not {"predicted", "cells", "ppc", "courant", "symbol", "run", "formulation"} & set(result) and
              not {"step_mismatch", "assemble_s", "unseen"} & set(result["spectrum"]) and result["matrix"] == source,
              f"{source}: keys that a matrix does not have: {sorted(result)}")
    check(content("a.mtx") == content("e.mtx"), f"{scene}: its operator has changed on its way through all formats")
    ours = scipy.sparse.load_npz("b.npz")
    near((scipy.io.mmread("a.mtx") - ours).toarray(), 0, 0, "scipy on .npz and .mtx")
    check(apart(numpy.linalg.eigvals(ours.toarray()), of_scene) < 1e-6, f"{scene}: numpy's eigenvalues")
    return steps


def check_scipy():
    """What scipy and others write is read, and each question has numpy's answer."""
    rng = numpy.random.default_rng(5)
    n, steps = 23, 3
    A = numpy.where(rng.random((n, n)) < 0.3, rng.standard_normal((n, n)), 0)
    A[3] = 0
    A *= 1.2 / max(abs(numpy.linalg.eigvals(A)))
    values, right = numpy.linalg.eig(A)
    largest = max(abs(values))
    for make in (scipy.sparse.csr_matrix, scipy.sparse.csc_matrix, scipy.sparse.coo_matrix):
        scipy.sparse.save_npz("s.npz", make(A), compressed=make is not scipy.sparse.coo_matrix)
        result = run("spectrum", "-matrix", "s.npz", "-matrix_steps", steps, "-powers", 12, "-pseudospectrum", 4,
                     "-modes", 2, "-output", "s.h5", "-csv", "s.csv")
        check(apart(eigenvalues("s.h5"), values) < 1e-12, f"{make.__name__}: other eigenvalues than numpy's")
    near(result["growth"], largest ** (1 / steps), 1e-13, "growth per step")
    check(result["verdict"] == "unstable" and result["transient"]["steps"] == [0, 3, 6, 9, 12], result["transient"])
    norms = [numpy.linalg.norm(numpy.linalg.matrix_power(A, k), 2) for k in range(5)]
    near(result["transient"]["norm"], norms, 1e-6 * max(norms), "norm(A^n)")
    left = numpy.linalg.inv(right)[numpy.argmax(abs(values))]
    condition = numpy.linalg.norm(left) * numpy.linalg.norm(right[:, numpy.argmax(abs(values))])
    near(result["spectrum"]["condition"], condition, 1e-6 * condition, "condition")
    with h5py.File("s.h5") as file:
        re, sigma = file["pseudospectrum/re"][:], file["pseudospectrum/sigma"][:]
        exact = [[numpy.linalg.svd((x + 1j * y) * numpy.eye(n) - A)[1][-1] for x in re] for y in re]
        near(sigma, exact, 1e-10, "sigma")
        mode = file["modes/0001/vector_re"][:] + 1j * file["modes/0001/vector_im"][:]
        value = file["modes/0001"].attrs["re"] + 1j * file["modes/0001"].attrs["im"]
        near(A @ mode, value * mode, 1e-12, "mode 1")
        check(file.attrs["matrix"] == b"s.npz" and "cells" not in file.attrs, "attributes of the file")
    check_others(A, values)
    D = 10.0 ** rng.integers(-9, 10, n)  # SI units: without balance rounding would leave the verdict open
    scipy.sparse.save_npz("s.npz", scipy.sparse.csr_matrix(D[:, None] * A * 0.8 / D))
    result = run("spectrum", "-matrix", "s.npz", "-output", "s.h5")
    near(result["growth"], 0.96, 1e-12, "growth in other units")
    check(result["verdict"] == "stable", f"in other units: {result['verdict']}")
    with h5py.File("s.h5") as file:
        mode = (file["modes/0001/vector_re"][:] + 1j * file["modes/0001/vector_im"][:]) / D
        value = file["modes/0001"].attrs["re"] + 1j * file["modes/0001"].attrs["im"]
        near(A @ mode * 0.8, value * mode, 1e-11 * numpy.linalg.norm(mode), "mode 1 in other units")


def check_others(A, values):
    """Formats that other programs write: entries twice, integers, dense and symmetric text, columns in HDF5, 64 bits."""
    n = len(A)
    rows, columns = A.nonzero()
    whole = numpy.round(10 * A).astype(numpy.int16)
    twice = scipy.sparse.coo_matrix((numpy.r_[A[rows, columns], A[rows, columns]] / 2,
                                     (numpy.r_[rows, rows], numpy.r_[columns, columns])), (n, n))
    scipy.sparse.save_npz("twice.npz", twice)
    scipy.sparse.save_npz("whole.npz", scipy.sparse.csr_matrix(whole))
    scipy.io.mmwrite("dense.mtx", A)
    scipy.io.mmwrite("symmetric.mtx", scipy.sparse.coo_matrix(A + A.T), symmetry="symmetric", precision=17)
    scipy.io.mmwrite("skew.mtx", scipy.sparse.coo_matrix(A - A.T), symmetry="skew-symmetric", precision=17)
    csc, csr = scipy.sparse.csc_matrix(A), scipy.sparse.csr_matrix(A)
    with h5py.File("group.h5", "w") as file:
        group = file.create_group("X")
        group.attrs["encoding-type"] = "csc_matrix"
        for name in ("data", "indices", "indptr"):
            group.create_dataset(name, data=getattr(csc, name), compression="gzip")
    with h5py.File("matlab.h5", "w") as file:
        for name, data in (("data", csc.data), ("ir", csc.indices.astype("u8")), ("jc", csc.indptr.astype("u8"))):
            file["A/" + name] = data
    with open("wide.petsc", "wb") as file:
        file.write(struct.pack(">4q", 1211216, n, n, csr.nnz))
        for part, kind in ((numpy.diff(csr.indptr), ">i8"), (csr.indices, ">i8"), (csr.data, ">f8")):
            file.write(part.astype(kind).tobytes())
    for path, expected in [("twice.npz", values), ("whole.npz", numpy.linalg.eigvals(whole)), ("dense.mtx", values),
                           ("symmetric.mtx", numpy.linalg.eigvals(A + A.T)),
                           ("skew.mtx", numpy.linalg.eigvals(A - A.T)), ("group.h5", values), ("matlab.h5", values),
                           ("wide.petsc", values)]:
        run("spectrum", "-matrix", path, "-output", "o.h5", "-write_matrix", "back.npz")
        check(apart(eigenvalues("o.h5"), expected) < 1e-11 * max(1, abs(expected).max()), f"{path}: eigenvalues")
        if expected is values:  # rows and columns have not changed places
            near(scipy.sparse.load_npz("back.npz").toarray(), A, 1e-15, path)


def read_blocks(path):
    if path.endswith(".npz"):
        with numpy.load(path) as file:
            return {name: file[name] for name in file.files}
    with h5py.File(path) as file:
        return {"d": file["d"][:], "A": file["A"][:], **file.attrs}


def matrix_of(blocks, beta):
    return numpy.einsum("b,bij->ij", numpy.exp(-1j * blocks["d"] @ numpy.atleast_1d(beta)), blocks["A"])


def check_blocks(scene, ranks, verdict):
    """A scene's blocks give its symbol: by numpy at every phase, and read back in both formats."""
    phases = ["-phases", "12"]
    whole = run("symbol", *scene, *phases, "-write_blocks", "g.npz", "-output", "g.h5", ranks=ranks)
    blocks, steps = read_blocks("g.npz"), 1
    with h5py.File("g.h5") as file:
        beta, factors = file["symbol/beta"][:], file["symbol/factors"][:]
    for at, row in zip(beta.reshape(len(factors), -1), factors):
        found = numpy.linalg.eigvals(matrix_of(blocks, at))
        check(apart(found, row[::2] + 1j * row[1::2]) < 1e-6, f"{scene}: amplification factors at {at}")
    for source, target in (("g.npz", "h.h5"), ("h.h5", "i.npz")):
        result = run("symbol", "-matrix_blocks", source, *phases, "-write_blocks", target, "-output", "j.h5", "-csv",
                     "j.csv", ranks=ranks)
        steps = result["lattice"]["period_steps"]
        # a scene may take the symbol of a part of a period, of which the blocks' is a power
        # and a double eigenvalue 1 is known to the root of rounding
        near(result["symbol"]["growth"], whole["symbol"]["growth"], 1e-12 if whole["symbol"]["growth"] > 1 + 1e-6 else 1e-7,
             f"{scene}, {source}")
        check(result["symbol"]["phases"] == whole["symbol"]["phases"] and result["verdict"] == verdict and
              result["growth"] >= result["symbol"]["growth"] and "cells" not in result and "predicted" not in result,
              f"{scene}, {source}: {result}")
        for name, array in read_blocks(target).items():
            check(numpy.array_equal(array, blocks[name]), f"{target}: {name}")
        with h5py.File("j.h5") as file:
            near(numpy.sort(file["symbol/growth"][:]),
                 numpy.sort(numpy.abs(factors[:, ::2] + 1j * factors[:, 1::2]).max(axis=1) ** (1 / steps)), 1e-7,
                 f"{source}: growth over phases")
    refined = result["refined"]
    near(max(abs(numpy.linalg.eigvals(matrix_of(blocks, refined["beta_at_max"])))) ** (1 / steps), refined["growth"], 1e-8,
         f"{scene}: growth at the refined phase")


def check_narrow():
    """Blocks are searched between the phases of the symbol: here growth is confined to a thousandth of them."""
    run("symbol", "-formulation", "gas2", "-basis", "quadratic", "-drift", "3/7", "-courant", "0.1", "-write_blocks",
        "n.npz")
    result = run("symbol", "-matrix_blocks", "n.npz")
    check(result["verdict"] == "unstable", f"narrow window: {result['verdict']}")
    near(result["growth"] - 1, 1.93e-6, 2e-8, "narrow window")


def check_wave():
    """Centred differences of advection: G = 1 - 2 i c sin(beta), so abs(G) is largest at pi / 2, between six phases."""
    c, steps = 0.3, 2
    numpy.savez("w.npz", d=[0, 1, -1], A=[[[1.0]], [[c]], [[-c]]], steps=steps)
    for ranks in (1, 3):
        result = run("symbol", "-matrix_blocks", "w.npz", "-phases", 6, ranks=ranks)
        near(result["symbol"]["growth"], (1 + 4 * c**2 * 0.75) ** (1 / 4), 1e-15, "growth at six phases")
        near(result["growth"], (1 + 4 * c**2) ** (1 / 4), 1e-15, "growth over all waves")
        near(result["refined"]["beta_at_max"], numpy.pi / 2, 1e-6, "the worst phase")
        check(result["lattice"] == {"dim": 1, "unknowns": 1, "blocks": 3, "period_steps": steps}, result)
    rng = numpy.random.default_rng(2)
    for order in "CF":  # a block is A[b][i][j], in whatever order it is stored
        A = rng.random((2, 3, 3))
        numpy.savez("w.npz", d=numpy.array([[0, 1], [2, -1]], order=order), A=numpy.array(A, order=order))
        run("symbol", "-matrix_blocks", "w.npz", "-phases", "3,2", "-output", "w.h5")
        blocks = {"d": numpy.array([[0, 1], [2, -1]]), "A": A}
        with h5py.File("w.h5") as file:
            for at, row in zip(file["symbol/beta"][:], file["symbol/factors"][:]):
                check(apart(numpy.linalg.eigvals(matrix_of(blocks, at)), row[::2] + 1j * row[1::2]) < 1e-12,
                      f"order {order} at {at}")


def savez(path, **arrays):
    numpy.savez(path, **arrays)
    return path


def write(path, text):
    with open(path, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())
    return path


def coo(A):
    scipy.sparse.save_npz("bad.npz", scipy.sparse.coo_matrix(A))
    return "bad.npz"


HEAD = "%%MatrixMarket matrix coordinate real general\n"
ONE = "1 1 1\n1 1 0.5\n"


def check_text():
    """What a Matrix Market file says is taken as it says it, or refused with the line."""
    symmetric, skew = (HEAD.replace("general", kind) for kind in ("symmetric", "skew-symmetric"))
    whole = "a whole number from 1"
    wrong = [(f"line 2: % steps: {text}; allowed: {whole}", f"{HEAD}% steps: {text}\n{ONE}")
             for text in ("0", "abc", "2.5", "-3", "8 x", "8 9", "nan", "inf", "")]
    wrong += [(f"line 2: % {name}: {text}; allowed: {says}", f"{HEAD}% {name}: {text}\n{ONE}") for name, text, says in [
        ("numbers", "three", whole), ("numbers", "1.5", whole), ("single", "yes", "0 or 1"), ("single", "0.5", "0 or 1"),
        ("size", "small", "a finite number from 0"), ("cell_width", "-1", "a finite number from 0"),
        ("cell_width", "1/16", "a finite number from 0"), ("period", "1 x", "a finite number from 0"),
        ("period", "1 1 1 1", "a finite number from 0"), ("scale", "0", "a finite number above 0"),
        ("scale", "inf", "a finite number above 0"), ("at", "here", "finite numbers"), ("at", "", "finite numbers"),
        ("moved", "no", "a number from 0, inf or nan"), ("repeat", "-1", "a number from 0, inf or nan"),
        ("one_sided", "", "a number from 0, inf or nan"), ("two_sizes", "1e-9 !", "a number from 0, inf or nan"),
        ("additivity", "1,5", "a number from 0, inf or nan")]]
    wrong += [
        ("it says that it covers 1000001 steps", f"{HEAD}% steps: 1000001\n{ONE}"),
        ("line 4: % steps: 2; allowed: once", f"{HEAD}% steps: 2\n% other: 3\n% steps: 2\n{ONE}"),
        ("line 3: % at: 1 2; allowed: as many numbers", f"{HEAD}% at: 1\n% at: 1 2\n{ONE}"),
        ("line 5: % steps: x; allowed", f"{HEAD}1 1 1\n\n1 1 0.5\n% steps: x\n"),
        ("line 5: 1 2 1; allowed: of a symmetric matrix the entries on and below", f"{symmetric}2 2 3\n1 1 1\n2 1 1\n1 2 1\n"),
        ("line 3: 1 1 0; allowed: of a skew-symmetric matrix the entries below", f"{skew}2 2 1\n1 1 0\n"),
        ("line 3: 1 2 1; allowed: of a skew-symmetric matrix the entries below", f"{skew}2 2 1\n1 2 1\n"),
        ("line 3: 0 1 5; allowed: rows and columns from 1", f"{HEAD}2 2 1\n0 1 5\n"),
        ("line 3: 1 3 5; allowed: rows and columns from 1", f"{HEAD}2 2 1\n1 3 5\n"),
        ("line 3: 1.5 1 5; allowed: rows and columns from 1", f"{HEAD}2 2 1\n1.5 1 5\n"),
        ("line 3: 1 1 1e999; allowed: finite numbers", f"{HEAD}1 1 1\n1 1 1e999\n"),
        ("line 3: 1 1 0.5; allowed: whole numbers", HEAD.replace("real", "integer") + ONE),
        ("line 2: 1.5 1.5 1; allowed: whole numbers", f"{HEAD}1.5 1.5 1\n1 1 1\n"),
        ("line 2: 2 2 0.5; allowed: whole numbers", f"{symmetric}2 2 0.5\n2 1 1\n"),
        ("allowed: a shorter line", f"{HEAD}1 1 1\n1 1 0.{'5' * 2000}\n"),
        ("entry 1 of 1", f"{HEAD}1 1 1\n1 1 0.5\0\n1 1 0.5\n"),
        ("kind coordinate real hermitian", HEAD.replace("general", "hermitian") + ONE),
        ("kind coordinate real general", HEAD.replace("Market", "Shop") + ONE),
    ]
    for says, text in wrong:
        refuse(says, "spectrum", "-matrix", write("bad.mtx", text))
    refuse("line 2: % steps: abc", "symbol", "-matrix_blocks", write("bad.mtx", f"{HEAD}% steps: abc\n{ONE}"), ranks=2)
    for text, growth in [(f"{HEAD}% steps: 1e3\n{ONE}", 0.5**1e-3), (f"{HEAD}%steps:8\r\n{ONE}", 0.5**0.125),
                         (f"{HEAD}% note: {'1 1 1 ' * 1000}\n{ONE}", 0.5),
                         (f"{HEAD}% moved: nan\n% repeat: inf\n{ONE}", 0.5),
                         (f"{HEAD}1 1 2\n1 1 0.25\n1 1 0.5\n", 0.75),
                         (f"{symmetric}2 2 2\n1 1 0\n2 1 0.7\n", 0.7), (f"{skew}2 2 1\n2 1 0.7\n", 0.7),
                         (HEAD.replace("coordinate", "array").replace("general", "skew-symmetric") + "2 2\n0.7\n", 0.7)]:
        near(run("spectrum", "-matrix", write("good.mtx", text))["growth"], growth, 1e-12, text[:200])


def check_nothing():
    """All eigenvalues of a matrix that is zero, or strictly triangular, are 0."""
    for n in (1, 3, 40):
        for path, A in (("zero.npz", numpy.zeros((n, n))), ("below.npz", numpy.tril(numpy.ones((n, n)), -1))):
            scipy.sparse.save_npz(path, scipy.sparse.csr_matrix(A))
            for ranks in (1, 2) if n == 3 else (1,):
                result = run("spectrum", "-matrix", path, "-expect", "stable", "-powers", 2, ranks=ranks)
                check(result["growth"] == 0 and result["spectrum"]["listed"] == n, f"{path}, {n}: {result}")
                norms = result["transient"]["norm"]
                near(norms, [numpy.linalg.norm(numpy.linalg.matrix_power(A, k), 2) for k in range(len(norms))], 1e-6 * n * n,
                     f"{path}, {n}: norms of powers")
            numpy.savez("nothing.npz", d=[[0], [1]], A=[A, 2 * A])
            result = run("symbol", "-matrix_blocks", "nothing.npz", "-expect", "stable")
            check(result["growth"] == 0 and result["symbol"]["growth"] == 0, f"blocks of {path}, {n}: {result}")
    n, rng = 5000, numpy.random.default_rng(3)  # beyond what LAPACK solves
    order = rng.permutation(n)
    below = scipy.sparse.diags([1.0, -2.0, 0.5], [-1, -2, -70], shape=(n, n), format="csr")[order][:, order]
    ring = scipy.sparse.csr_matrix(([0.5], ([order.argsort()[0]], [order.argsort()[n - 1]])), (n, n))
    for ranks in (1, 3):
        for what, A, growth in (("zero", scipy.sparse.csr_matrix((n, n)), 0), ("triangular", below, 0),
                                ("of one ring", below + ring, None)):
            scipy.sparse.save_npz("big.npz", A)
            result = run("spectrum", "-matrix", "big.npz", "-output", "big.h5", ranks=ranks)
            if growth is None:
                check("triangular" not in result["evidence"], f"{what}: {result}")
                continue
            check(result["growth"] == growth and result["verdict"] == "stable", f"{what}, {ranks} ranks: {result}")
            with h5py.File("big.h5") as file:
                mode = file["modes/0001/vector_re"][:]
            check(numpy.linalg.norm(mode) == 1 and not (A @ mode).any(), f"{what}, {ranks} ranks: mode 1")


def check_sizes():
    """Nothing is read that never ends, and nothing begun that cannot fit."""
    if not os.path.exists("pipe"):
        os.mkfifo("pipe")
    for path in ("pipe", "/dev/zero", "/dev/null"):
        refuse(f"{path}: not a regular file", "spectrum", "-matrix", path)
        refuse(f"{path}: not a regular file", "symbol", "-matrix_blocks", path, ranks=2)
    layout = h5py.VirtualLayout((1,), "f8")
    layout[:] = h5py.VirtualSource("pipe", "data", (1,))
    for says, put in (("array data; allowed", lambda file: file.create_dataset("data", (1,), "f8", external=[("pipe", 0, 8)])),
                      ("array data; allowed", lambda file: file.create_virtual_dataset("data", layout)),
                      ("array data; allowed", lambda file: file.__setitem__("data", h5py.ExternalLink("pipe", "/data"))),
                      ("it has no matrix", lambda file: file.__setitem__("group", h5py.ExternalLink("pipe", "/")))):
        with h5py.File("elsewhere.h5", "w") as file:
            put(file)
        refuse(says, "spectrum", "-matrix", "elsewhere.h5")
    huge = 10**9
    write("huge.mtx", f"{HEAD}{huge} {huge} 1\n1 1 0.5\n")
    for ranks in (1, 2):
        refuse("order 1000000000 with 1 entries: its spectrum needs about", "spectrum", "-matrix", "huge.mtx", ranks=ranks)
    scipy.sparse.save_npz("huge.npz", scipy.sparse.coo_matrix(([1.0], ([0], [0])), (huge, huge)))
    refuse("order 1000000000 with 1 entries: its spectrum needs about", "spectrum", "-matrix", "huge.npz")
    with h5py.File("huge.h5", "w") as file:
        file.create_dataset("data", (10**11,), "f8", chunks=(10**6,))
    with open("huge.h5", "ab") as file:
        file.truncate(10**10)  # a hole, so that the file is as large as compressed data of the array may be
    refuse("to read it takes about", "spectrum", "-matrix", "huge.h5")
    with open("huge.petsc", "wb") as file:
        file.write(struct.pack(">4q", 1211216, 20, 20, 10**10))
        file.truncate(2 * 10**11)
    refuse("entries; allowed: up to", "spectrum", "-matrix", "huge.petsc")
    for path in ("huge.h5", "huge.petsc"):
        os.remove(path)


def check_refusals():
    head = HEAD
    npz, nan = content("b.npz"), numpy.array([[1, numpy.nan], [0, 1]])
    petsc = content("d.petsc")
    broken = bytearray(npz)
    broken[len(npz) // 3] ^= 255
    matrices = [
        ("is not square, 2 x 3", lambda: coo(numpy.ones((2, 3)))),
        ("row 0, column 1, counted from 0, is nan; allowed", lambda: coo(nan)),
        ("row 1, column 1, counted from 0, is infinite; allowed", lambda: coo(numpy.diag([1, numpy.inf]))),
        ("complex numbers", lambda: coo(1j * numpy.eye(2))),
        ("it is cut off", lambda: write("bad.npz", npz[:len(npz) // 2])),
        ("it is cut off, or damaged", lambda: write("bad.npz", bytes(broken))),
        ("format bsr", lambda: (scipy.sparse.save_npz("bad.npz", scipy.sparse.bsr_matrix(numpy.eye(4))), "bad.npz")[1]),
        ("pointers do not fit", lambda: savez("bad.npz", data=[1.0], indices=[0], indptr=[0, 2], shape=[1, 1])),
        ("pointers decrease", lambda: savez("bad.npz", data=[1.0], indices=[0], indptr=[0, 2, 1], shape=[2, 2])),
        ("entry 1 is in row 0 and column 7", lambda: savez("bad.npz", data=[1.0], indices=[7], indptr=[0, 1])),
        ("it has no matrix", lambda: savez("bad.npz", x=[1.0])),
        ("its format is not known", lambda: write("bad.mtx", "")),
        ("its format is not known", lambda: write("bad.mtx", "1 2 3\n")),
        ("kind coordinate complex general", lambda: write("bad.mtx", head.replace("real", "complex") + "1 1 1\n1 1 1 0\n")),
        ("kind coordinate pattern general", lambda: write("bad.mtx", head.replace("real", "pattern") + "1 1 1\n1 1\n")),
        ("it is empty, 0 x 0", lambda: write("bad.mtx", head + "0 0 0\n")),
        ("steps; allowed: one whole number from 1", lambda: savez("bad.npz", data=[1.0], indices=[0], indptr=[0, 1], steps=2.5)),
        ("entry 1 is in row -1 and column 0", lambda: savez("bad.npz", data=[1.0], row=[0.5], col=[0], shape=[2, 2],
                                                            format="coo")),
        ("order 2.5 with 1 entries", lambda: savez("bad.npz", data=[1.0], row=[0], col=[0], shape=[2.5, 2.5], format="coo")),
        ("entry 2 of 2; allowed: a line with row, column and value", lambda: write("bad.mtx", head + "2 2 2\n1 1 5\n1 2\n")),
        ("something follows its 1 entries", lambda: write("bad.mtx", head + "2 2 1\n1 1 5\n2 2 5\n")),
        ("too short for 1e+12 entries", lambda: write("bad.mtx", head + "9 9 1000000000000\n1 1 5\n")),
        ("order 4000000000 with", lambda: write("bad.mtx", head + "4000000000 4000000000 1\n1 1 5\n")),
        ("it is cut off; allowed: a whole file of PETSc", lambda: write("bad.petsc", petsc[:len(petsc) // 2])),
        ("do not fit; allowed: a whole file of PETSc", lambda: write("bad.petsc", petsc[:16] + petsc[20:24] + b"\xff" * 4 + petsc[24:])),
        ("HDF5 cannot read it", lambda: write("bad.h5", content("c.h5")[:2000])),
        ("No such file", lambda: "nowhere.mtx"),
    ]
    for says, make in matrices:
        refuse(says, "spectrum", "-matrix", make())
    refuse("is not square", "spectrum", "-matrix", coo(numpy.ones((2, 3))), ranks=2)
    A = numpy.zeros((2, 3, 3))
    blocks = [
        ("it has no blocks", dict(d=[[0], [1]])),
        ("it has no blocks", dict(d=[[0]], A=A)),
        ("2 of 3 x 2; allowed", dict(d=[[0], [1]], A=A[:, :, :2])),
        ("4 directions", dict(d=[[0] * 4, [1] * 4], A=A)),
        ("array d; allowed: whole numbers", dict(d=[[0], [0.5]], A=A)),
        ("number 1 is nan; allowed", dict(d=[[0], [1]], A=A * numpy.nan)),
        ("steps; allowed", dict(d=[[0], [1]], A=A, steps=0)),
        ("complex numbers", dict(d=[[0], [1]], A=A * 1j)),
        ("at least one, and square", dict(d=numpy.zeros((0, 1)), A=A[:0])),
    ]
    for says, arrays in blocks:
        refuse(says, "symbol", "-matrix_blocks", savez("bad.npz", **arrays))
    refuse("it does not say where its particles are", "symbol", "-matrix_blocks", "a.mtx")
    refuse("its format is not known", "symbol", "-matrix_blocks", "d.petsc")
    savez("bad.npz", d=[[0], [1]], A=A, steps=2)
    refuse("-matrix_steps 3: bad.npz says that it covers 2", "symbol", "-matrix_blocks", "bad.npz", "-matrix_steps", "3")
    refuse("-phases: 2 numbers", "symbol", "-matrix_blocks", "bad.npz", "-phases", "4,4")
    refuse("-courant 0.4: it describes a scene, and matrix takes", "spectrum", "-matrix", "b.npz", "-courant", "0.4")
    write("scene.yaml", "matrix: b.npz\ncells: 8\n")
    refuse("scene.yaml:2: cells: 8: it describes a scene", "spectrum", "scene.yaml")
    refuse("task run does not read it; allowed: with task spectrum", "run", "scene.yaml")
    refuse("allowed: only with matrix or matrix_blocks", "spectrum", "-matrix_steps", "2")
    refuse("allowed: a name that ends in .mtx", "spectrum", "-cells", "4", "-write_matrix", "a.txt")
    refuse("allowed: a name that ends in .npz", "symbol", "-cells", "4", "-write_blocks", "a.mtx")
    refuse("that is the matrix; allowed: another file", "spectrum", "-matrix", "b.npz", "-write_matrix", "b.npz")
    refuse("is not assembled", "spectrum", *"-dim 2 -cells 40 -write_matrix x.npz".split())
    refuse("covers 4 steps, and its powers", "spectrum", "-matrix", "b.npz", "-powers", "3")


def check_example():
    """The page's script and commands give the growth of its closed form, which the page has in six digits."""
    folder = os.path.join(ROOT, "examples", "your-matrix")
    done = subprocess.run([sys.executable, os.path.join(folder, "step.py")], check=False)
    check(done.returncode == 0, "step.py failed")
    half = 2 * 1.01**2 - 1
    growth = half + (half**2 - 1) ** 0.5
    page = text_of(os.path.join(folder, "README.md"))
    check(f"a growth of {growth:.6g} per step" in page, f"the page does not say {growth:.6g}")
    for line in page.splitlines():
        if line.startswith("mpmstab s"):
            near(run(*line.split()[1:])["growth"], growth, 1e-12, line)
    done = subprocess.run([sys.executable, "-c", text_of(os.path.join(folder, "step.py")).replace("1.01", "0.99")],
                          check=False)
    check(done.returncode == 0 and run("spectrum", "-matrix", "A.npz", "-expect", "stable")["verdict"] ==
          run("symbol", "-matrix_blocks", "blocks.npz")["verdict"] == "stable", "not stable at dt = 0.99")


def main():
    check_round(SPACE, 2, run("spectrum", *SPACE, "-measure", "false")["verdict"])
    check(check_round(DRIFT, 1, "unstable") == 4, "steps of the period")
    check_scipy()
    check_blocks(MOVES, 1, "unstable")
    check_blocks(PLANE, 2, run("symbol", *PLANE)["verdict"])
    check_blocks(AT_REST, 1, run("symbol", *AT_REST)["verdict"])
    check_narrow()
    check_wave()
    check_example()
    check_text()
    check_nothing()
    check_sizes()
    check_refusals()


if __name__ == "__main__":
    main()

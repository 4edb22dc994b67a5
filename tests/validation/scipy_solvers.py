"""Solves what the test wrote with SciPy: A.npz and b.txt of a folder give lsqr.txt and nnls.txt."""

import sys

import numpy
import scipy.optimize
import scipy.sparse
import scipy.sparse.linalg

folder = sys.argv[1]
matrix = scipy.sparse.load_npz(f"{folder}/A.npz")
data = numpy.loadtxt(f"{folder}/b.txt")
damp = float(sys.argv[2])
numpy.savetxt(f"{folder}/lsqr.txt",
              scipy.sparse.linalg.lsqr(matrix.astype(float), data, damp=damp, atol=1e-14, btol=1e-14,
                                       conlim=1e14, iter_lim=20000)[0], fmt="%.17g")
dense = matrix.toarray().astype(float)
numpy.savetxt(f"{folder}/nnls.txt", scipy.optimize.nnls(dense, data, maxiter=100000)[0], fmt="%.17g")
# The same matrix goes back as SciPy writes it.
scipy.sparse.save_npz(f"{folder}/back.npz", matrix)

"""A recipe for Spack 1.0 and newer: put it into packages/mpmstab/ of a repository of your own."""
from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Mpmstab(CMakePackage):
    """Stability laboratory for the material point method: which time step a code can take, how accurate its scheme is for
    what cost, and why it breaks."""

    homepage = "https://example.org/mpmstab"  # to fill in: see ../README.md

    # Until the tarball of scripts/release.sh is somewhere: spack develop --path SOURCES mpmstab@0.2.0
    version("0.2.0")

    license("BSD-2-Clause")

    variant("shared", default=True, description="Build a shared library")

    depends_on("c", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("petsc@3.18:+mpi+hdf5+mumps~complex")
    depends_on("slepc@3.18:")
    for series in range(18, 30):  # SLEPc and PETSc are of one series
        depends_on(f"slepc@3.{series}", when=f"^petsc@3.{series}")
    depends_on("hdf5+mpi")
    depends_on("fftw")
    depends_on("jansson@2.9:")
    depends_on("lapack")
    depends_on("libyaml@0.2:")
    depends_on("libzip@1.5:")

    def cmake_args(self):
        return [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define("MPMSTAB_NATIVE", False),  # Spack's compiler wrapper chooses the processor
            self.define("BUILD_TESTING", self.run_tests),
        ]

    def test_limit(self):
        """the limit of usl on hats is sqrt(4/7)"""
        Executable(self.prefix.bin.mpmstab)("critical", "-formulation", "usl", "-expect_critical", "0.75592,0.75594")

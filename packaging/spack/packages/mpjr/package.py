# SPDX-License-Identifier: MIT OR Apache-2.0

from spack.package import *


class Mpjr(Package):
    """Parallel transient viscoelastic contact with friction: MPJR interface elements on PETSc."""

    # There is no release yet, from which a checksum could be: build a checkout by
    #
    #   spack repo add packaging/spack
    #   spack dev-build mpjr@main
    version("main", branch="main")

    license("MIT OR Apache-2.0")

    depends_on("c", type="build")
    depends_on("rust@1.89:", type="build")
    depends_on("pkgconfig", type="build")
    # bindgen reads PETSc's headers with libclang.
    depends_on("llvm+clang", type="build")
    depends_on("mpi")
    depends_on("petsc@3.18:3.24+mpi+mumps~complex+double")
    depends_on("hdf5@1.10:+mpi+hl")

    def setup_build_environment(self, env):
        env.set("PETSC_DIR", self.spec["petsc"].prefix)
        env.unset("PETSC_ARCH")
        env.set("HDF5_DIR", self.spec["hdf5"].prefix)
        env.set("MPICC", self.spec["mpi"].mpicc)
        env.set("LIBCLANG_PATH", self.spec["llvm"].prefix.lib)
        env.set("CARGO_HOME", join_path(self.stage.path, "cargo"))

    def setup_run_environment(self, env):
        env.set("OMP_NUM_THREADS", "1")
        env.set("OPENBLAS_NUM_THREADS", "1")

    def install(self, spec, prefix):
        cargo = which("cargo")
        cargo("install", "--locked", "--path", ".", "--root", prefix)
        mkdirp(prefix.share.man.man1, join_path(prefix.share, "bash-completion", "completions"))
        mpjr = Executable(prefix.bin.mpjr)
        mpjr("man", "--out", prefix.share.man.man1)
        with open(join_path(prefix.share, "bash-completion", "completions", "mpjr"), "w") as file:
            mpjr("completions", "bash", output=file)

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def check_install(self):
        Executable(self.prefix.bin.mpjr)("verify", "--quick")

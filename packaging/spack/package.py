"""A package for Spack: copy the folder of this file to packages/fcm_solve in a repository of your own."""

from spack.package import *
from spack_repo.builtin.build_systems.cargo import CargoPackage


class FcmSolve(CargoPackage):
    """Particles in viscous flow by the force-coupling method."""

    homepage = "https://fcm-solve.github.io/fcm-solve"
    url = "https://github.com/fcm-solve/fcm-solve/releases/download/v0.2.0/fcm-solve-0.2.0-source.tar.xz"
    git = "https://github.com/fcm-solve/fcm-solve.git"

    license("MIT OR Apache-2.0")
    # The line of SHA256SUMS beside it.
    version("0.2.0", sha256="0000000000000000000000000000000000000000000000000000000000000000")

    variant("mpi", default=True, description="Ranks as processes of MPI")

    depends_on("c", type="build")
    depends_on("rust@1.89:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("llvm+clang", type="build", when="+mpi")
    depends_on("hdf5~mpi")
    depends_on("mpi", when="+mpi")

    @property
    def build_args(self):
        return ["--offline", "--locked", *(["--features", "mpi"] if self.spec.satisfies("+mpi") else [])]

    def setup_build_environment(self, env):
        env.set("HDF5_DIR", self.spec["hdf5"].prefix)
        if self.spec.satisfies("+mpi"):
            env.set("LIBCLANG_PATH", self.spec["llvm"].prefix.lib)

    def install(self, spec, prefix):
        mkdirp(prefix.bin)
        install("target/release/fcm-solve", prefix.bin)

from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Collide(CMakePackage):
    """Collision detection between a triangle mesh and very many spheres, on CPU and GPU."""

    homepage = "https://OWNER.github.io/collide"
    git = "https://github.com/OWNER/collide"

    license("BSD-3-Clause")

    # For `spack dev-build` or `spack develop`, which take the sources of a folder.
    version("main")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("eigen@3.4:")

    def cmake_args(self):
        return [self.define(f"COLLIDE_{part}", False) for part in ("TESTS", "EXAMPLES", "BENCH")]

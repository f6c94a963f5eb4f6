/// \file
/// The option --ranks of programs: threads, or processes of mpirun that send by MPI or NCCL.
#pragma once

#include <string>

#include <collide/ranks/thread_ranks.hpp>
#if defined(COLLIDE_HAS_MPI)
#include <optional>

#include <collide/ranks/mpi.hpp>
#endif
#if defined(COLLIDE_HAS_NCCL)
#include <collide/ranks/nccl.hpp>
#endif

#include "error.hpp"
#include "number.hpp"
#include "ranks.hpp"

namespace io {

/// How many ranks `threads:N` asks for; 0 if the text says something else.
inline int threads_of(std::string const& text) {
  std::string const name = "threads:";
  int n = 0;
  if (text.rfind(name, 0) != 0 || !parse_number(text.substr(name.size()), n) || n < 1 || n > 1024) return 0;
  return n;
}

/// True if ranks of that name are processes of mpirun.
inline bool are_processes(std::string const& ranks) { return ranks == "mpi" || ranks == "nccl"; }

/// Throws unless `--ranks` has a value that this program takes, with that space.
inline void check_ranks(std::string const& ranks, std::string const& space) {
  if (!are_processes(ranks) && threads_of(ranks) == 0) {
    throw usage_error("--ranks: " + io::quoted(ranks) + " is none of mpi, nccl, and threads:N, N from 1 to 1024");
  }
#if !defined(COLLIDE_HAS_MPI)
  if (are_processes(ranks)) throw usage_error("--ranks: this program was built without MPI");
#endif
  if (ranks != "nccl") return;
#if !defined(COLLIDE_HAS_NCCL)
  throw usage_error("--ranks: this program was built without NCCL: take mpi");
#endif
  if (space == "host") throw usage_error("--ranks: nccl is for GPUs: say --space cuda_shared, too");
}

/// MPI for as long as a program runs, from when it is begun.
class rank_session {
 public:
  /// Begins it if the ranks are processes.
  void begin([[maybe_unused]] std::string const& ranks, [[maybe_unused]] int& argc, [[maybe_unused]] char**& argv) {
#if defined(COLLIDE_HAS_MPI)
    if (are_processes(ranks)) session_.emplace(argc, argv);
#endif
  }

 private:
#if defined(COLLIDE_HAS_MPI)
  std::optional<collide::mpi_session> session_;
#endif
};

/// Calls f(ranks) on each of the ranks of that name, which `check_ranks` has passed, and before it take(rank), which
/// makes the device of a rank current.
template <class Take, class F>
void on_ranks(std::string const& name, Take const& take, F const& f) {
  if (int const n = threads_of(name)) {
    return collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
      take(ranks.rank());
      f(any_ranks(ranks));
    });
  }
#if defined(COLLIDE_HAS_MPI)
  collide::mpi_ranks const processes;
  take(processes.rank());
#if defined(COLLIDE_HAS_NCCL)
  if (name == "nccl") return f(any_ranks(collide::nccl_ranks(processes)));
#endif
  f(any_ranks(processes));
#endif
}

}  // namespace io

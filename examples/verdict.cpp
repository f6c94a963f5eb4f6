/// \file
/// Says of each pair of a triangle and a sphere in a file (CSV) whether they touch, and compares that with what the
/// file says.

#include <iomanip>
#include <map>

#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/spaces/upload.hpp>

#include "io/cases.hpp"
#include "io/device.hpp"
#include "io/output.hpp"
#include "io/program.hpp"
#include "io/text.hpp"

namespace verdict {

/// Kernel functor of `for_each` over cases.
template <class Precision, class S>
struct judge {
  collide::mesh_view<S> triangles;
  collide::sphere_view<S> spheres;
  unsigned char* hits;

  COLLIDE_HD void operator()(std::size_t i) const {
    hits[i] = collide::karabassi<Precision>::intersects(triangles[i], spheres[i]);
  }
};

/// The same for spheres that may move.
template <class Precision, class S>
struct judge_swept {
  collide::mesh_view<S> triangles;
  collide::sphere_view<S> spheres;
  S const* displacements;  ///< three numbers each
  unsigned char* hits;

  COLLIDE_HD void operator()(std::size_t i) const {
    S const* const d = displacements + 3 * i;
    collide::moving_sphere<S> const moving{spheres[i], {d[0], d[1], d[2]}};
    hits[i] = collide::karabassi_swept<Precision>::intersects(triangles[i], moving);
  }
};

struct options {
  std::string cases, output;
  std::string precision = "exact", scalar, space = "host";
};

/// A row of the table that is printed.
struct tally {
  std::size_t rows = 0, hits = 0, false_hits = 0, misses = 0;

  std::size_t differ() const { return false_hits + misses; }

  void add(tally const& other) {
    rows += other.rows;
    hits += other.hits;
    false_hits += other.false_hits;
    misses += other.misses;
  }
};

/// The verdicts, 0 or 1, found in the space.
template <class Precision, class Space, class S>
std::vector<unsigned char> decide(io::case_data<S> const& cases) {
  using device = io::device_of<Space>;
  auto const space = device::make(0, device::memory());
  std::size_t const n = cases.size();
  auto const triangles = upload(space, collide::triangle_soup(cases.corners.data(), n));
  auto const spheres = upload(space, collide::spheres_xyzr(cases.spheres.data(), n));
  collide::buffer<unsigned char> found;
  unsigned char* const hits = found.reserve(space.resource(), n);
  collide::buffer<S> ways;
  if (cases.swept == 0) {
    space.for_each(n, judge<Precision, S>{triangles.view(), spheres.view(), hits});
  } else if constexpr (!std::is_same<Precision, collide::baseline>::value) {
    S* const displacements = ways.reserve(space.resource(), 3 * n);
    space.copy_from_host(displacements, cases.displacements.data(), 3 * n);
    space.for_each(n, judge_swept<Precision, S>{triangles.view(), spheres.view(), displacements, hits});
  }
  std::vector<unsigned char> verdicts(n);
  space.copy_to_host(verdicts.data(), hits, n);
  return verdicts;
}

void write(std::string const& path, std::vector<std::string> const& ids, std::vector<unsigned char> const& hits) {
  io::output_file out(path);
  out << "id,hit\n";
  for (std::size_t i = 0; i < ids.size(); ++i) out << ids[i] << (hits[i] != 0 ? ",1\n" : ",0\n");
  out.commit();
}

/// Prints rows and hits by family, and what differs from the file if that tells the verdicts.
template <class S>
void print_table(io::case_data<S> const& cases, std::vector<unsigned char> const& hits) {
  std::map<std::string, tally> families;
  std::size_t width = std::string_view("family").size();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    bool const differs = cases.has_hits && hits[i] != cases.hits[i];
    auto const family = io::one_line(cases.families[i]);
    width = std::max(width, family.size());
    families[family].add({1, hits[i], differs && hits[i] != 0, differs && hits[i] == 0});
  }
  auto const line = [&](std::string const& family, auto const& rows, auto const& found, auto const& differ,
                        auto const& false_hits, auto const& misses) {
    std::cout << std::left << std::setw(static_cast<int>(width)) << family << std::right << std::setw(10) << rows
              << std::setw(10) << found;
    if (cases.has_hits) {
      std::cout << std::setw(10) << differ << std::setw(12) << false_hits << std::setw(10) << misses;
    }
    std::cout << "\n";
  };
  auto const numbers = [&](std::string const& family, tally const& t) {
    line(family, t.rows, t.hits, t.differ(), t.false_hits, t.misses);
  };
  tally total;
  line("family", "rows", "hits", "differ", "false hits", "misses");
  for (auto const& [family, t] : families) {
    numbers(family, t);
    total.add(t);
  }
  numbers("total", total);
  if (cases.has_hits) std::cout << total.differ() << " of " << total.rows << " verdicts differ from the column hit\n";
}

template <class Precision, class Space, class S>
void run(options const& wish, io::case_data<S> const& cases, std::string const& roundings) {
  if (cases.swept > 0 && std::is_same<Precision, collide::baseline>::value) {
    throw io::data_error(wish.cases, "swept cases, with dx, dy, dz, have no baseline: choose another --precision");
  }
  auto const hits = decide<Precision, Space>(cases);
  if (!wish.output.empty()) write(wish.output, cases.ids, hits);
  if (wish.output.empty() || !io::output_file::is_standard_output(wish.output)) {
    print_table(cases, hits);
    std::cout << wish.precision << " precision, " << wish.scalar << " coordinates, " << wish.space << " ("
              << io::device_of<Space>::name() << ")\n";
    if (cases.tally.rounded == 0) std::cout << roundings << "\n";
  }
  if (cases.tally.rounded > 0) {
    std::cerr << "verdict: " << wish.cases << ": " << roundings << "; the verdicts are those of the rounded numbers\n";
  }
}

/// Reads the cases as the scalar type that the options name, or chooses one.
auto read(options& wish) {
  io::text_file const file(wish.cases);
  return io::read_as(wish.scalar,
                     [&](auto scalar) { return io::read_cases<decltype(scalar)>(wish.cases, file.view()); });
}

/// Runs what the options name.
void run(options& wish) {
  using io::choose, io::named;
  if (wish.scalar.empty() && wish.precision == "double") wish.scalar = "double";
  io::choose_space(wish.space, [&](auto space) {
    using space_type = typename decltype(space)::type;
    io::device_of<space_type>::require();
    auto const input = read(wish);
    std::visit(
        [&](auto const& cases) {
          choose(
              wish.precision,
              [&](auto precision) {
                run<typename decltype(precision)::type, space_type>(wish, cases, input.roundings);
              },
              named<collide::baseline>{"baseline"}, named<collide::single_precision>{"single"},
              named<collide::double_precision>{"double"}, named<collide::exact>{"exact"});
        },
        input.data);
  });
}

}  // namespace verdict

int main(int argc, char** argv) {
  verdict::options wish;
  CLI::App app("Says of each pair of a triangle and a sphere in a file whether they touch.", "verdict");
  app.add_option("cases", wish.cases,
                 "the pairs, a CSV file with columns id, family, ax, ay, az, bx, .. cz, px, py, pz, R and perhaps hit")
      ->required()
      ->type_name("FILE");
  app.add_option("--output,output", wish.output, "verdicts (CSV): id and hit, in the order of the file")
      ->type_name("FILE");
  io::add_choice(app, "--precision", wish.precision, {"baseline", "single", "double", "exact"},
                 "how sure a verdict is");
  io::add_choice(app, "--scalar", wish.scalar, {"float", "double"},
                 "type that the numbers are read as; double if not given with --precision double or where float is too "
                 "coarse, else float");
  io::add_choice(app, "--space", wish.space, {"host", "cuda", "cuda_shared"}, "execution space");
  return io::run_program(app, {argv + 1, argv + argc}, [&] {
    io::check_outputs({{"CASES", wish.cases}}, {{"--output", wish.output}});
    verdict::run(wish);
  });
}

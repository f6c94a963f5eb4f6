#include "scenes.hpp"

#include <cmath>
#include <fstream>
#include <stdexcept>

namespace tests {

template <class S>
scene<S> lattice_scene(unsigned seed, int triangles, int spheres, int half) {
  dice roll(seed);
  scene<S> made;
  for (int i = 0; i < triangles; ++i) {
    int const axis = roll.integer(0, 2), leg = 1 << roll.integer(0, 2);
    int const u = roll.integer(0, 1) ? leg : -leg, v = roll.integer(0, 1) ? leg : -leg;
    int const at[3] = {roll.integer(-half, half), roll.integer(-half, half), roll.integer(-half, half)};
    auto const corner = [&](int along_first, int along_second) {
      int p[3] = {at[0], at[1], at[2]};
      p[(axis + 1) % 3] += along_first;
      p[(axis + 2) % 3] += along_second;
      return oracle::point{double(p[0]), double(p[1]), double(p[2])};
    };
    made.mesh.add({corner(0, 0), corner(u, 0), corner(0, v)});
  }
  for (int i = 0; i < spheres; ++i) {
    auto const place = [&] { return roll.integer(-2 * half, 2 * half) / 2.0; };
    double const x = place(), y = place(), z = place();
    made.spheres.add({x, y, z}, roll.integer(0, 4) / 2.0);
  }
  return made;
}

template <class S>
mesh<S> unit_cube() {
  mesh<S> cube;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) cube.vertices.push_back(static_cast<S>(i >> axis & 1));
  cube.corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return cube;
}

template <class S>
mesh<S> read_off(std::string const& name) {
  std::ifstream file(TEST_DATA_DIR "/" + name);
  std::string word;
  std::size_t vertices = 0, faces = 0;
  file >> word >> vertices >> faces >> word;
  mesh<S> m;
  m.vertices.resize(3 * vertices);
  m.corners.resize(3 * faces);
  for (auto& x : m.vertices) file >> x;
  for (std::size_t i = 0; i < 3 * faces; ++i) {
    if (i % 3 == 0) file >> word;
    file >> m.corners[i];
  }
  if (!file || faces == 0) throw std::runtime_error(name + ": cannot read it");
  return m;
}

template <class S>
spheres<S> spheres_near(mesh<S> const& m, unsigned seed, int n, double reach, double radius) {
  dice roll(seed);
  spheres<S> made;
  for (int i = 0; i < n; ++i) {
    auto const vertex = static_cast<std::size_t>(roll.integer(0, static_cast<int>(m.vertices.size() / 3) - 1));
    made.add(m.vertex(vertex) + roll.in_cube(reach), radius);
  }
  return made;
}

template scene<float> lattice_scene(unsigned, int, int, int);
template mesh<float> unit_cube();
template mesh<float> read_off(std::string const&);
template spheres<float> spheres_near(mesh<float> const&, unsigned, int, double, double);
template scene<double> lattice_scene(unsigned, int, int, int);
template mesh<double> unit_cube();
template mesh<double> read_off(std::string const&);
template spheres<double> spheres_near(mesh<double> const&, unsigned, int, double, double);

}  // namespace tests

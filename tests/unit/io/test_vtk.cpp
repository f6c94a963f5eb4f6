/// Files for ParaView, read back by a reader that knows VTK's format and nothing of the library's.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/effects/absorb.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/io/vtk.hpp>
#include <collide/io/vtk_simulation.hpp>
#include <collide/sinks/contacts.hpp>

namespace {

/// A file that is gone after the test.
struct temporary {
  std::string path = "collide-test-vtk-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".vtp";
  ~temporary() { std::remove(path.c_str()); }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(path, std::ios::binary).rdbuf();
    return all.str();
  }
};

std::string attribute(std::string const& tag, std::string const& name) {
  auto const at = tag.find(" " + name + "=\"");
  REQUIRE(at != tag.npos);
  auto const first = at + name.size() + 3;
  return tag.substr(first, tag.find('"', first) - first);
}

/// The numbers of an array of the file, as doubles.
std::vector<double> numbers(std::string const& text, std::string const& name) {
  auto const begin = text.find("Name=\"" + name + "\"");
  REQUIRE(begin != text.npos);
  auto const open = text.rfind('<', begin);
  std::string const tag = text.substr(open, text.find("/>", open) - open);
  auto const data = text.find('_', text.find("<AppendedData")) + 1 + std::stoul(attribute(tag, "offset"));
  std::uint64_t size = 0;
  std::memcpy(&size, &text[data], sizeof size);
  std::string const type = attribute(tag, "type");
  std::vector<double> found;
  auto const read = [&](auto value) {
    for (std::size_t i = 0; i < size; i += sizeof value) {
      std::memcpy(&value, &text[data + sizeof size + i], sizeof value);
      found.push_back(static_cast<double>(value));
    }
  };
  if (type == "Float32") read(float{});
  if (type == "Float64") read(double{});
  if (type == "UInt32") read(std::uint32_t{});
  if (type == "UInt8") read(std::uint8_t{});
  return found;
}

using collide::host;

TEST_CASE("vtk: contacts of a query are a point each") {
  std::vector<double> const vertices{0, 0, 0, 1, 0, 0, 0, 1, 0}, centres{0.25, 0.25, 0.5, 9, 9, 9, 0.25, 0.25, -0.25};
  std::vector<std::uint32_t> const corners{0, 1, 2};
  collide::detector<collide::bucket, collide::karabassi<>, host, double> detector;
  auto const mesh = collide::indexed_mesh(vertices.data(), 3, corners.data(), 1);
  detector.build(mesh);
  collide::contacts<double> found(collide::order::canonical);
  detector.query(collide::spheres_xyz(centres.data(), 3, 0.6), found);

  temporary file;
  collide::write_vtk_contacts(file.path, found.to_host());
  std::string const text = file.text();
  CHECK(attribute(text, "NumberOfPoints") == "2");
  CHECK(numbers(text, "position") == std::vector<double>{0.25, 0.25, 0, 0.25, 0.25, 0});
  CHECK(numbers(text, "normal") == std::vector<double>{0, 0, 1, 0, 0, -1});
  CHECK(numbers(text, "sphere") == std::vector<double>{0, 2});
  CHECK(numbers(text, "triangle") == std::vector<double>{0, 0});
  CHECK(numbers(text, "depth")[1] == doctest::Approx(0.35));

  collide::write_vtk_mesh(file.path, mesh);
  CHECK(numbers(file.text(), "position") == vertices);
  CHECK(numbers(file.text(), "connectivity") == std::vector<double>{0, 1, 2});
  CHECK(numbers(file.text(), "offsets") == std::vector<double>{3});
  CHECK(file.text().find("CellData") == std::string::npos);
  collide::write_vtk_mesh(file.path, mesh, {{"pressure", std::vector<double>{7}}});
  CHECK(file.text().find("<CellData>\n<DataArray type=\"Float64\" Name=\"pressure\"") != std::string::npos);
  CHECK(numbers(file.text(), "pressure") == std::vector<double>{7});
  CHECK(numbers(file.text(), "connectivity") == std::vector<double>{0, 1, 2});
  collide::write_vtk_contacts(file.path, std::vector<collide::contact<float>>{});
  CHECK(attribute(file.text(), "NumberOfPoints") == "0");
}

TEST_CASE("vtk: particles that are there, and a line between each two that overlap") {
  using simulation = collide::simulation<collide::detector<collide::bucket>, collide::polydisperse,
                                         collide::sphere_contact, collide::absorb>;
  std::vector<float> const xyz{0, 0, 0, 1.5f, 0, 0, 0, 1.75f, 0, 1.5f, 1.5f, 9}, radii{1, 0.75f, 1, 1},
      velocities{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  collide::sphere_contact springs;
  springs.stiffness = 8;
  simulation of(host(1), collide::polydisperse{}, springs, collide::absorb{});
  of.set(collide::spheres_xyz(xyz.data(), 4, radii.data()), velocities.data());
  temporary file;
  collide::write_vtk_contacts(file.path, of);
  std::vector<double> lengths;
  auto overlaps = numbers(file.text(), "overlap"), forces = numbers(file.text(), "force");
  CHECK(attribute(file.text(), "NumberOfLines") == "2");
  std::sort(overlaps.begin(), overlaps.end());
  std::sort(forces.begin(), forces.end());
  CHECK(overlaps == std::vector<double>{0.25, 0.25, 0.25, 0.25});
  CHECK(forces == std::vector<double>{2, 2, 2, 2});

  std::vector<std::uint8_t> const there{1, 0, 1, 1};
  of.assign<collide::alive>(there);
  collide::write_vtk_particles(file.path, of);
  CHECK(numbers(file.text(), "radius") == std::vector<double>{1, 1, 1});
  CHECK(numbers(file.text(), "velocity") == std::vector<double>{1, 2, 3, 7, 8, 9, 10, 11, 12});
  CHECK(numbers(file.text(), "position") == std::vector<double>{0, 0, 0, 0, 1.75, 0, 1.5, 1.5, 9});
  collide::write_vtk_contacts(file.path, of);
  CHECK(attribute(file.text(), "NumberOfLines") == "1");
}

TEST_CASE("vtk: lines of granular contact have the force of Hertz' spring") {
  using law = collide::granular_contact<collide::hertz>;
  using simulation = collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, host, double>, law>;
  double const xyz[] = {0, 0, 0, 1.99, 0, 0}, young = 1e6, poisson = 0.25;
  simulation of(host(1), law{collide::one_material({young, poisson, 1000})});
  of.set(collide::spheres_xyz(xyz, 2, 1.0));
  temporary file;
  collide::write_vtk_contacts(file.path, of);
  double const effective = young / (2 * (1 - poisson * poisson));
  auto const forces = numbers(file.text(), "force");
  REQUIRE(forces.size() == 2);
  for (double const f : forces)
    CHECK(f == doctest::Approx(4.0 / 3 * effective * std::sqrt(0.5) * std::pow(0.01, 1.5)).epsilon(1e-12));
}

/// All pairs, one by one, with all images of one.
template <class Space>
void check_overlaps(Space const& space, int images, double largest) {
  std::vector<float> xyz, radii;
  std::uint32_t seed = 1;
  auto const next = [&] { return static_cast<float>((seed = seed * 1664525u + 1013904223u) >> 8) / 16777216; };
  for (int i = 0; i < 300; ++i) {
    for (int k = 0; k < 3; ++k) xyz.push_back(next());
    radii.push_back(i % 50 == 0 ? static_cast<float>(largest) : 0.05f * next());
  }
  std::vector<std::pair<std::size_t, std::size_t>> found, all;
  collide::detail::for_each_overlap(xyz, radii, space, [&](auto const& a, auto const& b, double overlap) {
    found.emplace_back(std::min(a.number, b.number), std::max(a.number, b.number));
    CHECK(overlap == doctest::Approx(double(radii[a.number]) + double(radii[b.number]) - (a.centre - b.centre).norm()));
  });
  for (std::size_t i = 0; i < radii.size(); ++i) {
    for (std::size_t k = i + 1; k < radii.size(); ++k) {
      for (int image = 0; image < images; ++image) {
        double square = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          int const lengths = (c == 0 ? image % 3 : c == 1 ? image / 3 % 3 : image / 9) - (images > 1 ? 1 : 0);
          double const d = double(xyz[3 * k + c]) - double(xyz[3 * i + c]) + lengths;
          square += d * d;
        }
        if (std::sqrt(square) < double(radii[i]) + double(radii[k])) all.emplace_back(i, k);
      }
    }
  }
  std::sort(found.begin(), found.end());
  CHECK(all.size() > 100);
  CHECK(found == all);
}

TEST_CASE("vtk: the overlaps of many spheres are those of all pairs") {
  check_overlaps(collide::detail::open_space(), 1, 0.3);
  check_overlaps(collide::detail::repeating_box<float>{{0, 0, 0}, {1, 1, 1}}, 27, 0.24);
}

TEST_CASE("vtk: a file that cannot be written is named") {
  std::vector<float> const vertices(9);
  CHECK_THROWS_WITH_AS(collide::write_vtk_mesh("/no/such/folder/a.vtp", collide::triangle_soup(vertices.data(), 1)),
                       "collide: /no/such/folder/a.vtp cannot be written", collide::error);
}

TEST_CASE("vtk: a film lists its files") {
  temporary file;
  collide::write_vtk_film(file.path, {{"a.vtp", 0.5}, {"b.vtp", 1, "m.vtp"}});
  CHECK(file.text().find("<DataSet timestep=\"0.5\" file=\"a.vtp\"/>") != std::string::npos);
  CHECK(file.text().find("<DataSet timestep=\"1\" part=\"1\" file=\"m.vtp\"/>") != std::string::npos);
}

}  // namespace

// Reads a mesh and writes what spheres touch of it, and what particles do on it, for ParaView: files MESH.obj FOLDER
#include <cstdio>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/io/obj.hpp>
#include <collide/io/vtk_simulation.hpp>
#include <collide/sinks/contacts.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  std::string const folder = std::string(argv[2]) + "/";
  auto const mesh = collide::read_obj(argv[1]);
  std::vector<float> const centres{0.25f, 0.25f, 0.05f, 0.75f, 0.75f, 0.2f, 0.25f, 0.25f, 0.22f};
  auto const spheres = collide::spheres_xyz(centres.data(), 3, 0.1f);

  collide::detector<collide::bucket> detector;
  detector.build(mesh.view());
  collide::contacts<float> contacts;
  detector.query(spheres, contacts);
  collide::write_vtk_contacts(folder + "contacts.vtp", contacts.to_host());

  collide::simulation<collide::detector<collide::bucket>, collide::sphere_contact, collide::gravity, collide::bounce>
      simulation;
  simulation.set_mesh(mesh.view());
  simulation.set(spheres);
  std::vector<collide::vtk_frame> frames;
  for (int i = 0; i < 3; ++i) {
    std::string const number = std::to_string(i) + ".vtp";
    collide::write_vtk_particles(folder + "particles" + number, simulation);
    collide::write_vtk_contacts(folder + "chains" + number, simulation);  // lines between particles that overlap
    frames.push_back({"particles" + number, simulation.time()});
    simulation.steps(100, 1e-4f);
  }
  collide::write_vtk_film(folder + "film.pvd", frames);
  std::printf("%zu triangles, %zu contacts, %zu frames\n", mesh.size(), contacts.size(), frames.size());
} catch (collide::error const& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}

/// \file
/// A particle code that has its own arrays and its own integrator, and asks collide for contacts alone: x, y, z and
/// velocities in separate arrays, a radius each. What a particle touches pushes it back with a spring.

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>

namespace {

/// The state of the code, as it was before collide came.
struct particle_arrays {
  std::vector<float> x, y, z, vx, vy, vz, radius;

  void add(float px, float py, float pz, float r) {
    x.push_back(px), y.push_back(py), z.push_back(pz), radius.push_back(r);
    vx.push_back(0), vy.push_back(0), vz.push_back(0);
  }
  std::size_t size() const { return x.size(); }
};

/// One step of the code: weight, positions.
void advance(particle_arrays& p, float dt) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    p.vz[i] -= 9.81f * dt;
    p.x[i] += p.vx[i] * dt;
    p.y[i] += p.vy[i] * dt;
    p.z[i] += p.vz[i] * dt;
  }
}

/// The springs: force per mass and depth, and damping. A particle on an edge touches both triangles, and two contacts
/// at one point are one: only the deepest of a particle counts here. Contacts are in the order of the particles.
void push_back(particle_arrays& p, std::vector<collide::contact<float>> const& contacts, float dt) {
  constexpr float stiffness = 4e4f, damping = 200;
  for (std::size_t c = 0; c < contacts.size();) {
    std::size_t deepest = c;
    collide::id const i = contacts[c].sphere;
    for (; c < contacts.size() && contacts[c].sphere == i; ++c)
      if (contacts[c].depth > contacts[deepest].depth) deepest = c;
    auto const& n = contacts[deepest].normal;
    float const along = p.vx[i] * n.x() + p.vy[i] * n.y() + p.vz[i] * n.z();
    float const push = std::fmax(stiffness * contacts[deepest].depth - damping * along, 0.0f) * dt;
    p.vx[i] += push * n.x();
    p.vy[i] += push * n.y();
    p.vz[i] += push * n.z();
  }
}

}  // namespace

int main() {
  float const vertices[] = {-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0};  // the floor
  int const triangles[] = {0, 1, 2, 0, 2, 3};
  particle_arrays particles;
  for (int i = 0; i < 1000; ++i) {
    float const column = static_cast<float>(i % 10), row = static_cast<float>(i / 10 % 10);
    particles.add(0.4f * column - 1.8f, 0.4f * row - 1.8f, 0.5f + 0.1f * static_cast<float>(i / 100),
                  i % 2 == 0 ? 0.05f : 0.1f);
  }

  collide::detector<collide::bucket> detector;
  detector.build(collide::indexed_mesh(vertices, 4, triangles, 2), 0.1f);  // the mesh rests, so this is done once
  collide::contacts<float> contacts(collide::order::canonical);
  constexpr float dt = 1e-3f;
  for (int step = 0; step < 2000; ++step) {
    advance(particles, dt);
    auto const spheres = collide::spheres_soa(particles.x.data(), particles.y.data(), particles.z.data(),
                                              particles.size(), particles.radius.data());
    push_back(particles, detector.query(spheres, contacts).to_host(), dt);
  }

  int resting = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    bool const lies = std::fabs(particles.z[i] - particles.radius[i]) < 1e-3f && std::fabs(particles.vz[i]) < 0.02f;
    resting += lies ? 1 : 0;
  }
  std::printf("%d of %zu particles rest on the floor\n", resting, particles.size());
}

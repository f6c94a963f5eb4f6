/// Any text as an OBJ file: it is read or refused, what is read makes sense, and reads the same once written.
#include "examples/io/obj.hpp"
#include "text.hpp"

namespace {

using fuzz::require;

template <class S>
void check(io::mesh_data<S> const& mesh) {
  require(mesh.vertices.size() % 3 == 0 && mesh.corners.size() % 3 == 0, "three numbers a vertex and a triangle");
  require(mesh.size() > 0, "a mesh has a triangle");
  require(fuzz::all_finite(mesh.vertices), "coordinates are finite");
  for (auto const corner : mesh.corners) require(corner < mesh.vertices.size() / 3, "corners are vertices");

  std::string again;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    again += (i % 3 == 0 ? "\nv " : " ") + fuzz::in_decimals(mesh.vertices[i]);
  }
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    again += (i % 3 == 0 ? "\nf " : " ") + std::to_string(std::uint64_t{mesh.corners[i]} + 1);
  }
  auto const same = io::read_obj<S>("again", again, true);
  require(same.remarks.empty(), "what is written is not odd");
  require(same.vertices == mesh.vertices && same.corners == mesh.corners, "what is written reads the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  auto const text = fuzz::text(data, size);
  auto const floats = fuzz::read_or_refuse([&] { return io::read_obj<float>("input", text, false); });
  auto const doubles = fuzz::read_or_refuse([&] { return io::read_obj<double>("input", text, false); });
  auto const strict = fuzz::read_or_refuse([&] { return io::read_obj<float>("input", text, true); });
  if (floats) check(*floats);
  if (doubles) check(*doubles);
  require(!floats || doubles, "doubles hold what floats hold");
  require(strict.has_value() == (floats && floats->remarks.empty()), "strict is to refuse what is remarked on");
  if (!floats) return 0;
  require(floats->size() == doubles->size(), "as many triangles, whatever the scalar type");
  require(floats->tally.numbers == floats->vertices.size(), "the tally is of the coordinates");
  fuzz::check_rounding(floats->vertices, doubles->vertices, floats->tally);
  return 0;
}

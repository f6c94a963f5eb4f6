/// \file
/// Looks at a glTF file before Assimp, which drops what is wrong without a word. Needs nlohmann/json.hpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <collide/io/detail/text.hpp>

namespace collide::detail {

/// A glTF 2 file, in text (.gltf) or binary (.glb). Members throw an error that names it.
class gltf_file {
 public:
  gltf_file(std::string const& path, std::string const& what) : what_{what}, content_{bytes_of_file(path, what)} {
    std::string_view text = content_;
    if (content_.compare(0, 4, "glTF") == 0) text = chunks();
    auto const not_too_deep = [this](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
      if (depth > 100) fail("its JSON is too deep");
      return true;
    };
    try {
      file_ = nlohmann::json::parse(text, not_too_deep);
    } catch (nlohmann::json::exception const&) {
      fail("its JSON is not complete");
    }
  }

  /// How many triangles its scene has.
  std::size_t triangles() const {
    try {
      if (file_.at("asset").at("version").get<std::string>().compare(0, 2, "2.") != 0) fail("only glTF 2 is read");
      for (auto const& name : file_.value("extensionsRequired", nlohmann::json::array())) {
        auto const required = name.get<std::string>();
        if (required.compare(0, 14, "KHR_materials_") != 0 && required.compare(0, 12, "KHR_texture_") != 0)
          fail("it requires an extension that is not read");
      }
      for (auto const& buffer : file_.at("buffers")) check_buffer(buffer);
      std::size_t n = 0, nodes_left = file_.at("nodes").size();
      for (auto const& node : at("scenes", whole(file_, "scene", 0)).at("nodes")) {
        n += triangles_of_node(node, nodes_left, 0);
      }
      return n;
    } catch (nlohmann::json::exception const& e) {
      fail(e.what());
    }
  }

 private:
  using json = nlohmann::json;

  [[noreturn]] void fail(std::string const& why) const { throw error(what_ + ": " + why); }

  /// The JSON of a binary file, whose lengths are those that it says.
  std::string_view chunks() {
    auto const number = [this](std::size_t at) -> std::size_t {
      if (at + 4 > content_.size()) fail("the file is shorter than its header says");
      return number_in_bytes<std::uint32_t>(content_, at, false);
    };
    if (number(8) != content_.size()) fail("the file is not as long as its header says");
    std::string_view const all = content_;
    std::size_t const length = number(12);
    if (number(16) != 0x4e4f534a || length > all.size() - 20)
      fail("its first chunk is no JSON of the length that it says");
    if (std::size_t const at = 20 + length; at < all.size()) {
      binary_ = number(at);
      if (number(at + 4) != 0x004e4942 || binary_ != all.size() - at - 8)
        fail("its second chunk is not as long as it says");
    }
    return all.substr(20, length);
  }

  /// A whole number of `object`, or `otherwise` if it has none of that name.
  std::size_t whole(json const& object, char const* name, std::size_t otherwise) const {
    auto const found = object.find(name);
    if (found == object.end()) return otherwise;
    if (!found->is_number_unsigned() || found->get<std::uint64_t>() > std::uint64_t{1} << 40)
      fail(std::string("a bad ") + name);
    return found->get<std::size_t>();
  }

  json const& at(char const* list, std::size_t i) const { return file_.at(list).at(i); }

  void check_buffer(json const& buffer) const {
    std::size_t const length = whole(buffer, "byteLength", 0);
    if (!buffer.contains("uri")) {
      if (length > binary_) fail("a buffer is shorter than its byteLength");
      return;
    }
    auto const uri = buffer.at("uri").get<std::string>();
    auto const comma = uri.find(";base64,");
    if (uri.compare(0, 5, "data:") != 0) return;  // another file, whose length Assimp compares
    std::string_view digits = std::string_view(uri).substr(comma == uri.npos ? uri.size() : comma + 8);
    while (!digits.empty() && digits.back() == '=') digits.remove_suffix(1);
    bool const good = std::all_of(digits.begin(), digits.end(), [](char c) {
      return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '/';
    });
    if (!good || digits.size() / 4 * 3 + (digits.size() % 4 * 3) / 4 < length)
      fail("a buffer is shorter than its byteLength");
  }

  /// The count of an accessor, all of whose bytes are in its buffer.
  /// \param components  how many numbers an item has
  std::size_t count_of(json const& accessor, std::size_t components) const {
    std::size_t const n = whole(accessor, "count", 0), type = whole(accessor, "componentType", 0);
    if (type < 5120 || type > 5126 || type == 5124) fail("numbers of no type");
    std::size_t const size = components * (type <= 5121 ? 1 : type <= 5123 ? 2 : 4);
    if (n == 0 || !accessor.contains("bufferView")) fail("an accessor without numbers");
    auto const& view = at("bufferViews", whole(accessor, "bufferView", 0));
    std::size_t const length = whole(view, "byteLength", 0), stride = whole(view, "byteStride", size);
    std::size_t const first = whole(accessor, "byteOffset", 0);
    if (n > length || stride < size || stride > 255 || first + (n - 1) * stride + size > length)
      fail("an accessor is longer than its bufferView");
    if (whole(view, "byteOffset", 0) + length > whole(at("buffers", whole(view, "buffer", 0)), "byteLength", 0))
      fail("a bufferView is longer than its buffer");
    return n;
  }

  std::size_t triangles_of_part(json const& part) const {
    auto const& positions = at("accessors", whole(part.at("attributes"), "POSITION", ~std::size_t{0}));
    if (whole(positions, "componentType", 0) != 5126 || positions.at("type") != "VEC3")
      fail("positions that are not three floats");
    std::size_t n = count_of(positions, 3);
    if (part.contains("indices")) {
      auto const& indices = at("accessors", whole(part, "indices", 0));
      n = count_of(indices, 1);
      if (auto const type = whole(indices, "componentType", 0); type % 2 == 0 || indices.at("type") != "SCALAR")
        fail("indices that are not whole numbers from 0 on");
    }
    std::size_t const mode = whole(part, "mode", 4);
    if (mode < 4) return 0;
    if (mode > 6 || n < 3 || (mode == 4 && n % 3 != 0)) fail("corners that are no triangles");
    return mode == 4 ? n / 3 : n - 2;
  }

  /// Triangles of a node and of its children. Each node is in one place.
  std::size_t triangles_of_node(json const& number, std::size_t& nodes_left, int depth) const {
    if (depth > 1000 || nodes_left-- == 0 || !number.is_number_unsigned()) fail("its nodes are no tree");
    auto const& node = at("nodes", number.get<std::size_t>());
    std::size_t n = 0;
    if (node.contains("mesh")) {
      for (auto const& part : at("meshes", whole(node, "mesh", 0)).at("primitives")) n += triangles_of_part(part);
    }
    if (node.contains("children")) {
      for (auto const& child : node.at("children")) n += triangles_of_node(child, nodes_left, depth + 1);
    }
    return n;
  }

  std::string what_, content_;
  std::size_t binary_ = 0;
  json file_;
};

}  // namespace collide::detail

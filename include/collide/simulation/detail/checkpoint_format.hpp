/// \file
/// How a checkpoint lies in a file: a head, blocks, and a checksum of all that is before it.
///
///     head      8 bytes "COLLIDE\n", 4 the version of the format, 4 the order of bytes
///     block     4 bytes length of the name, the name, 4 bytes of an element, 8 number of elements, the elements
///     checksum  8 bytes
///
/// Numbers are as they are in memory; a machine with another order of bytes is told by the head. A block is read where
/// it was written: its name says what is there, and what was expected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <collide/core/error.hpp>

namespace collide::detail {

inline constexpr char checkpoint_magic[] = {'C', 'O', 'L', 'L', 'I', 'D', 'E', '\n'};
inline constexpr std::uint32_t checkpoint_version = 1, checkpoint_byte_order = 0x01020304;

/// FNV-1a with 64 bits by G. Fowler, L. C. Noll and K.-P. Vo: any one byte that differs makes another sum.
class fnv1a {
 public:
  void add(void const* bytes, std::size_t n) {
    auto const* const b = static_cast<unsigned char const*>(bytes);
    for (std::size_t i = 0; i < n; ++i) sum_ = (sum_ ^ b[i]) * 0x100000001b3u;
  }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325u;
};

/// Writes a checkpoint, block by block. Throws `error` as soon as the stream does not take it.
class checkpoint_writer {
 public:
  /// `name` is that of the stream, for errors.
  checkpoint_writer(std::ostream& to, std::string name) : to_(to), name_(std::move(name)) {
    put(checkpoint_magic, sizeof checkpoint_magic);
    put(checkpoint_version);
    put(checkpoint_byte_order);
  }

  template <class T>
  void block(std::string const& name, T const* elements, std::size_t n) {
    block(name, elements, n, sizeof(T));
  }
  /// A block of `n` values, each of so many bytes.
  void block(std::string const& name, void const* elements, std::size_t n, std::size_t bytes) {
    put(static_cast<std::uint32_t>(name.size()));
    put(name.data(), name.size());
    put(static_cast<std::uint32_t>(bytes));
    put(static_cast<std::uint64_t>(n));
    put(elements, n * bytes);
  }
  template <class T>
  void value(std::string const& name, T const& one) {
    block(name, &one, 1);
  }
  void text(std::string const& name, std::string const& content) { block(name, content.data(), content.size()); }

  void finish() {
    std::uint64_t const sum = checksum_.sum();
    put(sum);
    to_.flush();
    check();
  }

 private:
  template <class T>
  void put(T const& number) {
    put(&number, sizeof number);
  }
  void put(void const* bytes, std::size_t n) {
    checksum_.add(bytes, n);
    to_.write(static_cast<char const*>(bytes), static_cast<std::streamsize>(n));
    check();
  }
  void check() const {
    if (!to_) throw error("collide: save: " + name_ + " does not take what is written: is it full?");
  }

  std::ostream& to_;
  std::string name_;
  fnv1a checksum_;
};

/// Reads what a `checkpoint_writer` has written, in the same order. Throws `error`, which names the block, where there
/// is something else. Takes no more memory than the stream has bytes, and one MiB.
class checkpoint_reader {
 public:
  explicit checkpoint_reader(std::istream& from) : from_(from) {
    char magic[sizeof checkpoint_magic] = {};
    get("head", magic, sizeof magic);
    if (std::memcmp(magic, checkpoint_magic, sizeof magic) != 0) refuse("head", "this is no checkpoint");
    auto const version = get<std::uint32_t>("version");
    if (get<std::uint32_t>("byte order") != checkpoint_byte_order) {
      refuse("byte order", "the file is of a machine with another order of bytes, or damaged");
    }
    if (version != checkpoint_version) {
      refuse("version",
             "the file has " + std::to_string(version) + ", this program reads " + std::to_string(checkpoint_version));
    }
  }

  /// The elements of the block that is next. `n`: how many there must be.
  template <class T>
  std::vector<T> block(std::string const& name, std::uint64_t n) {
    expect(name, n, sizeof(T));
    return elements<T>(name, n);
  }
  /// The elements of the next block as bytes: `n` of any type, each of so many bytes.
  std::vector<unsigned char> block(std::string const& name, std::uint64_t n, std::size_t bytes) {
    expect(name, n, bytes);
    return elements<unsigned char>(name, n * bytes);
  }
  template <class T>
  void value(std::string const& name, T& one) {
    one = block<T>(name, 1).front();
  }
  /// Refuses another content than this.
  void text(std::string const& name, std::string const& content) {
    auto const found = elements<char>(name, head(name, 1));
    std::string const there(found.begin(), found.end());
    if (there != content) refuse(name, "the file has " + there + ", the simulation " + content);
  }

  void finish() {
    std::uint64_t const sum = checksum_.sum();
    if (get<std::uint64_t>("checksum") != sum) refuse("checksum", "the file is damaged");
  }

  [[noreturn]] static void refuse(std::string const& name, std::string const& why) {
    throw error("collide: load: " + name + ": " + why);
  }

 private:
  void expect(std::string const& name, std::uint64_t n, std::size_t bytes) {
    std::uint64_t const found = head(name, bytes);
    if (found != n)
      refuse(name, "the file has " + std::to_string(found) + " numbers, expected are " + std::to_string(n));
  }

  std::uint64_t head(std::string const& name, std::size_t element) {
    std::string found(name.size(), ' ');
    bool const as_long = get<std::uint32_t>(name) == name.size();
    if (as_long) get(name, &found[0], found.size());
    if (!as_long || found != name) refuse(name, "the file has something else there, or is damaged");
    auto const bytes = get<std::uint32_t>(name);
    if (bytes != element) {
      refuse(name, "the file has numbers of " + std::to_string(bytes) + " bytes, the simulation of " +
                       std::to_string(element));
    }
    return get<std::uint64_t>(name);
  }

  /// A number that is damaged must not take all memory: there is no more than has been read.
  template <class T>
  std::vector<T> elements(std::string const& name, std::uint64_t n) {
    constexpr std::uint64_t at_a_time = (std::uint64_t{1} << 20) / sizeof(T);
    std::vector<T> read;
    while (read.size() < n) {
      std::size_t const before = read.size();
      std::uint64_t const left = n - before, more = left < at_a_time ? left : at_a_time;
      read.resize(before + static_cast<std::size_t>(more));
      get(name, read.data() + before, static_cast<std::size_t>(more) * sizeof(T));
    }
    return read;
  }

  template <class T>
  T get(std::string const& name) {
    T number{};
    get(name, &number, sizeof number);
    return number;
  }
  void get(std::string const& name, void* bytes, std::size_t n) {
    from_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(n));
    if (from_.gcount() != static_cast<std::streamsize>(n)) refuse(name, "the file ends there");
    checksum_.add(bytes, n);
  }

  std::istream& from_;
  fnv1a checksum_;
};

/// A file that is written with ".part" behind its name until it is complete: an older one stays until then, and the new
/// one has its permissions. Of a link it is the file that it leads to. What is no file, such as a pipe, is written as
/// it is.
class checkpoint_file {
 public:
  explicit checkpoint_file(std::string const& path) : path_(path), target_(end_of_links(path)) {
    std::error_code none;
    auto const old = std::filesystem::status(target_, none);
    bool const is_other = std::filesystem::exists(old) && !std::filesystem::is_regular_file(old);
    part_ = is_other ? target_ : target_ + ".part";
    file_.open(part_, std::ios::binary | std::ios::trunc);
    if (!file_) fail();
    if (std::filesystem::is_regular_file(old)) std::filesystem::permissions(part_, old.permissions(), none);
    if (none && std::filesystem::is_regular_file(old)) fail();
  }
  checkpoint_file(checkpoint_file const&) = delete;
  checkpoint_file& operator=(checkpoint_file const&) = delete;
  ~checkpoint_file() {
    if (!is_complete_ && part_ != target_) std::remove(part_.c_str());
  }

  std::ostream& stream() { return file_; }
  void complete() {
    file_.close();
    if (!file_ || (part_ != target_ && std::rename(part_.c_str(), target_.c_str()) != 0)) fail();
    is_complete_ = true;
  }

 private:
  [[noreturn]] void fail() const { throw error("collide: save: " + path_ + " cannot be written"); }

  static std::string end_of_links(std::filesystem::path path) {
    std::error_code none;
    for (int i = 0; i < 40 && std::filesystem::is_symlink(path, none); ++i) {
      path = path.parent_path() / std::filesystem::read_symlink(path, none);
    }
    return path.string();
  }

  std::string path_, target_, part_;
  std::ofstream file_;
  bool is_complete_ = false;
};

/// The result of read(stream) for a file, which has nothing else in it.
template <class Read>
auto read_checkpoint_file(std::string const& path, Read const& read) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw error("collide: load: " + path + " cannot be read");
  auto found = read(file);
  if (file.peek() != std::ifstream::traits_type::eof()) {
    throw error("collide: load: " + path + " goes on behind the checkpoint");
  }
  return found;
}

}  // namespace collide::detail

/// \file
/// Output files that are there in full or not at all.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "error.hpp"

namespace io {

/// Writes a file under a temporary name beside it, which `commit` changes into the wanted one. Without `commit` nothing
/// is left behind and an older file of that name stays as it was. A device, a pipe and the program's standard output
/// are written directly. Everything throws `data_error`.
class output_file {
 public:
  explicit output_file(std::string path) : path_{std::move(path)}, target_{path_} {
    struct stat about {};
    bool const exists = ::stat(path_.c_str(), &about) == 0;
    if (exists && is_standard_output(about)) {
      descriptor_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    } else if (exists && !S_ISREG(about.st_mode)) {
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
      if (exists) follow_links();
      temporary_ = target_ + ".part-" + std::to_string(::getpid());
      descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0) temporary_.clear();
      if (descriptor_ >= 0 && exists && ::fchmod(descriptor_, about.st_mode & 07777) != 0) fail();
    }
    if (descriptor_ < 0) fail();
    buffer_.reserve(capacity);
  }
  output_file(output_file const&) = delete;
  output_file& operator=(output_file const&) = delete;
  ~output_file() { abandon(); }

  /// True if `path` is where the program's standard output goes.
  static bool is_standard_output(std::string const& path) {
    struct stat about {};
    return ::stat(path.c_str(), &about) == 0 && is_standard_output(about);
  }

  /// Throws if a file of that name surely cannot be written: to know it before hours of work.
  static void check(std::string const& path) {
    struct stat about {};
    auto const slash = path.find_last_of('/');
    std::string const folder = slash == path.npos ? "." : path.substr(0, slash + 1);
    bool const exists = ::stat(path.c_str(), &about) == 0;
    if (exists && S_ISDIR(about.st_mode)) errno = EISDIR;
    if ((exists && S_ISDIR(about.st_mode)) || ::access(exists ? path.c_str() : folder.c_str(), W_OK) != 0) {
      throw data_error(path, std::strerror(errno));
    }
  }

  output_file& operator<<(std::string_view text) {
    ensure_capacity(text.size());
    buffer_.append(text);
    return *this;
  }

  /// A number as short as reads back the same.
  template <class T, class = std::enable_if_t<std::is_arithmetic<T>::value>>
  output_file& operator<<(T value) {
    char text[32];
    return *this << std::string_view(text, static_cast<std::size_t>(std::to_chars(text, text + 32, value).ptr - text));
  }

  /// The bytes of a number, for binary formats.
  template <class T>
  void raw(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    *this << std::string_view(bytes, sizeof(T));
  }

  /// Writes what is still to be written, and looks whether all of it arrived.
  void close() {
    flush();
    int const descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) fail();
  }

  /// Makes the file appear under its name.
  void commit() {
    if (descriptor_ >= 0) close();
    if (!temporary_.empty() && ::rename(temporary_.c_str(), target_.c_str()) != 0) fail();
    temporary_.clear();
  }

 private:
  static constexpr std::size_t capacity = std::size_t{1} << 18;

  static bool is_standard_output(struct stat const& about) {
    struct stat out {};
    return ::fstat(STDOUT_FILENO, &out) == 0 && !S_ISCHR(out.st_mode) && out.st_dev == about.st_dev &&
           out.st_ino == about.st_ino;
  }

  /// A link stays a link: what it points to is replaced.
  void follow_links() {
    if (char* const real = ::realpath(path_.c_str(), nullptr)) {
      target_ = real;
      ::free(real);
    }
  }

  void ensure_capacity(std::size_t size) {
    if (buffer_.size() + size > capacity) flush();
  }

  void flush() {
    for (std::string_view left = buffer_; !left.empty();) {
      auto const n = ::write(descriptor_, left.data(), left.size());
      if (n >= 0) {
        left.remove_prefix(static_cast<std::size_t>(n));
      } else if (errno != EINTR) {
        fail();
      }
    }
    buffer_.clear();
  }

  void abandon() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
  }

  [[noreturn]] void fail() {
    data_error const error(path_, std::strerror(errno));
    abandon();
    descriptor_ = -1;
    temporary_.clear();
    throw error;
  }

  std::string path_;
  std::string target_;
  std::string temporary_;
  int descriptor_ = -1;
  std::string buffer_;
};

/// A file by the name that the command line has for it, such as `--output`; the path is empty if it is not wanted.
struct named_file {
  std::string name;
  std::string path;
};

/// Throws, before any work is done, if an output is also another file of the program or surely cannot be written.
inline void check_outputs(std::vector<named_file> others, std::vector<named_file> const& outputs) {
  for (auto const& out : outputs) {
    if (out.path.empty()) continue;
    for (auto const& other : others) {
      std::error_code none;
      bool const same = out.path == other.path || std::filesystem::equivalent(out.path, other.path, none);
      if (same && !(std::filesystem::exists(out.path, none) && !std::filesystem::is_regular_file(out.path, none))) {
        throw usage_error(out.name + ": " + out.path + " is also " + other.name);
      }
    }
    others.push_back(out);
    output_file::check(out.path);
  }
}

}  // namespace io

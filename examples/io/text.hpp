/// \file
/// A whole input file as text, mapped into memory where the system can do that.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "error.hpp"

namespace io {

/// The bytes of a file: mapped if it is a regular one, read if it is a pipe or a device.
class text_file {
 public:
  /// Throws `data_error` if the file cannot be read or is empty.
  explicit text_file(std::string const& path) : descriptor_{::open(path.c_str(), O_RDONLY | O_CLOEXEC)} {
    struct stat about {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &about) != 0) fail(path);
    if (S_ISREG(about.st_mode) && about.st_size > 0) {
      size_ = static_cast<std::size_t>(about.st_size);
      mapping_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor_, 0);
      if (mapping_ == MAP_FAILED) fail(path);
      ::madvise(mapping_, size_, MADV_SEQUENTIAL);
      ::madvise(mapping_, size_, MADV_WILLNEED);
    } else {
      read_all(path);
    }
    if (view().empty()) {
      close();
      throw data_error(path, "the file is empty");
    }
  }
  text_file(text_file const&) = delete;
  text_file& operator=(text_file const&) = delete;
  ~text_file() { close(); }

  /// The text, without the byte order mark that some programs write in front of it.
  std::string_view view() const {
    auto text = size_ > 0 ? std::string_view(static_cast<char const*>(mapping_), size_) : std::string_view(content_);
    if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
    return text;
  }

 private:
  void read_all(std::string const& path) {
    char part[1 << 16];
    while (auto const n = ::read(descriptor_, part, sizeof part)) {
      if (n > 0) {
        content_.append(part, static_cast<std::size_t>(n));
      } else if (errno != EINTR) {
        fail(path);
      }
    }
  }

  [[noreturn]] void fail(std::string const& path) {
    std::string const why = std::strerror(errno);
    if (mapping_ == MAP_FAILED) size_ = 0;
    close();
    throw data_error(path, why);
  }

  void close() {
    if (size_ > 0) ::munmap(mapping_, size_);
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  int descriptor_;
  void* mapping_ = nullptr;
  std::size_t size_ = 0;
  std::string content_;
};

}  // namespace io

#include "apps/files/text_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <boost/interprocess/mapped_region.hpp>
#include <cerrno>
#include <iostream>
#include <iterator>
#include <system_error>

#include "apps/process/exit_codes.hpp"
#include "ipc/memory/descriptor.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {

namespace bip = boost::interprocess;

namespace {

/// Passes a descriptor to boost::interprocess::mapped_region.
struct DescriptorMapping {
  int descriptor;
  [[nodiscard]] bip::mapping_handle_t get_mapping_handle() const {
    return bip::ipcdetail::mapping_handle_from_file_handle(descriptor);
  }
};

}  // namespace

struct TextFile::Storage {
  std::string read;
  bip::mapped_region mapped;
};

TextFile::TextFile(const std::string& path)
    : name_(path == "-" ? "<stdin>" : ipc::printable(path)), storage_(std::make_unique<Storage>()) {
  if (path == "-") {
    storage_->read.assign(std::istreambuf_iterator<char>(std::cin), {});
    text_ = storage_->read;
    return;
  }
  // Check the open descriptor, so that the file that is checked is the file that is read.
  const auto file = ipc::OwnedDescriptor::open(path, O_RDONLY);
  struct stat status {};
  if (file.get() < 0 || fstat(file.get(), &status) != 0) refuse(errno);
  if (S_ISDIR(status.st_mode)) throw InputError(fmt::format("{}: is a directory", name_));
  if (!S_ISREG(status.st_mode)) {  // a pipe: read to its end
    storage_->read = read_to_end(file.get());
    text_ = storage_->read;
    return;
  }
  if (status.st_size == 0) return;  // an empty file cannot be mapped
  try {
    storage_->mapped = bip::mapped_region(DescriptorMapping{file.get()}, bip::read_only);
  } catch (const bip::interprocess_exception& refused) {
    throw InputError(fmt::format("{}: cannot be read: {}", name_, refused.what()));
  }
  text_ = {static_cast<const char*>(storage_->mapped.get_address()), storage_->mapped.get_size()};
}

void TextFile::refuse(int error) const {
  if (error == ENOENT || error == ENOTDIR) {
    throw InputError(fmt::format("{}: no such file", name_));
  }
  throw InputError(
      fmt::format("{}: cannot be read: {}", name_, std::generic_category().message(error)));
}

std::string TextFile::read_to_end(int descriptor) const {
  std::string text;
  std::array<char, 65536> block{};
  for (;;) {
    const ssize_t bytes = read(descriptor, block.data(), block.size());
    if (bytes == 0) return text;
    if (bytes < 0 && errno != EINTR) refuse(errno);
    if (bytes > 0) text.append(block.data(), static_cast<std::size_t>(bytes));
  }
}

TextFile::TextFile(TextFile&&) noexcept = default;
TextFile& TextFile::operator=(TextFile&&) noexcept = default;
TextFile::~TextFile() = default;

}  // namespace splinecast::apps

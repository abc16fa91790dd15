#include "support/text_file.hpp"

#include <fmt/format.h>

#include <boost/interprocess/file_mapping.hpp>
#include <boost/interprocess/mapped_region.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <system_error>

#include "support/exit_codes.hpp"

namespace splinecast::apps {

namespace bip = boost::interprocess;

struct TextFile::Storage {
  std::string read;
  bip::mapped_region mapped;
};

TextFile::TextFile(const std::string& path)
    : name_(path == "-" ? "<stdin>" : path), storage_(std::make_unique<Storage>()) {
  if (path == "-") {
    storage_->read.assign(std::istreambuf_iterator<char>(std::cin), {});
    text_ = storage_->read;
    return;
  }
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(fmt::format("{}: no such file", path));
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(fmt::format("{}: is a folder", path));
  }
  if (!std::filesystem::is_regular_file(status)) {  // a pipe: read to its end
    std::ifstream pipe(path);
    storage_->read.assign(std::istreambuf_iterator<char>(pipe), {});
    text_ = storage_->read;
    return;
  }
  if (std::filesystem::file_size(path, error) == 0) return;  // nothing can be mapped
  try {
    const bip::file_mapping file(path.c_str(), bip::read_only);
    storage_->mapped = bip::mapped_region(file, bip::read_only);
  } catch (const bip::interprocess_exception& refused) {
    throw InputError(fmt::format("{}: cannot be read: {}", path, refused.what()));
  }
  text_ = {static_cast<const char*>(storage_->mapped.get_address()), storage_->mapped.get_size()};
}

TextFile::TextFile(TextFile&&) noexcept = default;
TextFile& TextFile::operator=(TextFile&&) noexcept = default;
TextFile::~TextFile() = default;

}  // namespace splinecast::apps

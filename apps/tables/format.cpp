#include "apps/tables/format.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/tables/text_rows.hpp"

namespace splinecast::apps {
namespace {

/// The first format of the list. Constant-initialised: valid before any format is constructed.
constinit const InputFormat* first_format = nullptr;

}  // namespace

InputFormat::InputFormat(int place, Fits fits, Open opens) noexcept
    : place_(place), fits_(fits), open_(opens), next_(first_format) {
  first_format = this;
}

std::unique_ptr<RowReader> InputFormat::open(InputFile file, const TableOptions& options) {
  std::array<char, 4096> bytes{};
  const std::string_view read(bytes.data(), file.read(0, bytes));
  FileBeginning beginning{.name = file.name(), .bytes = read};
  beginning.is_text = read.find('\0') == std::string_view::npos;
  if (beginning.is_text) {
    LineReader lines(file);
    read_beginning(lines, beginning);
  }
  const InputFormat* found = nullptr;
  for (const InputFormat* format = first_format; format != nullptr; format = format->next_) {
    const bool is_before = found == nullptr || format->place_ < found->place_;
    if (is_before && format->fits_(beginning)) found = format;
  }
  if (found == nullptr) {
    throw InputError(fmt::format("{}: is neither a text nor of another known format", file.name()));
  }
  return found->open_(std::move(file), options);
}

void RowReader::skip(std::size_t rows) {
  Row row;
  for (; rows > 0; --rows) {
    try {
      if (!next(row)) return;
    } catch (const InputError&) {
      if (row.number == 0) throw;
    }
  }
}

std::unique_ptr<RowReader> open_rows(const std::string& path, const TableOptions& options) {
  return InputFormat::open(InputFile(path), options);
}

}  // namespace splinecast::apps

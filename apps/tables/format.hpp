#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/files/input_file.hpp"
#include "apps/tables/options.hpp"
#include "apps/tables/rows.hpp"

/// The file formats of rows.
namespace splinecast::apps {

/// What the beginning of a file shows.
struct FileBeginning {
  const std::string& name;  ///< of the file, for messages
  std::string_view bytes;   ///< the first ones, at most 4 KiB
  bool is_text = false;     ///< whether `bytes` has no NUL; else the other members are empty
  std::vector<std::string> comments{};  ///< before the first line, in order, without `#`; the last
                                        ///< 1,000
  std::string first{};           ///< first line that is neither blank nor a comment, or empty
  std::size_t first_number = 0;  ///< its number, from 1; 0: there is none
};

/// A file format. A constant of this type registers itself in the program's list before `main`
/// starts, so that a format is one source file, which no other file mentions. It must exist as long
/// as the program runs.
class InputFormat {
 public:
  /// Whether a file with this beginning has this format.
  using Fits = bool (*)(const FileBeginning& beginning);
  /// Opens a file of this format. Throws InputError if its rows cannot be read.
  using Open = std::unique_ptr<RowReader> (*)(InputFile file, const TableOptions& options);

  /// Formats are tried in the order of their places. Each has a unique place below kLastPlace.
  InputFormat(int place, Fits fits, Open opens) noexcept;
  static constexpr int kLastPlace = 100;  ///< of CSV, which accepts every text

  /// Opens a file in the first format that fits. Throws InputError if none does, and as `Open`.
  [[nodiscard]] static std::unique_ptr<RowReader> open(InputFile file, const TableOptions& options);

 private:
  int place_;
  Fits fits_;
  Open open_;
  const InputFormat* next_;  ///< in the list
};

}  // namespace splinecast::apps

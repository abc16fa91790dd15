#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace splinecast::ipc {

/// The folder in which Linux keeps POSIX shared memory.
inline constexpr std::string_view kSharedMemoryFolder = "/dev/shm/";

/// The regions, each written by one process. A stream has the first two.
enum class RegionKind : std::uint64_t {
  waypoints = 1,  ///< written by the producer
  spline = 2,     ///< written by the solver
  commander = 3,  ///< the latest request of a commander of a time law, written by it
  stopper = 4,    ///< the latest request of a stopper of a stream, written by it
};

/// `producer`, `solver`, `commander` or `stopper`: the role that writes a region of this kind.
[[nodiscard]] std::string_view owner_role(RegionKind kind) noexcept;

/// Whether a text can name a stream: see require_stream_name().
[[nodiscard]] bool is_stream_name(std::string_view text) noexcept;

/// Throws BadRequest unless the name has 1 to 128 characters of A–Z a–z 0–9 . _ - and does not
/// begin with a dot.
void require_stream_name(std::string_view stream);

/// Escapes an untrusted text, such as a file name, for a terminal or a log: each byte of control
/// characters, line ends, escape sequences and invalid UTF-8 becomes `\xNN`.
[[nodiscard]] std::string printable(std::string_view text);

/// The name under which the region of a commander of a time law is kept: `LAW@COMMANDER`, which no
/// stream can have. Throws BadRequest unless both can name a stream.
[[nodiscard]] std::string commander_stream(std::string_view law, std::string_view commander);

/// The same for a stopper of a stream: `STREAM!STOPPER`.
[[nodiscard]] std::string stopper_stream(std::string_view stream, std::string_view stopper);

/// The file of a region, or of its owner's lock. `stream` is a stream's name or a result of
/// commander_stream() or stopper_stream(); it refers to the file name.
struct RegionFileName {
  std::string_view stream;
  RegionKind kind;
  bool is_lock;
};

/// What a file of this name is; nothing for other files.
[[nodiscard]] std::optional<RegionFileName> region_in(std::string_view file) noexcept;

/// The law and the commander in a result of commander_stream(), or the stream and the stopper in
/// one of stopper_stream(); a stream's own name and nothing else.
[[nodiscard]] std::pair<std::string_view, std::string_view> split_requester(
    std::string_view stream) noexcept;

/// Calls `take` for each file of a region or lock in the folder of shared memory. Throws
/// OutOfResources if the folder cannot be read.
void for_each_region(const std::function<void(const RegionFileName& region)>& take);

/// The names of a time law's commanders, or of a stream's stoppers, that have a region of that
/// kind, in alphabetical order. Reads the folder of shared memory. Throws BadRequest for an invalid
/// name, OutOfResources if the folder cannot be read.
[[nodiscard]] std::vector<std::string> requester_names(std::string_view of, RegionKind kind);

/// Name of a region as shared memory: `splinecast.<stream>.waypoints`, `….spline`, of the result
/// of commander_stream() `….commander`, of that of stopper_stream() `….stopper`.
[[nodiscard]] std::string region_name(std::string_view stream, RegionKind kind);

/// Path of a region, and of its owner's lock file.
[[nodiscard]] std::string region_path(std::string_view stream, RegionKind kind);
[[nodiscard]] std::string lock_path(std::string_view stream, RegionKind kind);

/// Whether a text is a pattern of stream names rather than a name: `*`, `?` and `[…]` as in a
/// shell.
[[nodiscard]] bool is_pattern(std::string_view text) noexcept;

/// Whether a stream's name matches a pattern (fnmatch).
[[nodiscard]] bool matches(const std::string& pattern, const std::string& stream) noexcept;

}  // namespace splinecast::ipc

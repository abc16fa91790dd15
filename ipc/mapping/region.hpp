#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "ipc/layout/header.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// A mapped region of shared memory. Moves; unmaps and closes when it dies; does not unlink.
class Region {
 public:
  /// Makes a region without a name, its pages reserved and populated, filled with zeros. Throws
  /// OutOfResources if shared memory has no room, naming the bytes needed and free.
  [[nodiscard]] static Region create(std::size_t bytes, const RegionAccess& access);

  /// Maps an existing region; `writable` for its owner only. Populates its pages. Throws
  /// NoSuchStream if there is none, BadRegion if it is not to be trusted. Never blocks, whatever
  /// kind of file somebody puts under the name.
  [[nodiscard]] static Region open(std::string_view stream, RegionKind kind, bool writable,
                                   const Trust& trust = {});

  Region(Region&&) noexcept;
  Region& operator=(Region&&) noexcept;
  ~Region();

  /// Gives the region its name, whole and at once. Returns false if the name is taken.
  [[nodiscard]] bool link(std::string_view stream, RegionKind kind) const;

  /// Whether the name of the stream still leads to this very region. A system call.
  [[nodiscard]] bool is_linked(std::string_view stream, RegionKind kind) const noexcept;

  /// The bytes. Those of a region that was not opened writable must not be written.
  [[nodiscard]] std::span<std::byte> bytes() const noexcept;

  /// -1 once it has been closed.
  [[nodiscard]] int descriptor() const noexcept;

  /// Gives the descriptor back; the bytes stay mapped. For a process that maps many regions and
  /// neither links this one nor locks it nor asks for its owner.
  void close_descriptor() noexcept;

  /// Whether its pages are locked into memory; best effort, see RLIMIT_MEMLOCK.
  [[nodiscard]] bool is_memory_locked() const noexcept;

 private:
  struct Mapping;
  explicit Region(std::unique_ptr<Mapping> mapping);
  std::unique_ptr<Mapping> mapping_;
};

/// What a region's file tells without being mapped.
struct RegionFile {
  std::optional<RegionHeader> header{};  ///< none: the file is shorter than one
  std::size_t bytes = 0;
  bool is_own = false;  ///< of this user
};

/// Opens a region's file and looks at it. Throws NoSuchStream if there is none, BadRegion if it is
/// not to be trusted.
[[nodiscard]] RegionFile look_at_region(std::string_view stream, RegionKind kind,
                                        const Trust& trust);

/// The header of a region; nothing if there is no such region, or one too short. Throws BadRegion
/// if it is not to be trusted.
[[nodiscard]] std::optional<RegionHeader> peek_header(std::string_view stream, RegionKind kind,
                                                      const Trust& trust);

/// Whether a region of this name stands. A system call. Throws BadRequest for what is no name.
[[nodiscard]] bool region_exists(std::string_view stream, RegionKind kind);

/// Unlinks a region's name; mappings of it stay.
void unlink_region(std::string_view stream, RegionKind kind) noexcept;

/// Inode of the time namespace of this process: clocks of two namespaces differ.
[[nodiscard]] std::uint64_t time_namespace() noexcept;

/// A random number that is not 0.
[[nodiscard]] std::uint64_t random_id();

}  // namespace splinecast::ipc

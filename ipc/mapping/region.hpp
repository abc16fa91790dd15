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

/// A mapped region of shared memory. Movable. The destructor unmaps and closes it, but does not
/// unlink it.
class Region {
 public:
  /// Creates a region without a name, its pages reserved, populated and zero. Throws
  /// OutOfResources, naming the bytes needed and free, if shared memory has no room.
  [[nodiscard]] static Region create(std::size_t bytes, const RegionAccess& access);

  /// Maps an existing region; `writable` for its owner only. Populates its pages. Throws
  /// NoSuchStream if there is none, BadRegion if it is not trusted. Never blocks, for any kind of
  /// file under the name.
  [[nodiscard]] static Region open(std::string_view stream, RegionKind kind, bool writable,
                                   const Trust& trust = {});

  Region(Region&&) noexcept;
  Region& operator=(Region&&) noexcept;
  ~Region();

  /// Gives the complete region its name, atomically. Returns false if the name exists.
  [[nodiscard]] bool link(std::string_view stream, RegionKind kind) const;

  /// Whether the stream's name still refers to this region. System calls.
  [[nodiscard]] bool is_linked(std::string_view stream, RegionKind kind) const noexcept;

  /// The bytes of the region. Must not be written unless it was opened writable.
  [[nodiscard]] std::span<std::byte> bytes() const noexcept;

  /// The descriptor of the region's file; −1 after close_descriptor().
  [[nodiscard]] int descriptor() const noexcept;

  /// Closes the descriptor; the bytes stay mapped. For a process that maps many regions. After
  /// that, this region can no longer be linked or locked, and its owner cannot be queried.
  void close_descriptor() noexcept;

  /// Whether its pages are locked into memory; best effort, see RLIMIT_MEMLOCK.
  [[nodiscard]] bool is_memory_locked() const noexcept;

 private:
  struct Mapping;
  explicit Region(std::unique_ptr<Mapping> mapping);
  std::unique_ptr<Mapping> mapping_;
};

/// The properties of a region's file, read without mapping it.
struct RegionFile {
  std::optional<RegionHeader> header{};  ///< empty: the file is shorter than a header
  std::size_t bytes = 0;
  bool is_own = false;  ///< whether it belongs to this user
};

/// Reads the properties of a region's file. Throws NoSuchStream if there is none, BadRegion if it
/// is not trusted.
[[nodiscard]] RegionFile look_at_region(std::string_view stream, RegionKind kind,
                                        const Trust& trust);

/// The header of a region; empty if there is no such region, or if it is too short. Throws
/// BadRegion if it is not trusted.
[[nodiscard]] std::optional<RegionHeader> peek_header(std::string_view stream, RegionKind kind,
                                                      const Trust& trust);

/// Whether a region of this name exists. A system call. Throws BadRequest for an invalid name.
[[nodiscard]] bool region_exists(std::string_view stream, RegionKind kind);

/// Unlinks a region's name; its mappings remain.
void unlink_region(std::string_view stream, RegionKind kind) noexcept;

/// Inode of the time namespace of this process, 0 if unknown. Clocks of two namespaces differ.
[[nodiscard]] std::uint64_t time_namespace() noexcept;

/// A random number that is not 0.
[[nodiscard]] std::uint64_t random_id();

}  // namespace splinecast::ipc

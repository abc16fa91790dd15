#pragma once

#include <map>
#include <set>
#include <string>

#include "ipc/memory/descriptor.hpp"
#include "ipc/memory/folder_watch.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The commanders of laws, or the stoppers of streams, that have a region.
class Requesters {
 public:
  /// Differs from its earlier value once one of them has come or gone, or may have.
  [[nodiscard]] const Word& version() const noexcept { return version_; }

  /// The names of those of one law or stream.
  [[nodiscard]] const std::set<std::string>& names_of(const std::string& of) const noexcept;

  /// The same for each law or stream that has one.
  using Names = std::map<std::string, std::set<std::string>>;
  [[nodiscard]] const Names& names() const noexcept { return names_; }

  void note(const std::string& of, std::string name, bool comes);
  void clear() noexcept;

 private:
  Word version_ = 1;
  Names names_;
};

/// Which streams, commanders and stoppers have a region, kept up to date by the kernel's events of
/// the shared memory folder (inotify): one that comes is known at the next poll(), for any number
/// of other files. Without inotify, as when the user has no event queue left, by the folder's
/// modification time, within 20 ms or 20 times what it takes to read the folder. Once a second that
/// time is compared with the events, too, in case none arrive. One thread uses it.
class RegionWatch {
 public:
  RegionWatch();

  /// Reads what has come and gone. While nothing has: one system call, no allocation. Else one
  /// system call per 4 kB of names. Reads the folder at the first call, and if events are missing;
  /// without inotify if any file has come or gone. Throws OutOfResources if the folder cannot be
  /// read: the next call tries again.
  void poll();

  /// Differs from its earlier value once a file of a region, or of a lock, has come or gone.
  [[nodiscard]] Word version() const noexcept { return version_; }
  /// The streams that have a ring.
  [[nodiscard]] const std::set<std::string>& streams() const noexcept { return streams_; }

  /// The commanders of laws, and the stoppers of streams.
  [[nodiscard]] const Requesters& commanders() const noexcept { return commanders_; }
  [[nodiscard]] const Requesters& stoppers() const noexcept { return stoppers_; }

 private:
  void take_events();
  void note(const RegionFileName& region, bool comes);
  void read_folder();

  OwnedDescriptor events_;
  FolderWatch folder_;
  Time next_check_ = Time::min();  ///< when the modification time is looked at
  bool has_event_ = false;         ///< since the last time that it was
  bool is_complete_ = false;
  Word version_ = 0;
  std::set<std::string> streams_;
  Requesters commanders_;
  Requesters stoppers_;
};

}  // namespace splinecast::ipc

#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ipc/mapping/region.hpp"
#include "ipc/memory/region_watch.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// The regions of the commanders of one law, or of the stoppers of one stream, as a solver observes
/// them: it stores nothing in them. One thread uses it.
class RequestRegions {
 public:
  /// A region whose record is read.
  struct Source {
    std::string name;
    Word id;  ///< of the region, not 0
    Region region;
    std::span<const Word> control;
    Word seen = 0;  ///< sequence of the record at the last read
  };

  /// One that cannot be used, and why.
  struct Unusable {
    std::string name;
    std::string why;
    bool is_unread = false;  ///< this process lacked memory or descriptors to open it
  };

  /// `of`: the law or stream. `known` has the names; it outlives this object, and its owner keeps
  /// it up to date.
  RequestRegions(std::string of, RegionKind kind, const Trust& trust, const Requesters& known);

  /// Whether one has come or gone since the last poll(). One load.
  [[nodiscard]] bool has_news() const noexcept { return known_->version() != seen_; }
  /// Whether poll() would open one that it has not tried yet.
  [[nodiscard]] bool has_untried() const noexcept { return has_news() || !untried_.empty(); }
  /// The word that changes with news, and its value at the last poll().
  [[nodiscard]] const Word* news() const noexcept { return &known_->version(); }
  [[nodiscard]] Word seen_news() const noexcept { return seen_; }

  /// Opens the regions that have come, or have taken the place of one that was deleted, and drops
  /// retired ones. Without any, no system call and no allocation. A region that cannot be used, or
  /// that has the clock of another time namespace, is tried again. Tries at most kTries in one
  /// call, new ones first: any user may create files with such names. Returns whether sources() has
  /// changed.
  bool poll();
  static constexpr std::size_t kTries = 64;
  static constexpr std::size_t kReported = 16;

  [[nodiscard]] std::span<Source> sources() noexcept { return sources_; }
  [[nodiscard]] std::span<const Source> sources() const noexcept { return sources_; }

  /// Those that poll() has found and could not use.
  [[nodiscard]] const std::vector<Unusable>& unusable() const noexcept { return unusable_; }
  /// The first of them, for messages: any user may create files with such names.
  [[nodiscard]] std::span<const Unusable> reported() const noexcept {
    return std::span(unusable_).first(std::min(kReported, unusable_.size()));
  }

  /// Whether one has come, or made a request since its record was read. One load for each.
  [[nodiscard]] bool calls() const noexcept;

  [[nodiscard]] const std::string& of() const noexcept { return of_; }

  /// The name under which the region of one of them is kept.
  [[nodiscard]] std::string stream_of(const std::string& name) const;

 private:
  [[nodiscard]] bool drop_gone();
  void find_untried();
  [[nodiscard]] std::optional<Unusable> open(const std::string& name);

  std::string of_;
  RegionKind kind_;
  Trust trust_;
  const Requesters* known_;
  Word seen_ = 0;  ///< version of `known_` at the last poll()
  std::vector<Source> sources_;
  std::vector<std::string> untried_;  ///< names that are to be opened
  std::vector<Unusable> unusable_;
  std::size_t retry_ = 0;  ///< index of the unusable one that is tried next
};

}  // namespace splinecast::ipc

#include "apps/machine/left_names.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/mode_text.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {
namespace {

constexpr std::array kKinds{ipc::RegionKind::waypoints, ipc::RegionKind::spline};

/// Records what is wrong with a file; keeps the worst finding.
void judge_file(const std::string& path, const struct stat& status, LeftName& name) {
  const auto say = [&](NameState state, std::string why) {
    if (name.state == NameState::hostile) return;
    name.state = state;
    name.why = std::move(why);
  };
  if (!S_ISREG(status.st_mode)) {
    say(NameState::hostile, path + " is not a regular file");
    return;
  }
  name.bytes += static_cast<std::size_t>(status.st_size);
  if (status.st_uid != geteuid()) {
    say(NameState::foreign, fmt::format("{} belongs to user {}", path, status.st_uid));
  } else if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    say(NameState::hostile,
        fmt::format("{} may be written by others (mode {})", path, ipc::mode_text(status.st_mode)));
  }
}

bool has_writer(const std::string& stream) {
  return std::ranges::any_of(kKinds, [&](ipc::RegionKind kind) {
    return ipc::is_owned(stream, kind) || ipc::owner_lives(stream, kind);
  });
}

}  // namespace

LeftName look_at_name(const std::string& stream) {
  LeftName name{.stream = stream};
  bool exists = false;
  for (const ipc::RegionKind kind : kKinds) {
    for (const std::string& path : {ipc::region_path(stream, kind), ipc::lock_path(stream, kind)}) {
      struct stat status {};
      if (lstat(path.c_str(), &status) != 0) continue;
      exists = true;
      judge_file(path, status, name);
    }
  }
  if (!exists) throw NoSuchStream(fmt::format("there is no stream '{}'", stream));
  if (name.state == NameState::dead && has_writer(stream)) name.state = NameState::living;
  return name;
}

}  // namespace splinecast::apps

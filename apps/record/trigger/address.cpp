#include "apps/record/trigger/address.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "apps/process/exit_codes.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {

bool is_recorder_name(const std::string& name) noexcept {
  constexpr std::size_t kMost = 64;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_allowed = [&](char c) {
    return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= kMost && std::ranges::all_of(name, is_allowed) &&
         !std::ranges::all_of(name, is_digit);
}

TriggerAddress::TriggerAddress(const std::string& folder, const std::string& recorder)
    : path_(fmt::format("{}/splinecast.record.{}", folder, recorder)) {
  if (path_.size() >= sizeof value_.sun_path) {
    throw Failure(fmt::format("{}: the path is too long for a socket: at most {} bytes",
                              ipc::printable(path_), sizeof value_.sun_path - 1));
  }
  value_.sun_family = AF_UNIX;
  std::memcpy(value_.sun_path, path_.data(), path_.size());
}

int make_trigger_socket() {
  const int made = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (made < 0) throw Failure(fmt::format("no socket: {}", std::strerror(errno)));
  return made;
}

std::optional<uid_t> peer_of(int connection) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  return peer.uid;
}

}  // namespace splinecast::apps::record

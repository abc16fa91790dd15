#include "apps/tables/kinds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

constexpr std::string_view kWLast = "xyzw";
constexpr std::string_view kWFirst = "wxyz";

/// A column's name without a unit in brackets.
std::string_view without_unit(std::string_view name) {
  for (const std::string_view brackets : {"[]", "()"}) {
    const std::size_t open = name.rfind(brackets[0]);
    if (open != std::string_view::npos && open > 0 && name.ends_with(brackets[1])) {
      return without_blanks(name.substr(0, open));
    }
  }
  return name;
}

/// The last letters of four columns' names, such as `xyzw`; empty if the names differ before them.
std::string endings(std::span<const std::string> names, std::string_view& prefix) {
  std::string letters;
  for (std::size_t k = 0; k < kQuaternionSize; ++k) {
    const std::string_view name = without_unit(names[k]);
    if (name.empty()) return {};
    const std::string_view before = name.substr(0, name.size() - 1);
    if (k == 0) prefix = before;
    if (before != prefix) return {};
    letters.push_back(name.back());
  }
  return letters;
}

DimensionKind quaternion_kind(std::string_view letters) {
  return letters == kWFirst ? DimensionKind::quaternion_wxyz : DimensionKind::quaternion;
}

/// The kind of quaternion that four columns' names indicate; nothing for other names.
std::optional<DimensionKind> named_quaternion(std::span<const std::string> names) {
  std::string_view prefix;
  const std::string letters = endings(names, prefix);
  if (letters != kWLast && letters != kWFirst) return std::nullopt;
  const bool is_orientation = prefix == "q" || (prefix.starts_with("q_") && prefix.ends_with('_'));
  if (!is_orientation) return std::nullopt;
  return quaternion_kind(letters);
}

bool is_quaternion(DimensionKind kind) {
  return kind == DimensionKind::quaternion || kind == DimensionKind::quaternion_wxyz;
}

/// Collects the requested kinds, one per dimension.
class KindList {
 public:
  KindList(const std::string& file, const RowColumns& columns)
      : file_(file), columns_(columns), kinds_(columns.names.size()) {}

  void ask(const KindOption& option) {
    const std::size_t first = dimension(option);
    if (!is_quaternion(option.kind.kind)) {
      put(first, option, option.kind);
      return;
    }
    if (kinds_.size() - first < kQuaternionSize) {
      fail(option, fmt::format("a quaternion has four dimensions; from '{}' on there are {}",
                               columns_.names[first], kinds_.size() - first));
    }
    Dimension kind = option.kind;
    std::string_view prefix;
    if (kind.kind == DimensionKind::quaternion) {
      kind.kind = quaternion_kind(endings(std::span(columns_.names).subspan(first), prefix));
    }
    for (std::size_t k = 0; k < kQuaternionSize; ++k) put(first + k, option, kind);
  }

  /// The requested kinds; of the other dimensions, the kinds by the columns' names.
  [[nodiscard]] std::vector<Dimension> filled() {
    for (std::size_t d = 0; d < columns_.kinds.size(); ++d) {
      if (!kinds_[d]) kinds_[d] = columns_.kinds[d];
    }
    for (std::size_t d = 0; d + kQuaternionSize <= kinds_.size(); ++d) {
      const auto four = std::span(kinds_).subspan(d, kQuaternionSize);
      if (std::ranges::any_of(four, [](const auto& kind) { return kind.has_value(); })) continue;
      const auto named = named_quaternion(std::span(columns_.names).subspan(d));
      if (named) std::ranges::fill(four, Dimension{.kind = *named});
    }
    std::vector<Dimension> all;
    for (const auto& kind : kinds_) all.push_back(kind.value_or(Dimension{}));
    return all;
  }

 private:
  [[nodiscard]] std::size_t dimension(const KindOption& option) const {
    for (const auto* names : {&columns_.names, &columns_.aliases}) {
      for (std::size_t d = 0; d < names->size(); ++d) {
        if ((*names)[d] == option.dimension || without_unit((*names)[d]) == option.dimension) {
          return d;
        }
      }
    }
    const auto index = parse_count(option.dimension);
    if (index && *index < kinds_.size()) return *index;
    fail(option, fmt::format("there is no dimension '{}' among 0 to {} ({})", option.dimension,
                             kinds_.size() - 1, fmt::join(columns_.names, ", ")));
  }

  void put(std::size_t d, const KindOption& option, const Dimension& kind) {
    if (kinds_[d])
      fail(option, fmt::format("dimension '{}' is given two kinds", columns_.names[d]));
    kinds_[d] = kind;
  }

  [[noreturn]] void fail(const KindOption& option, const std::string& why) const {
    throw InputError(
        fmt::format("{}: --kind {}:{}: {}", file_, option.dimension, to_string(option.kind), why));
  }

  const std::string& file_;
  const RowColumns& columns_;
  std::vector<std::optional<Dimension>> kinds_;
};

}  // namespace

std::optional<KindOption> parse_kind_option(const std::string& text) {
  // A name may contain colons, and the kind `periodic:PERIOD` does.
  for (std::size_t colon = text.find(':'); colon != std::string::npos;
       colon = text.find(':', colon + 1)) {
    const auto kind = parse_dimension(std::string_view(text).substr(colon + 1));
    if (kind && colon > 0) return KindOption{.dimension = text.substr(0, colon), .kind = *kind};
  }
  return std::nullopt;
}

std::vector<Dimension> resolve_kinds(const std::string& file, const RowColumns& columns,
                                     const std::vector<KindOption>& asked) {
  KindList list(file, columns);
  for (const KindOption& option : asked) list.ask(option);
  return list.filled();
}

std::optional<std::string> zero_quaternion(std::span<const double> position,
                                           const std::vector<std::string>& names,
                                           const DimensionKinds& kinds) {
  if (kinds.takes(position)) return std::nullopt;
  for (const QuaternionDimensions& quaternion : kinds.quaternions()) {
    if (DimensionKinds::takes(position, quaternion)) continue;
    const std::size_t first = quaternion.first;
    const auto four = position.subspan(first, kQuaternionSize);
    const bool is_zero = std::ranges::all_of(four, [](double value) { return value == 0; });
    return fmt::format("columns '{}' to '{}': a quaternion of length {}", names[first],
                       names[first + kQuaternionSize - 1],
                       is_zero ? "0" : "outside 1e-100 to 1e100");
  }
  return std::nullopt;
}

void continue_waypoints(WaypointTable& table) {
  const DimensionKinds kinds(table.kinds);
  if (kinds.all_linear()) return;
  const std::size_t dimensions = table.dimensions();
  const auto row = [&](std::vector<double>& values, std::size_t i) {
    return values.empty() ? std::span<double>{}
                          : std::span(values).subspan(i * dimensions, dimensions);
  };
  std::span<const double> previous;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (const auto bad = zero_quaternion(table.waypoint(i).position, table.names, kinds)) {
      throw InputError(fmt::format("{}: {}", table.where(i), *bad));
    }
    const WaypointValues values{.position = row(table.positions, i),
                                .velocity = row(table.velocities, i),
                                .acceleration = row(table.accelerations, i)};
    kinds.continue_from(previous, values);
    previous = values.position;
  }
}

}  // namespace splinecast::apps

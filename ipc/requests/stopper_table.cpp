#include "ipc/requests/stopper_table.hpp"

#include <algorithm>
#include <cstring>

namespace splinecast::ipc {
namespace {

constexpr std::size_t kId = word_of(kStopperFields, "id");
constexpr std::size_t kName = word_of(kStopperFields, "name");
constexpr std::size_t kNumber = word_of(kStopperFields, "number");
constexpr std::size_t kState = word_of(kStopperFields, "state");
constexpr Word kHolds = 1;
constexpr Word kIsDamaged = 2;

using NameWords = std::array<Word, kStopperNameBytes / sizeof(Word)>;

NameWords name_words(const std::string& name) noexcept {
  NameWords words{};
  std::memcpy(words.data(), name.data(), std::min(name.size(), kStopperNameBytes));
  return words;
}

constexpr std::size_t at(std::size_t slot, std::size_t field) noexcept {
  return slot * kStopperWords + field;
}

}  // namespace

void StopperTable::restore(std::span<const Word, kStopperTableWords> committed,
                           Word holders) noexcept {
  std::ranges::copy(committed, words_.begin());
  is_used_ = true;
  has_changes_ = false;
  holders_ = holders;
}

void StopperTable::put(std::size_t word, Word value) noexcept {
  has_changes_ = has_changes_ || words_[word] != value;
  words_[word] = value;
}

void StopperTable::clear(std::size_t slot) noexcept {
  for (std::size_t i = 0; i < kStopperWords; ++i) put(at(slot, i), 0);
}

std::optional<std::size_t> StopperTable::find(Word id) const noexcept {
  for (std::size_t slot = 0; slot < kMostStoppers; ++slot) {
    if (words_[at(slot, kId)] == id) return slot;
  }
  return std::nullopt;
}

std::optional<std::size_t> StopperTable::find_name(const std::string& name) const noexcept {
  const NameWords wanted = name_words(name);
  for (std::size_t slot = 0; slot < kMostStoppers; ++slot) {
    const auto own = std::span(words_).subspan(at(slot, kName), wanted.size());
    if (words_[at(slot, kId)] != 0 && std::ranges::equal(own, wanted)) return slot;
  }
  return std::nullopt;
}

/// The slot of a stopper. If it has none, a free one; if there is none either, and it holds the
/// stream, that of one that does not.
std::optional<std::size_t> StopperTable::give_slot(const StopperState& state) noexcept {
  if (state.id == 0) return find_name(state.name);
  if (const auto own = find(state.id)) return own;
  if (state.number == 0 && !state.holds) return std::nullopt;  // it has requested nothing
  std::optional<std::size_t> slot = find(0);
  for (std::size_t i = 0; i < kMostStoppers && !slot && state.holds; ++i) {
    if (words_[at(i, kState)] == 0) slot = i;
  }
  if (!slot) return std::nullopt;
  clear(*slot);
  put(at(*slot, kId), state.id);
  const NameWords name = name_words(state.name);
  for (std::size_t i = 0; i < name.size(); ++i) put(at(*slot, kName + i), name[i]);
  return slot;
}

void StopperTable::update(std::span<const StopperState> states) noexcept {
  if (states.empty() && !is_used_) return;
  for (std::size_t slot = 0; slot < kMostStoppers; ++slot) {
    const Word id = words_[at(slot, kId)];
    const bool is_there =
        id == 0 || std::ranges::any_of(states, [&](const StopperState& state) {
          return state.id == id || (state.id == 0 && find_name(state.name) == slot);
        });
    if (!is_there) clear(slot);
  }
  Word holders = 0;
  Word holder = 0;
  // Those that hold the stream come first, so that one of them never lacks a slot for another one.
  for (const bool holds : {true, false}) {
    for (const StopperState& state : states) {
      if (state.holds != holds) continue;
      holders += holds ? 1 : 0;
      const auto slot = give_slot(state);
      if (!slot) continue;
      put(at(*slot, kNumber), std::max(state.number, words_[at(*slot, kNumber)]));
      put(at(*slot, kState), (holds ? kHolds : 0) | (state.is_damaged ? kIsDamaged : 0));
      if (holds) holder = *slot;
    }
  }
  has_changes_ = has_changes_ || holders != holders_;
  holders_ = holders;
  holder_ = holder;
  is_used_ = !states.empty() || std::ranges::any_of(words_, [](Word word) { return word != 0; });
}

std::optional<StopperEntry> stopper_in(const StopperTable::Words& words, std::size_t slot) {
  const Word id = words[at(slot, kId)];
  if (id == 0) return std::nullopt;
  std::array<char, kStopperNameBytes> name{};
  std::memcpy(name.data(), &words[at(slot, kName)], name.size());
  const Word state = words[at(slot, kState)];
  return StopperEntry{.id = id,
                      .name = {name.begin(), std::ranges::find(name, '\0')},
                      .number = words[at(slot, kNumber)],
                      .holds = (state & kHolds) != 0,
                      .is_damaged = (state & kIsDamaged) != 0};
}

}  // namespace splinecast::ipc

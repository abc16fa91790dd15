#include "apps/limits/file.hpp"
#include "apps/process/exit_codes.hpp"

#ifdef SPLINECAST_HAS_URDFDOM

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <map>
#include <string_view>
#include <utility>

namespace splinecast::apps {
namespace {

/// Collects the errors of urdfdom during its lifetime, instead of printing them.
class Messages : public console_bridge::OutputHandler {
 public:
  Messages() { console_bridge::useOutputHandler(this); }
  ~Messages() override { console_bridge::restorePreviousOutputHandler(); }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    text_ += (text_.empty() ? "" : "; ") + text;
  }

  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

/// If `opening` is at `at`, returns the position after the next `closing`, or the end of the text
/// if `closing` is missing. Otherwise returns `at`.
std::size_t skip(std::string_view text, std::size_t at, std::string_view opening,
                 std::string_view closing) {
  if (!text.substr(at).starts_with(opening)) return at;
  const std::size_t end = text.find(closing, at + opening.size());
  return end == std::string_view::npos ? text.size() : end + closing.size();
}

/// Whether the start tag of an element begins at `at`.
bool begins_element(std::string_view text, std::size_t at) {
  if (at + 1 >= text.size()) return false;
  const auto next = static_cast<unsigned char>(text[at + 1]);
  return std::isalpha(next) != 0 || next == '_' || next >= 0x80;
}

/// The end of the tag that begins at `at`, and whether the element is empty (`<a/>`).
std::pair<std::size_t, bool> end_of_tag(std::string_view text, std::size_t at) {
  char quote = 0;
  std::size_t i = at + 1;
  for (; i < text.size() && (quote != 0 || (text[i] != '>' && text[i] != '<')); ++i) {
    if (quote == text[i]) {
      quote = 0;
    } else if (quote == 0 && (text[i] == '"' || text[i] == '\'')) {
      quote = text[i];
    }
  }
  const bool is_closed = i < text.size() && text[i] == '>';
  return {is_closed ? i + 1 : i, is_closed && text[i - 1] == '/'};
}

/// Throws InputError if elements are nested so deeply that the recursive parsers may overflow the
/// stack.
void require_flat(const std::string& name, const std::string& text) {
  constexpr int kDeepest = 200;
  int depth = 0;
  for (std::size_t i = text.find('<'); i < text.size(); i = text.find('<', i)) {
    const std::size_t past =
        std::max(skip(text, i, "<!--", "-->"), skip(text, i, "<![CDATA[", "]]>"));
    if (past > i) {
      i = past;
      continue;
    }
    if (!begins_element(text, i)) {
      if (text.compare(i, 2, "</") == 0) depth = std::max(depth - 1, 0);
      ++i;
      continue;
    }
    const auto [end, is_empty] = end_of_tag(text, i);
    if (!is_empty) ++depth;
    if (depth > kDeepest) {
      const auto line =
          1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw InputError(
          fmt::format("{}:{}: elements are nested more than {} deep", name, line, kDeepest));
    }
    i = end;
  }
}

/// The line of each joint's element.
std::map<std::string, int> joint_lines(const std::string& name, const std::string& text) {
  TiXmlDocument document;
  document.Parse(text.c_str());
  if (document.Error()) {
    throw InputError(
        fmt::format("{}:{}: {}", name, std::max(document.ErrorRow(), 1), document.ErrorDesc()));
  }
  const TiXmlElement* const robot = document.FirstChildElement("robot");
  if (robot == nullptr) throw InputError(name + ": there is no element 'robot'");
  std::map<std::string, int> lines;
  for (const auto* joint = robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const char* const of = joint->Attribute("name");
    if (of != nullptr) lines.emplace(of, joint->Row());
  }
  return lines;
}

/// `file:line` of the joint that a message mentions; `file` if it mentions none.
std::string where(const std::string& name, const std::map<std::string, int>& lines,
                  const std::string& message) {
  for (const auto& [joint, line] : lines) {
    if (message.find('[' + joint + ']') != std::string::npos ||
        message.find('\'' + joint + '\'') != std::string::npos) {
      return fmt::format("{}:{}", name, line);
    }
  }
  return name;
}

bool is_bounded(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::PRISMATIC;
}

bool is_dimension(const urdf::Joint& joint) {
  return (is_bounded(joint) || joint.type == urdf::Joint::CONTINUOUS) && !joint.mimic;
}

}  // namespace

LimitFile read_urdf(const std::string& name, const std::string& text) {
  require_flat(name, text);
  const std::map<std::string, int> lines = joint_lines(name, text);
  Messages messages;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model) {
    const std::string why =
        messages.text().empty() ? "is not a robot description" : messages.text();
    throw InputError(where(name, lines, why) + ": " + why);
  }
  LimitFile file;
  for (const auto& [joint_name, joint] : model->joints_) {
    if (!is_dimension(*joint)) continue;
    const std::string at = fmt::format("{}:{}", name, lines.at(joint_name));
    NamedLimits limits{.name = joint_name};
    if (joint->limits) {
      limits.velocity = limit_value(at, "velocity", joint->limits->velocity);
      if (limits.velocity == 0) {
        file.notes.push_back(
            fmt::format("{}: velocity 0 of joint '{}' means no limit", at, joint_name));
      }
      if (is_bounded(*joint)) {
        limits.lower = joint->limits->lower;
        limits.upper = joint->limits->upper;
      }
    }
    if (!(limits.lower < limits.upper)) {
      throw InputError(fmt::format("{}: lower {} of joint '{}' is not below upper {}", at,
                                   limits.lower, joint_name, limits.upper));
    }
    file.joints.push_back(std::move(limits));
  }
  std::ranges::stable_sort(file.joints, {}, [&](const auto& each) { return lines.at(each.name); });
  return file;
}

}  // namespace splinecast::apps

#else

namespace splinecast::apps {

LimitFile read_urdf(const std::string& name, const std::string& /*text*/) {
  throw InputError(name + ": this build cannot read URDF (built without urdfdom)");
}

}  // namespace splinecast::apps

#endif

#include "apps/pages/html_page.hpp"

#include <string>

namespace splinecast::apps {
namespace {

/// JSON as the content of a script element, without `<`, so that it cannot end the element.
std::string embeddable(const nlohmann::ordered_json& json) {
  using nlohmann::ordered_json;
  const std::string text = json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

void write_page(std::string_view page, const nlohmann::ordered_json& data, Output& output) {
  constexpr std::string_view kData = "@data@";
  const std::size_t at = page.find(kData);
  output.write(page.substr(0, at));
  output.write(embeddable(data));
  output.write(page.substr(at + kData.size()));
}

}  // namespace splinecast::apps

#include "apps/completion/template.hpp"

namespace splinecast::apps {

std::string filled(std::string_view script,
                   const std::vector<std::pair<std::string, std::string>>& texts) {
  std::string out(script);
  for (const auto& [mark, text] : texts) out.replace(out.find(mark), mark.size(), text);
  return out;
}

}  // namespace splinecast::apps

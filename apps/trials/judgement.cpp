#include "apps/trials/judgement.hpp"

#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"

namespace splinecast::apps {

using nlohmann::json;

void add_judgement(json& found, bool is_sound) {
  const bool is_judged = !stop_requested();
  found["judged"] = is_judged;
  found["sound"] = is_judged ? json(is_sound) : json();
}

std::string judgement(const json& found) {
  if (!found["judged"].get<bool>()) return "not judged: interrupted";
  return found["sound"].get<bool>() ? "yes" : "NO";
}

int print_judgement(const std::function<json()>& run, bool as_json,
                    std::string (*summary)(const json&), int unsound) {
  json found;
  try {
    found = run();
  } catch (const Interrupted&) {  // before there was a result
    found = {{"judged", false}, {"sound", nullptr}};
    print_report(as_json ? found.dump(2) + "\n" : judgement(found) + "\n");
    return kInterrupted;
  }
  print_report(as_json ? found.dump(2) + "\n" : summary(found));
  if (!found["judged"].get<bool>()) return kInterrupted;
  return found["sound"].get<bool>() ? kOk : unsound;
}

}  // namespace splinecast::apps

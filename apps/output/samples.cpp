#include "apps/output/samples.hpp"

#include <iterator>
#include <utility>

namespace splinecast::apps {

SampleWriter::SampleWriter(Output& output, std::size_t dimensions, DimensionKinds kinds,
                           std::string_view further)
    : output_(&output), kinds_(std::move(kinds)), motions_(kinds_.quaternions().size()) {
  auto to = std::back_inserter(line_);
  fmt::format_to(to, "t_ns");
  for (const char letter : {'p', 'v', 'a', 'j'}) {
    for (std::size_t d = 0; d < dimensions; ++d) fmt::format_to(to, ",{}[{}]", letter, d);
  }
  for (const char* const word : {"omega", "alpha"}) {
    for (std::size_t i = 0; i < 3 * motions_.size(); ++i) fmt::format_to(to, ",{}[{}]", word, i);
  }
  fmt::format_to(to, "{}{}\n", further.empty() ? "" : ",", further);
  output_->write({line_.data(), line_.size()});
}

void SampleWriter::write(Time time, const State& state, std::string_view further) {
  line_.clear();
  auto to = std::back_inserter(line_);
  fmt::format_to(to, "{}", time.count());
  for (const double value : state.values()) fmt::format_to(to, ",{}", value);
  for (std::size_t q = 0; q < motions_.size(); ++q) {
    motions_[q] = angular_motion(kinds_.quaternions()[q], state.position(), state.velocity(),
                                 state.acceleration());
  }
  for (const auto part : {&AngularMotion::velocity, &AngularMotion::acceleration}) {
    for (const AngularMotion& motion : motions_) {
      for (const double value : motion.*part) fmt::format_to(to, ",{}", value);
    }
  }
  if (!further.empty()) fmt::format_to(to, ",{}", further);
  line_.push_back('\n');
  output_->write({line_.data(), line_.size()});
}

}  // namespace splinecast::apps

#include "support/polynomial_trajectory.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace splinecast::testing {

PolynomialTrajectory::PolynomialTrajectory(const std::filesystem::path& csv) {
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream fields(line);
    std::string field;
    std::vector<double> values;
    while (std::getline(fields, field, ',')) {
      if (field.find_first_not_of(" \r") != std::string::npos) values.push_back(std::stod(field));
    }
    if (values.size() != 1 + 8 * kDimensions) throw std::runtime_error("odd row: " + line);
    Piece piece{.duration = values[0], .coefficients = {}};
    for (std::size_t d = 0; d < kDimensions; ++d) {
      for (std::size_t k = 0; k < 8; ++k) piece.coefficients[d][k] = values[1 + 8 * d + k];
    }
    pieces_.push_back(piece);
  }
}

double PolynomialTrajectory::duration() const {
  double sum = 0;
  for (const Piece& piece : pieces_) sum += piece.duration;
  return sum;
}

std::array<double, PolynomialTrajectory::kDimensions> PolynomialTrajectory::at(
    double t, int derivative) const {
  std::size_t i = 0;
  while (i + 1 < pieces_.size() && t >= pieces_[i].duration) t -= pieces_[i++].duration;
  std::array<double, kDimensions> result{};
  for (std::size_t d = 0; d < kDimensions; ++d) {
    for (int k = 7; k >= derivative; --k) {
      double factor = 1;
      for (int f = 0; f < derivative; ++f) factor *= k - f;
      result[d] = result[d] * t + factor * pieces_[i].coefficients[d][static_cast<std::size_t>(k)];
    }
  }
  return result;
}

Mesh PolynomialTrajectory::sampled(core::Time period) const {
  Mesh mesh{.dimensions = kDimensions, .times = {}, .positions = {}};
  for (core::Time t{}; core::to_seconds(t) <= duration(); t += period) {
    mesh.times.push_back(t);
    const auto x = at(core::to_seconds(t), 0);
    mesh.positions.insert(mesh.positions.end(), x.begin(), x.end());
  }
  return mesh;
}

}  // namespace splinecast::testing

#include "apps/files/text_file.hpp"

#include "apps/files/input_file.hpp"

namespace splinecast::apps {

TextFile::TextFile(const std::string& path) {
  InputFile file(path);
  name_ = file.name();
  text_.resize(file.size());
  text_.resize(file.read(0, text_));
}

}  // namespace splinecast::apps
